"""The setup of check.py and figures.py: two network namespaces, the cable between them, and their programs."""

import contextlib
import json
import os
import signal
import statistics
import subprocess
import sys
import time
from pathlib import Path

link, folder, wanted = sys.argv[1], Path(sys.argv[2]), sys.argv[3:]
belvedere = os.environ.get("BELVEDERE_BIN", link)
here = Path(__file__).parent
# Both namespaces share /dev/shm, so each side has its own domain.
tag = os.getpid()
near, far = f"near-{tag}", f"far-{tag}"
spaces = {near: f"blvd-near-{tag}", far: f"blvd-far-{tag}"}
cables = {near: f"bn{tag}", far: f"bf{tag}"}
ADDRESS, FAR_ADDRESS = "10.77.15.1:7447", "10.77.15.2:7447"
# Zenoh forwards nothing from one peer to another, so an attacker of both sides must connect to both.
BOTH = f"tcp/{ADDRESS},tcp/{FAR_ADDRESS}"
# The default limit of open files of a user's process.
FILES = 1024
# The streams that are only sent with `send --commands all`.
CONTROL = {"/simulation/command", "/simulation/result"}
# A factor for timeouts on machines with other load.
PATIENCE = 3
# The durations of cable cuts in seconds.
CUTS = [float(word) for word in os.environ.get("CUTS", "1.5 2.5 8").split()]
running = []
parties = {}


def ip(*words):
    subprocess.run(("ip", *words), check=True)


def inside(domain, *words):
    return ("ip", "netns", "exec", spaces[domain], *words)


def start(name, domain, *words):
    with open(folder / f"{name}.log", "ab") as log:
        process = subprocess.Popen(inside(domain, *words), stdout=log, stderr=log)
    process.log = folder / f"{name}.log"
    running.append(process)
    return process


def end(process, how=signal.SIGTERM):
    process.send_signal(how)
    try:
        process.wait(15)
    except subprocess.TimeoutExpired:
        raise SystemExit(f"{process.args} does not end") from None
    running.remove(process)
    return process.returncode


def ended_well(process):
    code = end(process, signal.SIGINT)
    assert code == 0, f"{process.args} ended with {code}:\n{process.log.read_text()}"


class Frames:
    """A consumer in another process, and its output."""

    number = 0

    def __init__(self, domain, topic):
        Frames.number += 1
        self.path = folder / f"frames-{Frames.number}"
        self.path.touch()
        script = str(here / "frames.py")
        self.process = start(
            f"consumer-{Frames.number}", domain, sys.executable, script, domain, topic, str(self.path)
        )

    def now(self):
        """The frames so far: by session and number, (stamp, sent, taken, missed, hash)."""
        found = {}
        for line in self.path.read_text().splitlines():
            words = line.split()
            if len(words) == 7:
                session, seq, stamp, sent, taken, missed = map(int, words[:6])
                found[session, seq] = (stamp, sent, taken, missed, words[6])
        return found

    def wait(self, count, seconds, what):
        """Waits for this many further frames."""
        before, deadline = len(self.now()), time.monotonic() + PATIENCE * seconds
        while len(self.now()) < before + count:
            assert time.monotonic() < deadline, (
                f"{what}: {len(self.now()) - before} of {count} frames in {seconds} s"
            )
            assert self.process.poll() is None, f"{what}: the consumer has ended"
            time.sleep(0.02)

    def end(self):
        end(self.process)
        return self.now()


def send(*words, address=ADDRESS):
    return start("send", near, link, "link", "send", "--domain", near, "--listen", f"tcp/{address}", *words)


def receive(*words, address=ADDRESS):
    words = ("--domain", far, "--from", near, "--connect", f"tcp/{address}", *words)
    return start("receive", far, "prlimit", f"--nofile={FILES}", link, "link", "receive", *words)


def listed(domain):
    words = inside(domain, belvedere, "list", "--domain", domain, "--json")
    said = subprocess.run(words, capture_output=True, text=True, check=False).stdout
    return {stream["topic"]: stream for stream in map(json.loads, said.splitlines())}


def until(holds, seconds, what):
    deadline = time.monotonic() + PATIENCE * seconds
    while not holds():
        assert time.monotonic() < deadline, f"not within {seconds} s: {what}"
        time.sleep(0.05)


