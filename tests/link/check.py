"""Tests a link between a simulator in one network namespace and consumers of its streams in another.

check.py BELVEDERE FOLDER [PART…]: the first is built with the feature `link`; the simulator, and all other commands, are
BELVEDERE_BIN if that is set. Needs root, `ip` and `tc` of iproute2, and the Python packages belvedere and eclipse-zenoh.
Prints measurements; ends with an error if a check fails.
"""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

from stage import (
    BOTH,
    CONTROL,
    CUTS,
    FAR_ADDRESS,
    FILES,
    Frames,
    belvedere,
    cable,
    cables,
    compared,
    drive,
    end,
    ended_well,
    far,
    here,
    inside,
    ip,
    lay_cable,
    link,
    listed,
    near,
    parties,
    receive,
    running,
    send,
    shape,
    show_logs,
    start,
    strike,
    until,
    wanted,
)


def begin():
    """The far side is started first: it keeps trying to connect, and reports that."""
    parties["receiver"] = receiver = receive()
    until(lambda: "there is no connection" in receiver.log.read_text(), 20, "a report that there is no connection")
    parties["simulator"] = start("simulator", near, belvedere, "run", "--domain", near, "--drive", "still")
    until(lambda: "/image_raw" in listed(near), 60, "a simulator")
    parties["sender"] = send()
    until(all_there, 20, "its streams on the other side")


def described():
    """Streams are described in the same way on both sides."""
    described = ("kind", "encoding", "rate_hz", "frame_id", "layers", "max_payload_bytes")
    here_now, there_now = listed(near), listed(far)
    assert set(here_now) - set(there_now) == CONTROL, set(here_now) ^ set(there_now)
    for topic, stream in there_now.items():
        assert [stream[name] for name in described] == [here_now[topic][name] for name in described], topic
    print(f"{len(there_now)} streams are described there as here", flush=True)


def interest():
    """A stream is only rendered while it has a subscriber on the far side."""
    time.sleep(1)
    assert listed(near)["/image_raw"]["subscribers"] == 0, "pictures are taken without a subscriber"
    looker = Frames(far, "image_raw")
    looker.wait(5, 20, "pictures on the other side")
    assert listed(near)["/image_raw"]["subscribers"] == 1
    looker.end()
    until(lambda: listed(near)["/image_raw"]["subscribers"] == 0, 5, "the end of interest")
    print("a stream without subscribers there is not taken here", flush=True)


def free():
    compared("image_raw", "a free cable", 330, 60)
    compared("scan", "a free cable", 20, 20)
    late = Frames(far, "tf_static")
    late.wait(1, 5, "a frame that was sent once, long ago")
    late.end()
    drive(far, 0.3, 2)


def cut():
    """Cuts the cable for less than, more than and exactly the two seconds after which a connection is closed."""
    for seconds in CUTS:
        here_side, there_side = Frames(near, "odom"), Frames(far, "odom")
        pictures = Frames(far, "image_raw")
        pictures.wait(10, 20, "pictures before the cut")
        there_side.wait(10, 10, "odometry before the cut")
        cable("down")
        time.sleep(seconds)
        cable("up")
        mended = time.monotonic()
        pictures.wait(1, 3, f"pictures after {seconds} s without a cable")
        again = time.monotonic() - mended
        pictures.wait(30, 20, "more of them")
        there_side.wait(30, 20, "odometry after the cut")
        after, before = there_side.end(), here_side.end()
        pictures.end()
        keys = sorted(before)
        stamps = [before[key][0] for key in keys]
        # The simulator's local consumer has lost nothing, so the simulator did not wait.
        assert sum(frame[3] for frame in before.values()) == 0, "frames were lost on the simulator's side"
        wall = [before[key][1] for key in keys]
        slowest = max(b - a for a, b in zip(wall, wall[1:], strict=False)) / 1e6
        assert seconds < 5 or slowest < 4000, f"the simulator stood for {slowest} ms"
        first, last = min(after), max(after)
        lost = last[1] - first[1] + 1 - len(after)
        reported = sum(frame[3] for key, frame in after.items() if key != first)
        assert lost == reported, f"{lost} lost, {reported} reported to consumers"
        assert all(before[key][4] == frame[4] for key, frame in after.items() if key in before)
        print(
            f"cable cut for {seconds} s: pictures again {again:.1f} s after it was reconnected; {lost} frames of odometry lost, as "
            f"reported to consumers; the simulator sent {len(stamps)} meanwhile, its longest pause {slowest:.0f} ms",
            flush=True,
        )


def kills():
    """Kills either side."""
    for name, role, again_started in (("send", "sender", send), ("receive", "receiver", receive)):
        there_side = Frames(far, "image_raw")
        there_side.wait(10, 20, "pictures before a kill")
        victim = parties[role]
        running.remove(victim)
        victim.kill()
        victim.wait()
        time.sleep(1)
        killed = time.monotonic()
        parties[role] = again_started()
        there_side.wait(1, 30, f"pictures after `{name}` was killed")
        again = time.monotonic() - killed
        there_side.wait(30, 20, "more of them")
        frames = there_side.end()
        assert len({session for session, _ in frames}) == 1, "the same simulator is reported as another one"
        print(f"`link {name}` killed and started again: pictures again after {again:.1f} s", flush=True)
    drive(far, 0.2, 2)


