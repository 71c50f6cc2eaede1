"""The hostile publisher of bridge/tests/hostile against this package. Run by .ci/hostile."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

import belvedere
from belvedere import wire

TOPIC = "hostile"
#: Number of random headers, in addition to each field's boundary values.
AT_RANDOM = 5_000
#: Duration in milliseconds.
REWRITING = 3_000

PUBLISHER = os.environ.get("BELVEDERE_HOSTILE")
#: The test of that program that plays the role.
TEST = "every_header_is_rejected_by_name_or_read_within_the_payload"


def read_all(frame: belvedere.Frame) -> None:
    payload = frame.payload
    assert len(payload) == int(frame.header["payload_len"])
    total = int(payload.sum())
    assert isinstance(frame.frame_id, str)
    assert frame.age_ns >= 0
    assert repr(frame)
    known = wire.element(int(frame.header["kind"]), int(frame.header["encoding"])) is not None
    for plane in ("array", "intensities"):
        try:
            values = getattr(frame, plane)
        except belvedere.BadFrameError:
            assert not known
            continue
        if values is not None and values.size > 0:
            begin = payload.__array_interface__["data"][0]
            low = values.__array_interface__["data"][0]
            spans = [(count - 1) * stride for count, stride in zip(values.shape, values.strides, strict=True)]
            assert min(spans) >= 0
            assert begin <= low
            assert low + sum(spans) + values.itemsize <= begin + len(payload)
            total += len(values.tobytes())
    assert total >= 0


def read_until_the_end(domain: str) -> tuple[int, int]:
    accepted = rejected = 0
    with belvedere.Node("hostile-py", domain=domain) as node, node.subscribe(TOPIC) as subscriber:
        while subscriber.wait(20.0):
            try:
                frame = subscriber.take()
            except belvedere.BadFrameError as error:
                assert len(error.args[0]) > 0  # noqa: PT017
                rejected += 1
                continue
            if frame is None:
                continue
            with frame:
                if frame.frame_id == "end":
                    return accepted, rejected
                accepted += 1
                read_all(frame)
    pytest.fail("no last frame")


@pytest.mark.skipif(PUBLISHER is None, reason="BELVEDERE_HOSTILE names no publisher: run .ci/hostile")
@pytest.mark.parametrize(("role", "argument"), [("attack", AT_RANDOM), ("rewrite", REWRITING)])
def test_every_header_is_rejected_or_read_within_the_payload(role: str, argument: int) -> None:
    domain = f"hostile-py-{os.getpid()}"
    environment = {
        **os.environ,
        "BRIDGE_TEST_ROLE": role,
        "BRIDGE_TEST_DOMAIN": domain,
        "BRIDGE_TEST_ARGUMENTS": f"1 {argument}",
    }
    command = [Path(str(PUBLISHER)), "--exact", TEST, "--nocapture"]
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True) as publisher:
        try:
            accepted, rejected = read_until_the_end(domain)
            assert publisher.stdout is not None
            lines = [line.split() for line in publisher.stdout if line.startswith("@ sent")]
        finally:
            # The publisher waits for its subscribers, and a failed test may still hold one.
            publisher.kill()
    sent, acceptable = (int(word) for word in lines[0][2:])
    assert rejected > 0
    if role == "attack":
        assert (accepted, accepted + rejected) == (acceptable, sent)