def compared(topic, what, count, seconds, *, lossless=False):
    """Takes a stream on both sides, compares every frame that was transferred, and prints statistics."""
    sides = [Frames(domain, topic) for domain in (near, far)]
    for side in sides:
        side.wait(1, 15, f"{what}: {topic}")
    sides[1].wait(count, seconds, f"{what}: {topic}")
    after, before = sides[1].end(), sides[0].end()
    common = sorted(set(before) & set(after))
    assert len(common) >= count * 0.7, f"{what}: {len(common)} frames of {topic} on both sides"
    for key in common:
        assert before[key][4] == after[key][4], f"{what}: {topic}: frame {key} differs on the other side"
        assert before[key][0] == after[key][0]
    # Between the first and the last transferred frame.
    sent = [key for key in before if common[0] <= key <= common[-1]]
    lost = len(sent) - len(common)
    latencies = sorted((after[key][2] - before[key][1]) / 1e6 for key in common)
    percent = 100 * lost / len(sent)
    p99 = latencies[min(len(latencies) - 1, int(len(latencies) * 0.99))]
    seconds = (before[common[-1]][1] - before[common[0]][1]) / 1e9
    print(
        f"{what}: {topic}: {len(common)} frames in {seconds:.1f} s, all bytes equal, {lost} lost ({percent:.1f} %), "
        f"from sending to taking {statistics.median(latencies):.2f} ms median, {p99:.2f} ms p99",
        flush=True,
    )
    assert not lossless or lost == 0, f"{what}: {lost} frames of {topic} were lost"


def drive(domain, velocity, seconds):
    words = (sys.executable, "-c", DRIVE, domain, str(velocity), str(seconds))
    subprocess.run(inside(domain, *words), check=True)


DRIVE = """
import belvedere, sys, time
domain, velocity, seconds = sys.argv[1], float(sys.argv[2]), float(sys.argv[3])
with belvedere.Node("driver", domain=domain) as node:
    with node.subscribe("odom") as odom, node.velocity_publisher("cmd_vel") as wheels:
        assert wheels.wait(10), "the commands have no subscriber"
        end = time.monotonic() + seconds
        fastest = 0.0
        while time.monotonic() < end:
            wheels.send(velocity, 0.0)
            odom.wait(0.1)
            while (frame := odom.take()) is not None:
                with frame:
                    fastest = max(fastest, float(frame.array["linear"].ravel()[0]))
            time.sleep(0.02)
        assert fastest > velocity * 0.8, f"commanded {velocity} m/s, measured {fastest}"
        print(f"commands: {velocity} m/s commanded there, {fastest:.2f} m/s measured here", flush=True)
"""


def cable(state):
    ip("-n", spaces[near], "link", "set", cables[near], state)


def shape(*words):
    """Limits the bandwidth of the cable, or adds latency or losses; False if this kernel cannot."""
    for domain in (near, far):
        tc = ("tc", "qdisc", "replace", "dev", cables[domain], "root", *words)
        if subprocess.run(inside(domain, *tc), check=False, capture_output=True).returncode != 0:
            return False
    return True


def lay_cable():
    address, far_address = (whole.partition(":")[0] for whole in (ADDRESS, FAR_ADDRESS))
    for space in spaces.values():
        ip("netns", "add", space)
        ip("-n", space, "link", "set", "lo", "up")
    ends = ("link", "add", cables[near], "netns", spaces[near], "type", "veth", "peer")
    ip(*ends, "name", cables[far], "netns", spaces[far])
    for domain, own in ((near, address), (far, far_address)):
        plug(domain, cables[domain], own)


def plug(domain, device, address):
    """Assigns an address to a network device of a namespace, and brings it up."""
    ip("-n", spaces[domain], "address", "add", f"{address}/24", "dev", device)
    ip("-n", spaces[domain], "link", "set", device, "up")


def show_logs():
    for log in sorted(folder.glob("*.log")):
        print(f"--- {log.name}\n{log.read_text()[-4000:]}", file=sys.stderr)


def strike():
    """Removes the setup."""
    for process in running:
        with contextlib.suppress(ProcessLookupError):
            process.kill()
            process.wait()
    for domain, space in spaces.items():
        # Joining a domain removes the files of killed processes and leaves nothing; no other process joins these
        # domains later.
        subprocess.run((belvedere, "list", "--domain", domain), check=False, capture_output=True)
        subprocess.run(("ip", "netns", "del", space), check=False, stderr=subprocess.DEVNULL)