def narrow():
    """Lines with low bandwidth, high latency, or losses."""
    for what, words in (
        ("100 Mbit/s", ("tbf", "rate", "100mbit", "burst", "256kb", "latency", "50ms")),
        ("300 Mbit/s", ("tbf", "rate", "300mbit", "burst", "256kb", "latency", "50ms")),
        ("100 Mbit/s, 20 ms there and back", ("netem", "delay", "10ms", "rate", "100mbit", "limit", "10000")),
        ("1 % of packets lost, 2 ms there and back", ("netem", "delay", "1ms", "loss", "1%", "limit", "10000")),
    ):
        if not shape(*words):
            print(f"{what}: skipped, this kernel has no {words[0]}")
            continue
        compared("image_raw", what, 60, 60)
        compared("odom", what, 100, 30)
    for domain in (near, far):
        subprocess.run(inside(domain, "tc", "qdisc", "del", "dev", cables[domain], "root"), check=True)


def listening(*words):
    """Starts a receiver to which others can connect; returns the shared memory that was used before."""
    ended_well(parties["receiver"])
    until(lambda: not listed(far), 10, "the end of all streams over there")
    before = taken_memory()
    parties["receiver"] = receive("--listen", f"tcp/{FAR_ADDRESS}", *words)
    until(all_there, 20, "all streams on the other side")
    return parties["receiver"], before


def all_there():
    """Whether all streams of this side except those for controlling the simulation exist on the other side."""
    return set(listed(near)) - set(listed(far)) == CONTROL and set(listed(far)) <= set(listed(near))


def hostile():
    """A hostile program sends invalid messages by Zenoh."""
    listening()
    words = (sys.executable, str(here / "hostile.py"))
    watched = Frames(far, "image_raw")
    watched.wait(10, 20, "pictures before the attack")
    attack = inside(far, *words, BOTH, near, "6")
    attack = subprocess.run(attack, check=True, capture_output=True, text=True)
    watched.end()
    for role in ("sender", "receiver"):
        assert parties[role].poll() is None, f"the {role} did not survive"
    # The messages arrived: each side refused some of them.
    for role in ("sender", "receiver"):
        assert "was refused" in parties[role].log.read_text(), f"the {role} received nothing"
    print(f"{attack.stdout.strip()} hostile messages")
    compared("image_raw", "after hostile messages", 60, 30)
    until(all_there, 10, "all streams after them")


def flood():
    """A program announces more streams than fit into memory."""
    most = 1500 << 20
    receiver, before = listening("--memory", str(most >> 20))
    watched = Frames(far, "image_raw")
    watched.wait(10, 20, "pictures before the flood")
    log = receiver.log.read_text()
    words = inside(far, sys.executable, str(here / "flood.py"), BOTH, near, "8")
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as attack:
        memory, streams, files = 0, 0, 0
        while attack.poll() is None:
            # `ip netns exec` replaces itself by the program that it runs.
            memory = max(memory, taken_memory() - before)
            files = max(files, len(list(Path(f"/proc/{receiver.pid}/fd").iterdir())))
            streams = max(streams, len(listed(far)))
        said = attack.stdout.read().strip()
    assert attack.returncode == 0
    watched.end()
    assert receiver.poll() is None, "the receiver did not survive"
    # They were announced, and some of them were opened.
    assert streams > len(listed(near)) + 10, streams
    assert memory < most, f"{memory >> 20} MiB of shared memory were taken"
    assert files < FILES, f"{files} open files"
    logged = receiver.log.read_text().removeprefix(log)
    assert "open files (os" not in logged, logged
    warnings = [line for line in logged.splitlines() if "is not opened" in line]
    assert len(warnings) == 1 and "--memory" in warnings[0] and "flood/" in warnings[0], logged
    print(
        f"{said}: at most {streams} streams open, {files} files, {memory >> 20} MiB more in /dev/shm, of {most >> 20} that "
        f"were allowed",
        flush=True,
    )
    until(all_there, 10, "the end of the flood")
    compared("image_raw", "after the flood", 60, 30)


def taken_memory():
    state = os.statvfs("/dev/shm")
    return (state.f_blocks - state.f_bfree) * state.f_frsize


def another_simulator():
    """The simulator ends, and another one is started."""
    ended_well(parties["simulator"])
    until(lambda: "/image_raw" not in listed(far), 10, "the end of its streams over there")
    again = Frames(far, "image_raw")
    parties["simulator"] = start(
        "simulator", near, belvedere, "run", "--domain", near, "--drive", "spin", "--seed", "2"
    )
    again.wait(10, 60, "pictures of the next simulator")
    again.end()


def control():
    """Allows all commands, and sends only some streams."""
    ended_well(parties["sender"])
    until(lambda: not listed(far), 10, "the end of all streams over there")
    parties["sender"] = send("--commands", "all")
    until(lambda: "/simulation/result" in listed(far), 20, "the simulation's results on the other side")
    for words in (("pause",), ("step", "3"), ("resume",)):
        subprocess.run(inside(far, belvedere, "control", "--domain", far, *words), check=True, capture_output=True)
    print("the simulation was paused, stepped and resumed from there")
    ended_well(parties["receiver"])
    parties["receiver"] = receive("/scan", "odom")
    until(lambda: set(listed(far)) == {"/scan", "/odom"}, 20, "only two streams")


def second():
    """A second link in the same domain is refused."""
    other = receive("/scan")
    assert other.wait(20) == 1 and "is in use" in other.log.read_text(), other.log.read_text()
    running.remove(other)


# Namespaces and processes are removed, however this ends.
signal.signal(signal.SIGTERM, lambda *_: sys.exit("ended from outside"))
try:
    lay_cable()
    begin()
    for part in (described, interest, free, cut, kills, narrow, hostile, flood, another_simulator, control, second):
        if not wanted or part.__name__ in wanted:
            part()
    for party in parties.values():
        ended_well(party)
    left = [path.name for path in Path("/dev/shm").iterdir() if near in path.name or far in path.name]
    assert not left, f"left in /dev/shm: {left}"
except BaseException:
    show_logs()
    raise
finally:
    strike()
