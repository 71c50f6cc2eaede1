"""Measures the latency of pictures of 640 x 480 at 30 Hz, and of commands, over a link and by other ways in the same run.

figures.py BELVEDERE FOLDER [PART…]: as check.py; the parts are the names of lines. The rounds of all ways alternate.
For each way it prints the round with the least loss, to 2 %, and of these the one with the lowest median, because other
load of the machine only adds to both; and the medians of all rounds. Environment: ROUNDS (3), SECONDS of each (6),
WAYS, CONGESTION (cubic).
"""

import contextlib
import json
import os
import signal
import statistics
import subprocess
import sys
import time

from stage import (
    ADDRESS,
    FAR_ADDRESS,
    belvedere,
    cables,
    ended_well,
    far,
    here,
    inside,
    ip,
    lay_cable,
    listed,
    near,
    parties,
    plug,
    receive,
    running,
    send,
    shape,
    show_logs,
    spaces,
    start,
    strike,
    until,
    wanted,
)

ROUNDS = int(os.environ.get("ROUNDS", "3"))
SECONDS = float(os.environ.get("SECONDS", "6"))
CONGESTION = os.environ.get("CONGESTION", "cubic")
OPTIONS = os.environ.get("OPTIONS", "")
WAYS = os.environ.get("WAYS", "tcp link zenoh zenoh-default").split()
# Name, arguments of `tc`, arguments of line.py (delay and jitter in each direction in ms, percent of lost packets).
LINES = (
    ("free", None, None),
    ("300 Mbit/s", ("tbf", "rate", "300mbit", "burst", "256kb", "latency", "50ms"), None),
    ("100 Mbit/s", ("tbf", "rate", "100mbit", "burst", "256kb", "latency", "50ms"), None),
    ("20 ms", None, ("20", "2", "0")),
    ("100 ms", None, ("100", "10", "0")),
    ("0.1 % lost", None, ("5", "0", "0.1")),
)
LONG = ("10.77.16.1", "10.77.16.2")
TICKS = os.sysconf("SC_CLK_TCK")
ports = iter(range(7500, 60000))


def cpu_s(process):
    """CPU time of a process, s."""
    words = open(f"/proc/{process.pid}/stat").read().rpartition(")")[2].split()
    return (int(words[11]) + int(words[12])) / TICKS


def round_of(way, host):
    """Sends pictures and commands by one way, for some seconds."""
    address = f"{host}:{next(ports)}"
    script = (sys.executable, str(here / "ways.py"), way)
    links = [parties["sender"], parties["receiver"]] if way == "link" else []
    spawn = {"stdout": subprocess.PIPE, "text": True}
    with subprocess.Popen(inside(near, *script, "here", near, address), **spawn) as sender:
        running.append(sender)
        before = sum(map(cpu_s, links))
        words = inside(far, *script, "there", far, address, str(SECONDS))
        said = subprocess.run(words, **spawn, check=True, timeout=SECONDS + 60)
        links_s = sum(map(cpu_s, links)) - before
        sender.send_signal(signal.SIGTERM)
        there, this = json.loads(said.stdout), json.loads(sender.stdout.read())
        running.remove(sender)
    sent = dict(this["sent"])
    pictures = [(seq, (taken - sent[seq]) / 1e6) for seq, taken in there["pictures"] if seq in sent]
    late = sorted(ms for _, ms in pictures)
    back = sorted((taken - sent) / 1e6 for sent, taken in this["commands"])
    # The stream of commands exists once the first command has arrived; earlier ones had no subscriber.
    first = this["commands"][0][0] - 1000
    commands = sum(sent > first for sent in there["commands"])
    all_sent = pictures[-1][0] - pictures[0][0] + 1
    cpu = there["cpu_s"] + links_s + (0 if links else this["cpu_s"])
    return {
        "lost": all_sent - len(pictures),
        "of": all_sent,
        "median": statistics.median(late),
        "p99": late[int(len(late) * 0.99)],
        "back": statistics.median(back),
        "back99": back[int(len(back) * 0.99)],
        "back_lost": commands - len(back),
        "cpu": 1e3 * cpu / len(pictures),
    }


