"""Run the programs of docs/python.md and of the main README unchanged."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PROGRAMS = re.findall(r"```python\n(.*?)```", (ROOT / "docs" / "python.md").read_text(), re.DOTALL)


@pytest.mark.parametrize("program", PROGRAMS, ids=range(len(PROGRAMS)))
def test_programs_of_the_page(program: str) -> None:
    exec(compile(program, "docs/python.md", "exec"), {})


def test_the_first_program(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (program,) = re.findall(r"```python first\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)
    assert program.count("\n") <= 10
    monkeypatch.chdir(tmp_path)
    exec(compile(program, "README.md", "exec"), {})
    assert (tmp_path / "depth.png").read_bytes().startswith(b"\x89PNG")
