"""Run the programs of the README unchanged."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from conftest import Simulator

    import belvedere

PROGRAMS = re.findall(r"```python\n(.*?)```", (Path(__file__).parents[1] / "README.md").read_text(), re.DOTALL)


def run(program: str, domain: str) -> str:
    """Return the output of a program."""
    ran = subprocess.run(
        [sys.executable, "-W", "error", "-c", program, domain],
        env={"BELVEDERE_DOMAIN": domain, "PATH": "/usr/bin:/bin"},
        stdout=subprocess.PIPE,
        text=True,
        timeout=60,
        check=True,
    )
    return ran.stdout


def the_program_with(text: str) -> str:
    (program,) = (program for program in PROGRAMS if text in program)
    return program


def test_all_are_short() -> None:
    assert len(PROGRAMS) == 5
    for program in PROGRAMS:
        assert program.count("\n") < 40


def test_the_first_program(shared: Simulator) -> None:
    assert "(480, 640, 3)" in run(the_program_with('Node("first")'), shared.domain)


def test_sets_of_frames(kinect: belvedere.Node) -> None:
    lines = run(the_program_with("synchronize"), kinect.domain).splitlines()
    assert len(lines) == 10
    for line in lines:
        assert line.startswith("True (480, 640, 3) (480, 640)")


def test_commands(shared: Simulator) -> None:
    drove, rests, steps = run(the_program_with("motor_power"), shared.domain).splitlines()
    assert 0.1 < float(drove.split()[1]) < 0.4
    assert rests == "and is at 0.00 m again, at rest"
    assert float(steps.split()[3]) > 0


@pytest.mark.parametrize(("topic", "shape"), [("image_raw", "(480, 640, 3)"), ("scan", "(1, 360)")])
def test_async_for(shared: Simulator, topic: str, shape: str) -> None:
    lines = run(the_program_with("asyncio"), shared.domain).splitlines()
    assert len([line for line in lines if line.startswith(topic) and line.endswith(shape)]) == 10


def test_the_plain_wheel_reads_a_stream_too(shared: Simulator) -> None:
    program = the_program_with("iox2.NodeBuilder")
    assert "import belvedere" not in program
    assert "640 x 480" in run(program, shared.domain)