def as_usual(domain, device, host):
    """Sets the congestion control of TCP to Linux's default, whatever this machine's is."""
    net = host.rpartition(".")[0] + ".0/24"
    words = ("dev", device, "proto", "kernel", "scope", "link", "src", host, "congctl", CONGESTION)
    ip("-n", spaces[domain], "route", "change", net, *words)


@contextlib.contextmanager
def long_line(words):
    """Replaces the cable by line.py."""
    devices = [f"t{cables[domain]}" for domain in (near, far)]
    line = [sys.executable, str(here / "line.py"), *devices, *words]
    with subprocess.Popen(line, stdout=subprocess.PIPE, text=True) as process:
        running.append(process)
        assert process.stdout.readline() == "there\n"
        for domain, device, host in zip((near, far), devices, LONG, strict=True):
            ip("link", "set", device, "txqueuelen", "20000", "netns", spaces[domain])
            plug(domain, device, host)
            as_usual(domain, device, host)
        yield
        process.send_signal(signal.SIGTERM)
        did = json.loads(process.stdout.read())
        running.remove(process)
    print(
        f"  the line carried {did['carried']} packets, lost {did['lost']}, was late by {did['latest_ms']:.1f} ms at most"
    )


def measured(name, host):
    """Measures all ways over a line, alternating between them."""
    address = f"{host}:7447"
    topics = ("image_raw", "cmd_vel")
    parties["sender"] = send(*topics, address=address + OPTIONS)
    parties["receiver"] = receive(*topics, address=address)
    until(lambda: "/image_raw" in listed(far), 20, "streams on the other side")
    links = [parties["sender"], parties["receiver"]]
    before = sum(map(cpu_s, links))
    time.sleep(2)
    print(
        f"{name}: a link without subscribers: {(sum(map(cpu_s, links)) - before) * 50:.1f} % of a core",
        flush=True,
    )
    rounds = {way: [] for way in WAYS}
    for number in range(ROUNDS):
        for at in range(len(WAYS)):
            way = WAYS[(at + number) % len(WAYS)]
            rounds[way].append(round_of(way, host))
    for role in ("receiver", "sender"):
        ended_well(parties.pop(role))
    best = {
        way: min(said, key=lambda one: (one["lost"] * 50 // one["of"], one["median"]))
        for way, said in rounds.items()
    }
    wire = best.get("tcp")
    for way, one in best.items():
        medians = ", ".join(f"{said['median']:.2f}" for said in rounds[way])
        lost = ", ".join(f"{said['lost']}/{said['of']}" for said in rounds[way])
        ratio = f", {one['median'] / wire['median']:.2f} of tcp" if wire else ""
        print(
            f"{name}: {way}: pictures {one['lost']}/{one['of']} lost, {one['median']:.2f} ms median{ratio}, "
            f"{one['p99']:.2f} ms p99, {one['cpu']:.2f} ms of CPU each; commands back {one['back']:.2f} ms median, "
            f"{one['back99']:.2f} ms p99, {one['back_lost']} lost; (medians {medians}; lost {lost})",
            flush=True,
        )


# Namespaces and processes are removed, however this ends.
signal.signal(signal.SIGTERM, lambda *_: sys.exit("ended from outside"))
try:
    lay_cable()
    for domain, whole in ((near, ADDRESS), (far, FAR_ADDRESS)):
        as_usual(domain, cables[domain], whole.partition(":")[0])
    parties["simulator"] = start("simulator", near, belvedere, "run", "--domain", near, "--drive", "still")
    until(lambda: "/image_raw" in listed(near), 60, "a simulator")
    for name, words, line in LINES:
        if wanted and name not in wanted:
            continue
        if words is not None and not shape(*words):
            print(f"{name}: skipped, this kernel has no {words[0]}")
            continue
        with long_line(line) if line else contextlib.nullcontext():
            measured(name, LONG[0] if line else ADDRESS.partition(":")[0])
        if words:
            for domain in (near, far):
                subprocess.run(inside(domain, "tc", "qdisc", "del", "dev", cables[domain], "root"), check=True)
    ended_well(parties.pop("simulator"))
except BaseException:
    show_logs()
    raise
finally:
    strike()
