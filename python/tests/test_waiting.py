"""Other event loops, and sets of frames, on a live simulator."""

from __future__ import annotations

import asyncio
import os
import select
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

import belvedere

if TYPE_CHECKING:
    from conftest import Simulator


def test_a_descriptor_works_across_a_restart(simulator: Simulator) -> None:
    with belvedere.Node(domain=simulator.domain) as node, node.subscribe("image_raw") as camera:
        poll = select.poll()
        poll.register(camera.fileno(), select.POLLIN)
        sessions: dict[int, int] = {}
        for session in range(2):
            deadline = time.monotonic() + 30
            while len(sessions) <= session or min(sessions.values()) < 10:
                assert time.monotonic() < deadline, sessions
                assert poll.poll(1000), "not even to look for the publisher"
                while (frame := camera.take()) is not None:
                    sessions[frame.session] = sessions.get(frame.session, 0) + 1
                    del frame
            if session == 0:
                simulator.stop(signal.SIGKILL)
                simulator.start()


def test_a_descriptor_is_quiet_between_frames(node: belvedere.Node) -> None:
    with node.subscribe("scan") as scans:
        next(scans.frames(timeout=30))
        poll = select.poll()
        poll.register(scans.fileno(), select.POLLIN)
        rings = frames = 0
        end = time.monotonic() + 2
        while time.monotonic() < end:
            rings += bool(poll.poll(100))
            while (frame := scans.take()) is not None:
                frames += 1
                del frame
        assert 9 <= frames <= 13
        # Wakeups by frames, and ten checks per second.
        assert rings <= 2 * frames + 25


@pytest.mark.parametrize("polled", [False, True])
def test_a_signal_is_handled_while_waiting(node: belvedere.Node, polled: bool) -> None:
    class Signalled(Exception):
        pass

    def handler(*_: object) -> None:
        raise Signalled

    before = signal.signal(signal.SIGALRM, handler)
    try:
        with node.subscribe("tf_static") as transforms:
            next(transforms.frames(timeout=30))
            if polled:
                transforms.fileno()
            for _ in range(5):
                signal.setitimer(signal.ITIMER_REAL, 0.13)
                with pytest.raises(Signalled):
                    transforms.wait(10)
    finally:
        signal.signal(signal.SIGALRM, before)


def test_async_for(node: belvedere.Node) -> None:
    async def count(topic: str, wanted: int) -> list[int]:
        numbers = []
        with node.subscribe(topic) as subscriber:
            async for frame in subscriber:
                numbers.append(frame.seq)
                # The loop's body may itself await.
                await asyncio.sleep(0.01)
                if len(numbers) == wanted:
                    return numbers
        raise AssertionError

    async def both() -> tuple[list[int], list[int]]:
        started = time.process_time()
        pictures, scans = await asyncio.wait_for(asyncio.gather(count("image_raw", 30), count("scan", 5)), 30)
        assert time.process_time() - started < 0.5
        return pictures, scans

    pictures, scans = asyncio.run(both())
    assert pictures == sorted(set(pictures))
    assert len(scans) == 5


def test_image_depth_and_info_of_one_stamp(kinect: belvedere.Node) -> None:
    topics = ["camera/rgb/image_raw", "camera/depth/image_raw", "camera/rgb/camera_info"]
    with kinect.synchronize(topics) as sets:
        stamps = []
        for picture, depth, info in sets.sets(timeout=30):
            assert picture.stamp_ns == depth.stamp_ns == info.stamp_ns
            assert (picture.kind.name, depth.kind.name, info.kind.name) == ("IMAGE", "DEPTH_IMAGE", "CAMERA_INFO")
            assert picture.array.shape[:2] == depth.array.shape
            stamps.append(picture.stamp_ns)
            if len(stamps) == 20:
                break
        # For a camera of 10 Hz, no image is in two sets, and nearly each is in one.
        assert stamps == sorted(set(stamps))
        assert stamps[-1] - stamps[0] <= 2.5e9


def test_streams_of_different_rates(node: belvedere.Node) -> None:
    with node.synchronize(["scan", "image_raw"], tolerance=0.02) as sets:
        for count, (scan, picture) in enumerate(sets.sets(timeout=30), 1):
            assert abs(scan.stamp_ns - picture.stamp_ns) <= 20e6
            if count == 10:
                break
        # 30 images to 5.5 scans: the others were skipped, or replaced by newer ones.
        assert sets.skipped + sets.missed_total > 30


def test_missing_sets_are_a_timeout(alone: belvedere.Node) -> None:
    with alone.synchronize(["image_raw", "nothing/of/this"]) as sets:
        assert not sets.wait(0.2)
        assert sets.take() is None
        with pytest.raises(
            belvedere.StreamTimeoutError, match=r"image_raw, nothing/of/this with matching stamps for 0.1 s"
        ):
            next(sets.sets(timeout=0.1))
    with pytest.raises(ValueError, match="two streams"):
        alone.synchronize(["image_raw"])
    with pytest.raises(ValueError, match="tolerance is -1"):
        alone.synchronize(["image_raw", "scan"], tolerance=-1)


def test_a_close_ends_the_wait_of_another_thread(alone: belvedere.Node) -> None:
    subscriber = alone.subscribe("nothing/of/this")
    with ThreadPoolExecutor() as threads:
        waiting = threads.submit(subscriber.wait)
        # Its state can be read meanwhile.
        assert (subscriber.take(), subscriber.publishers, subscriber.missed_total) == (None, 0, 0)
        assert not waiting.done()
        subscriber.close()
        assert not waiting.result(timeout=30)
    assert subscriber.take() is None
    assert subscriber.silence > 0


PROGRAM = """
import belvedere, sys
node = belvedere.Node("last", domain=sys.argv[1])
camera = node.subscribe("image_raw")
frame = next(camera.frames(timeout=30))
if sys.argv[2] == "polled":
    camera.fileno()
if sys.argv[2] == "from the life before":
    print("first", flush=True)
    array = frame.array
    later = next(later for later in camera.frames(timeout=30) if later.session != frame.session)
print("ready", flush=True)
sys.stdin.read()
"""


@pytest.mark.parametrize("how", ["held", "polled", "from the life before"])
def test_the_last_process_leaves_no_files(simulator: Simulator, how: str) -> None:
    """This holds even if all objects are still in global variables at the end of the program."""
    command = [sys.executable, "-c", PROGRAM, simulator.domain, how]
    program = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    assert program.stdin is not None
    assert program.stdout is not None
    if how == "from the life before":
        assert program.stdout.readline() == "first\n"
        simulator.stop(signal.SIGKILL)
        simulator.start()
    assert program.stdout.readline() == "ready\n"
    simulator.stop(signal.SIGINT)
    program.stdin.close()
    assert program.wait(timeout=10) == 0
    program.stdout.close()
    uid = os.geteuid()
    prefix = f"blvd.{simulator.domain}~{uid}."
    left = [path for root in ("/dev/shm", f"/tmp/blvd~{uid}") for path in Path(root).rglob(f"{prefix}*")]
    assert left == []
