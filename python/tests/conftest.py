"""A live simulator in a domain of its own."""

from __future__ import annotations

import os
import signal
import subprocess
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

import belvedere

if TYPE_CHECKING:
    from collections.abc import Iterator

ROOT = Path(__file__).parents[2]


class Simulator:
    """``belvedere run``, which can be killed and started again."""

    def __init__(self, domain: str, *arguments: str) -> None:
        self.domain, self.arguments = domain, arguments
        target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
        self.program = Path(os.environ.get("BELVEDERE_BIN", target / "release" / "belvedere"))
        if not self.program.exists():
            pytest.fail(f"{self.program} is missing: cargo build --release, or name it in BELVEDERE_BIN")
        self.process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        """Start it; its streams come a moment later."""
        command = [self.program, "run", "--domain", self.domain, *self.arguments]
        self.process = subprocess.Popen(command, stderr=subprocess.DEVNULL)

    def stop(self, how: signal.Signals) -> None:
        """End it, and wait until it has."""
        if self.process is not None:
            self.process.send_signal(how)
            self.process.wait(timeout=30)
            self.process = None


@pytest.fixture
def simulator() -> Iterator[Simulator]:
    simulator = Simulator(f"pytest-{os.getpid()}")
    simulator.start()
    yield simulator
    simulator.stop(signal.SIGINT)


@pytest.fixture
def node(simulator: Simulator) -> Iterator[belvedere.Node]:
    with belvedere.Node("pytest", domain=simulator.domain) as node:
        yield node


@pytest.fixture
def lenses() -> Iterator[belvedere.Node]:
    """Join the domain of a robot whose cameras have various lenses."""
    robot = ROOT / "tests" / "lenses.urdf"
    simulator = Simulator(f"lenses-{os.getpid()}", "--robot", str(robot), "--drive", "still")
    simulator.start()
    with belvedere.Node("pytest", domain=simulator.domain) as node:
        yield node
    simulator.stop(signal.SIGINT)


@pytest.fixture
def kinect() -> Iterator[belvedere.Node]:
    """Join the domain of a robot with a depth camera."""
    simulator = Simulator(f"kinect-{os.getpid()}", "--robot", "kobuki_hexagons_kinect")
    simulator.start()
    with belvedere.Node("pytest", domain=simulator.domain) as node:
        yield node
    simulator.stop(signal.SIGINT)
