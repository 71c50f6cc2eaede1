"""Fixtures of a live simulator in its own domain."""

from __future__ import annotations

import importlib.util
import os
import signal
import subprocess
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

import belvedere

if TYPE_CHECKING:
    from collections.abc import Generator, Iterator

ROOT = Path(__file__).parents[2]

# A shell without job control starts background programs with SIGINT ignored, and Python keeps that: the tests of
# Ctrl-C would wait for an exception that never comes.
signal.signal(signal.SIGINT, signal.default_int_handler)


# As for the tests in Rust: with this, a test that would be skipped fails.
NO_SKIP = os.environ.get("BELVEDERE_NO_SKIP") == "1"
FORBIDDEN = "this would be skipped, which BELVEDERE_NO_SKIP forbids: {}"


def reason(report: pytest.CollectReport | pytest.TestReport) -> str:
    """Return why something was skipped."""
    where_and_why = report.longrepr
    return str(where_and_why[2] if isinstance(where_and_why, tuple) else where_and_why)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport() -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Let a skipped test fail where none may be skipped; an expected failure is none."""
    report = yield
    if NO_SKIP and report.skipped and not hasattr(report, "wasxfail"):
        report.outcome, report.longrepr = "failed", FORBIDDEN.format(reason(report))
    return report


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report() -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    """Let a file fail whose tests would all be skipped, where none may be skipped."""
    report = yield
    if NO_SKIP and report.skipped:
        report.outcome, report.longrepr = "failed", FORBIDDEN.format(reason(report))
    return report


class Simulator:
    """A ``belvedere run`` process, which can be killed and restarted."""

    def __init__(self, domain: str, *arguments: str) -> None:
        self.domain, self.arguments = domain, arguments
        target = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
        self.program = Path(os.environ.get("BELVEDERE_BIN", target / "release" / "belvedere"))
        if not self.program.exists():
            pytest.fail(f"{self.program} is missing: cargo build --release, or name it in BELVEDERE_BIN")
        self.process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        """Start it; its streams appear a moment later."""
        command = [self.program, "run", "--domain", self.domain, *self.arguments]
        self.process = subprocess.Popen(command, stderr=subprocess.DEVNULL)

    def stop(self, how: signal.Signals) -> None:
        """Stop it, and wait until it has ended."""
        if self.process is not None:
            self.process.send_signal(how)
            self.process.wait(timeout=30)
            self.process = None


def running(name: str, *arguments: str) -> Iterator[Simulator]:
    """A simulator in its own domain, until the end of the fixture."""
    simulator = Simulator(f"{name}-{os.getpid()}", *arguments)
    simulator.start()
    try:
        yield simulator
    finally:
        simulator.stop(signal.SIGINT)


@pytest.fixture
def simulator() -> Iterator[Simulator]:
    """Start a simulator for this test alone, which may stop it."""
    yield from running("own")


@pytest.fixture(scope="module")
def shared() -> Iterator[Simulator]:
    """Start a simulator for the tests of a module that only read streams and drive the robot."""
    yield from running("shared")


@pytest.fixture(scope="module")
def shared_lenses() -> Iterator[Simulator]:
    """Start a simulator of a robot whose cameras have various lenses."""
    yield from running("lenses", "--robot", str(ROOT / "tests" / "lenses.urdf"), "--drive", "still")


@pytest.fixture(scope="module")
def shared_kinect() -> Iterator[Simulator]:
    """Start a simulator of a robot with a depth camera."""
    yield from running("kinect", "--robot", "kobuki_hexagons_kinect")


@pytest.fixture
def node(shared: Simulator) -> Iterator[belvedere.Node]:
    """Join the domain of the shared simulator."""
    with belvedere.Node("pytest", domain=shared.domain) as node:
        yield node


@pytest.fixture
def alone() -> Iterator[belvedere.Node]:
    """Join a domain without a simulator."""
    with belvedere.Node("pytest", domain=f"alone-{os.getpid()}") as node:
        yield node


@pytest.fixture
def lenses(shared_lenses: Simulator) -> Iterator[belvedere.Node]:
    with belvedere.Node("pytest", domain=shared_lenses.domain) as node:
        yield node


@pytest.fixture
def kinect(shared_kinect: Simulator) -> Iterator[belvedere.Node]:
    with belvedere.Node("pytest", domain=shared_kinect.domain) as node:
        yield node


#: Packages that are too large for every run of CI; the tests that use these fixtures are left out without them.
LARGE = ("lerobot", "open3d")


@pytest.fixture(scope="session")
def open3d() -> Any:
    """Return Open3D."""
    return importlib.import_module("open3d")


@pytest.fixture(scope="session")
def lerobot() -> Any:
    """Return the module of LeRobot that reads data sets."""
    return importlib.import_module("lerobot.datasets.lerobot_dataset")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out tests of large packages that are not installed."""
    missing = {name for name in LARGE if importlib.util.find_spec(name) is None}
    left_out = [item for item in items if missing.intersection(getattr(item, "fixturenames", ()))]
    if left_out:
        config.hook.pytest_deselected(items=left_out)
        items[:] = [item for item in items if item not in left_out]
