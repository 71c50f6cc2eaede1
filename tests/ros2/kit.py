"""What the tests of `belvedere ros2` share: programs that run beside them, and a loop that waits."""

import contextlib
import json
import os
import signal
import subprocess
import tempfile
import time

import rclpy

DOMAIN = f"ros2-{os.getpid()}"
#: Seconds between two calls of `belvedere list`, in a loop that waits for what it says.
LIST_S = 0.2


@contextlib.contextmanager
def process(belvedere, *words):
    """Runs a command of belvedere, stops it with Ctrl-C, and checks its exit code. Gives the process, and a function: what
    it has said.
    """
    file = tempfile.TemporaryFile()

    def said():
        return os.pread(file.fileno(), 1 << 20, 0).decode()

    child = subprocess.Popen([belvedere, *words, "--domain", DOMAIN], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=file)
    try:
        yield child, said
    finally:
        child.send_signal(signal.SIGINT)
        child.wait(timeout=20)
    assert child.returncode == 0, f"{words}: {child.returncode}\n{said()}"


@contextlib.contextmanager
def program(belvedere, *words):
    """Does the same as `process`, and gives only the function."""
    with process(belvedere, *words) as (_, said):
        yield said


def spin(node, done, seconds, interval=0.0):
    """Spins until `done()` is true, and returns the time that it took, or None. `interval` is the least time between two
    calls of `done`, for one that starts a program: without it, each message that comes would start one.
    """
    begin = time.monotonic()
    while not done():
        now = time.monotonic()
        if now > begin + seconds:
            return None
        rclpy.spin_once(node, timeout_sec=0.05)
        while time.monotonic() < now + interval:
            rclpy.spin_once(node, timeout_sec=0.05)
    return time.monotonic() - begin


def streams(belvedere):
    """Returns the lines of `belvedere list`."""
    done = subprocess.run([belvedere, "list", "--json", "--domain", DOMAIN], capture_output=True, text=True)
    return [json.loads(line) for line in done.stdout.splitlines()]


def readers(belvedere, topic):
    """Returns the number of subscribers of a stream."""
    return next(line["subscribers"] for line in streams(belvedere) if line["topic"].strip("/") == topic)


def tried(check, *arguments, tries=3):
    """Repeats a check of speed: a busy machine may be slow once; three times in a row it is a fault."""
    outcomes = []
    while len(outcomes) < tries:
        outcomes.append(check(*arguments))
        if outcomes[-1] is None:
            return
    raise AssertionError(f"{check.__name__}{arguments}: {'; '.join(outcomes)}")
