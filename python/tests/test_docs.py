"""Run the programs of docs/python.md, docs/mujoco.md and the main README unchanged."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PROGRAMS = [
    (page, program)
    for page in ("docs/python.md", "docs/mujoco.md")
    for program in re.findall(r"```python\n(.*?)```", (ROOT / page).read_text(), re.DOTALL)
]


@pytest.mark.parametrize(("page", "program"), PROGRAMS, ids=range(len(PROGRAMS)))
def test_programs_of_the_pages(page: str, program: str) -> None:
    exec(compile(program, page, "exec"), {})


def test_the_first_program(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (program,) = re.findall(r"```python first\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)
    assert program.count("\n") <= 10
    monkeypatch.chdir(tmp_path)
    exec(compile(program, "README.md", "exec"), {})
    assert (tmp_path / "depth.png").read_bytes().startswith(b"\x89PNG")
