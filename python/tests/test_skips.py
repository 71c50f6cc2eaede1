"""Tests that are skipped, where none may be."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Mapping

SKIPPED = """
import pytest

def test_that_passes(): pass

@pytest.mark.skipif(True, reason="no second core")
def test_that_is_marked(): pass

def test_that_skips(): pytest.skip("no root")

@pytest.mark.xfail(reason="not yet")
def test_that_is_expected_to_fail(): assert False
"""
MISSING = "import pytest\nnothing = pytest.importorskip('nothing_of_this_name')\n"


def outcome(folder: Path, environment: Mapping[str, str]) -> tuple[int, str]:
    """Run the tests of a folder with the hooks of this one's."""
    environment = {**os.environ, **environment, "PYTHONPATH": str(Path(__file__).parent)}
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "conftest", "-rs", folder]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, cwd=folder, check=False)
    return done.returncode, done.stdout


@pytest.mark.parametrize("forbidden", [False, True])
def test_a_skip_fails_where_none_is_allowed(tmp_path: Path, *, forbidden: bool) -> None:
    (tmp_path / "test_skipped.py").write_text(SKIPPED)
    code, said = outcome(tmp_path, {"BELVEDERE_NO_SKIP": "1" if forbidden else ""})
    if forbidden:
        assert code == 1, said
        assert "1 passed, 1 xfailed" in said.replace("2 failed, ", ""), said
        for why in ["no second core", "no root"]:
            assert f"this would be skipped, which BELVEDERE_NO_SKIP forbids: Skipped: {why}" in said, said
    else:
        assert code == 0, said
        assert "1 passed, 2 skipped, 1 xfailed" in said, said


@pytest.mark.parametrize("forbidden", [False, True])
def test_a_file_that_is_skipped_fails_where_none_is_allowed(tmp_path: Path, *, forbidden: bool) -> None:
    (tmp_path / "test_missing.py").write_text(MISSING)
    code, said = outcome(tmp_path, {"BELVEDERE_NO_SKIP": "1" if forbidden else ""})
    assert ("BELVEDERE_NO_SKIP forbids" in said) == forbidden, said
    assert (code != 5) == forbidden, (code, said)
