"""Run the programs of the pages on Python, and of the main README, unchanged."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PROGRAMS = [
    (page, program)
    for page in ("docs/python.md", "docs/mujoco.md", "docs/formats_in_python.md")
    for program in re.findall(r"```python\n(.*?)```", (ROOT / page).read_text(), re.DOTALL)
]


#: Other programs of that page are parts of programs.
PROGRAMS += [
    ("docs/datasets.md", program)
    for program in re.findall(r"```python run\n(.*?)```", (ROOT / "docs/datasets.md").read_text(), re.DOTALL)
]


@pytest.mark.parametrize(("page", "program"), PROGRAMS, ids=range(len(PROGRAMS)))
def test_programs_of_the_pages(page: str, program: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    exec(compile(program, page, "exec"), {})


def test_the_first_program(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (program,) = re.findall(r"```python first\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)
    assert program.count("\n") <= 10
    monkeypatch.chdir(tmp_path)
    exec(compile(program, "README.md", "exec"), {})
    assert (tmp_path / "depth.png").read_bytes().startswith(b"\x89PNG")
