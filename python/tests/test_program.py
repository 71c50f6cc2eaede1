"""The command line in the package: ``python -m belvedere``."""

from __future__ import annotations

import fcntl
import os
import signal
import socket
import struct
import subprocess
import sys
import termios
import time
from typing import TYPE_CHECKING

import belvedere

if TYPE_CHECKING:
    from pathlib import Path

PROGRAM = [sys.executable, "-m", "belvedere"]
#: Where the participants of a domain of ROS 2 listen for what others announce, and the prefix of one that is made here.
DOMAIN_ID = 1 + os.getpid() % 200
PORTS = [7410 + 250 * DOMAIN_ID + 2 * number for number in range(5)]
PREFIX = b"test_program"


def said(*words: str, code: int = 0) -> str:
    done = subprocess.run([*PROGRAM, *words], capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == code, done
    return done.stdout + done.stderr


def announcement(port: int) -> bytes:
    """What a participant of RTPS announces of itself, if it listens on this port of this host."""
    locator = struct.pack("<iI12x4s", 1, port, socket.inet_aton("127.0.0.1"))
    parameters = [
        (0x15, bytes([2, 3, 0, 0])),
        (0x16, bytes(4)),
        (0x50, PREFIX + bytes([0, 0, 1, 0xC1])),
        (0x32, locator),
        (0x31, locator),
        (0x02, struct.pack("<iI", 20, 0)),
        (0x58, struct.pack("<I", 0x3F)),
        (0x01, b""),
    ]
    payload = b"\0\3\0\0" + b"".join(struct.pack("<HH", number, len(of)) + of for number, of in parameters)
    data = struct.pack("<HH4s4siI", 0, 16, bytes(4), bytes([0, 1, 0, 0xC2]), 0, 1) + payload
    return b"RTPS" + bytes([2, 3, 0, 0]) + PREFIX + struct.pack("<BBH", 0x15, 5, len(data)) + data


def heard(text: bytes) -> bool:
    """Return whether the participants of the domain on this host tell a new one of something with this text."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as listener:
        listener.bind(("127.0.0.1", PORTS[-1] + 4))
        listener.settimeout(0.2)
        end = time.monotonic() + 60
        while time.monotonic() < end:
            for port in PORTS:
                listener.sendto(announcement(listener.getsockname()[1]), ("127.0.0.1", port))
            try:
                while True:
                    if text in listener.recv(1 << 16):
                        return True
            except TimeoutError:
                pass
    return False


def test_commands_and_their_exit_codes(tmp_path: Path) -> None:
    assert said("--version").startswith("belvedere ")
    assert "kobuki_nostack_camera" in said("robots").split()
    assert "did you mean the command 'snapshot'" in said("snapshto", code=2)
    broken = tmp_path / "broken.urdf"
    broken.write_text("<robot")
    assert "broken.urdf:1: error: " in said("check", "--robot", str(broken), code=1)


def test_a_command_is_ended_by_ctrl_c(tmp_path: Path) -> None:
    pipe = tmp_path / "slow.urdf"
    os.mkfifo(pipe)
    words = [*PROGRAM, "check", "--robot", str(pipe)]
    with pipe.open("r+b", buffering=0) as robot:
        robot.write(b"<robot")
        with subprocess.Popen(words, stderr=subprocess.DEVNULL) as command:
            # The command has read this, and waits for more.
            while fcntl.ioctl(robot, termios.FIONREAD, bytes(4)) != bytes(4):
                assert command.poll() is None
                time.sleep(0.01)
            command.send_signal(signal.SIGINT)
            assert command.wait(timeout=30) == -signal.SIGINT


def test_a_simulator_is_a_node_of_ros2() -> None:
    domain = f"program-{os.getpid()}"
    words = ["run", "--domain", domain, "--drive", "still", "--ros2", "--ros-domain-id", str(DOMAIN_ID)]
    environment = {**os.environ, "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}
    command = [*PROGRAM, *words, "--remap", "/odom:=/base/odom"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, env=environment) as simulator:
        try:
            assert heard(b"rt/base/odom\0")
            with belvedere.Node(domain=domain) as node:
                next(node.subscribe("odom").frames(timeout=30))
                assert f"{node.streams()[0].topic}" in said("list", "--domain", domain)
        finally:
            # Ctrl-C ends it as it ends the program: with the table of streams, and without a traceback.
            simulator.send_signal(signal.SIGINT)
            _, errors = simulator.communicate(timeout=30)
    assert simulator.returncode == 0, errors
    assert b"/odom" in errors
    assert b"Traceback" not in errors
