"""Sends pictures of a simulator to another machine, and commands back, by several ways.

ways.py WAY here DOMAIN ADDRESS: on the simulator's machine, until SIGTERM.
ways.py WAY there DOMAIN ADDRESS SECONDS: on the other machine, for this time after the first picture.
Each prints, as JSON, the times at which it sent and received pictures (by number) and commands, in ns of the clock,
which both sides share because they are on one machine. CPU time is counted from the first to the last picture.

| way | is |
|---|---|
| `link` | `belvedere link`, which the caller has started: consumers of the streams |
| `tcp` | one connection, each message after its length; the newest picture once the previous one is written |
| `zenoh` | Zenoh's Python package with the settings of `src/link/transport.rs` |
| `zenoh-default` | the same with Zenoh's own settings |
"""

import contextlib
import json
import os
import re
import signal
import socket
import struct
import sys
import threading
import time
from pathlib import Path

import belvedere

#: The header of a picture's message: its number.
HEADER = struct.Struct("<Q")
#: The length before each message of TCP.
LENGTH = struct.Struct("<Q")
SENT = struct.Struct("<Q")
COMMANDS_HZ = 20.0
TOPIC = "image_raw"


def now_ns():
    return time.clock_gettime_ns(time.CLOCK_MONOTONIC)


class Link:
    """Consumers of the link's streams on both sides, and a sender of commands."""

    def __init__(self, domain, _address):
        self.node = belvedere.Node("ways", domain=domain)

    def send_pictures(self, is_over, sent):
        """The link sends the pictures; here only their times are recorded, because the far header has the far side's."""
        with self.node.subscribe(TOPIC) as pictures:
            while not is_over.is_set():
                if pictures.wait(0.05) and (frame := pictures.take()) is not None:
                    with frame:
                        sent[frame.seq] = int(frame.header["publish_mono_ns"])

    def take_commands(self, take):
        with self.node.subscribe("cmd_vel") as commands:
            while commands.wait():
                while (frame := commands.take()) is not None:
                    taken = now_ns()
                    with frame:
                        # A wheeled robot ignores an upward velocity, which carries the number.
                        take(round(float(frame.array["linear"].ravel()[2]) * 1e9), taken)

    def take_pictures(self, take):
        with self.node.subscribe(TOPIC) as pictures:
            while pictures.wait():
                while (frame := pictures.take_newest()) is not None:
                    taken = now_ns()
                    with frame:
                        if not take(frame.seq, taken):
                            return

    def commander(self):
        wheels = self.node.velocity_publisher("cmd_vel")
        assert wheels.wait(10), "the commands have no subscriber"
        return lambda sent: wheels.send(linear=(0.0, 0.0, sent / 1e9))


class Plain:
    """A consumer on the simulator's machine that forwards pictures."""

    def __init__(self, domain):
        self.domain = domain

    def send_pictures(self, is_over, sent):
        with belvedere.Node("ways", domain=self.domain) as node, node.subscribe(TOPIC) as pictures:
            while not is_over.is_set():
                if pictures.wait(0.05) and (frame := pictures.take_newest()) is not None:
                    with frame:
                        sent[frame.seq] = int(frame.header["publish_mono_ns"])
                        self.send(HEADER.pack(frame.seq), frame.payload)


class Tcp(Plain):
    """A length, a message, a length."""

    def __init__(self, domain, address, is_here):
        super().__init__(domain)
        host, port = address.split(":")
        if is_here:
            with socket.create_server((host, int(port))) as server:
                self.socket, _ = server.accept()
        else:
            self.socket = called(host, int(port))
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.room = bytearray(64)

    def send(self, header, payload):
        self.socket.sendall(LENGTH.pack(len(header) + len(payload)) + header)
        self.socket.sendall(payload)

    def receive(self, length):
        if len(self.room) < length:
            self.room = bytearray(length)
        view, at = memoryview(self.room)[:length], 0
        while at < length:
            got = self.socket.recv_into(view[at:])
            if got == 0:
                return None
            at += got
        return view

    def messages(self):
        while (length := self.receive(LENGTH.size)) is not None:
            message = self.receive(LENGTH.unpack(length)[0])
            if message is None:
                return
            yield message, now_ns()

    def take_commands(self, take):
        with contextlib.suppress(ConnectionError):
            for message, taken in self.messages():
                take(SENT.unpack(message)[0], taken)

    def take_pictures(self, take):
        for message, taken in self.messages():
            if not take(*HEADER.unpack_from(message), taken):
                return

    def commander(self):
        return lambda sent: self.socket.sendall(LENGTH.pack(SENT.size) + SENT.pack(sent))


def called(host, port):
    deadline = time.monotonic() + 10
    while True:
        try:
            return socket.create_connection((host, port), 2)
        except OSError:
            assert time.monotonic() < deadline, f"nothing listens at {host}:{port}"
            time.sleep(0.05)


class Zenoh(Plain):
    """Put and subscribe."""

    def __init__(self, domain, address, is_here, settings):
        super().__init__(domain)
        import zenoh

        self.zenoh = zenoh
        config = zenoh.Config()
        ends = ("listen", "connect") if is_here else ("connect", "listen")
        own = {
            "scouting/multicast/enabled": "false",
            # Here, both sides are on one machine, which Zenoh would notice: messages would bypass the line.
            "transport/shared_memory/enabled": "false",
            f"{ends[0]}/endpoints": json.dumps([f"tcp/{address}"]),
            f"{ends[1]}/endpoints": "[]",
        }
        for key, value in (settings | own).items():
            config.insert_json5(key, value)
        self.session = zenoh.open(config)
        # Zenoh's own defaults, unless other settings are requested.
        self.qos = {}
        if settings:
            drop = zenoh.CongestionControl.DROP
            self.qos = {"congestion_control": drop, "priority": zenoh.Priority.DATA, "express": True}
        key = "pictures" if is_here else "commands"
        self.publisher = self.session.declare_publisher(f"ways/{key}", **self.qos)

    def send(self, header, payload):
        self.publisher.put(b"".join((header, payload)))

    def take(self, key, take):
        is_over = threading.Event()

        def taken(sample):
            message = sample.payload.to_bytes()
            if take(message, now_ns()) is False:
                is_over.set()

        with self.session.declare_subscriber(f"ways/{key}", taken):
            is_over.wait()

    def take_commands(self, take):
        self.take("commands", lambda message, taken: take(SENT.unpack(message)[0], taken))

    def take_pictures(self, take):
        self.take("pictures", lambda message, taken: take(*HEADER.unpack_from(message), taken))

    def commander(self):
        return lambda sent: self.publisher.put(SENT.pack(sent))


def links_settings():
    """The pictures of the link, with their times."""
    source = (Path(__file__).parents[2] / "src/link/transport.rs").read_text()
    settings = dict(re.findall(r'^    \("(\w[\w/]+)", "(.*)"\),$', source, re.MULTILINE))
    assert len(settings) > 8, settings
    return settings | {"transport/link/rx/max_message_size": str(128 << 20)}


def opened(way, domain, address, is_here):
    match way:
        case "link":
            return Link(domain, address)
        case "tcp":
            return Tcp(domain, address, is_here)
        case "zenoh":
            return Zenoh(domain, address, is_here, links_settings())
        case "zenoh-default":
            return Zenoh(domain, address, is_here, {})
    raise SystemExit(f"unknown way {way}")


def here(way, domain, address):
    is_over = threading.Event()
    signal.signal(signal.SIGTERM, lambda *_: is_over.set())
    commands, sent = [], {}
    opened_way = opened(way, domain, address, True)
    began = time.process_time()

    def send():
        # The other side ends first.
        with contextlib.suppress(ConnectionError):
            opened_way.send_pictures(is_over, sent)

    def take():
        opened_way.take_commands(lambda *command: commands.append(command))

    # There is no wait for either: Zenoh can wait minutes for room on a lossy line whose other side is gone.
    for task in (send, take):
        threading.Thread(target=task, daemon=True).start()
    is_over.wait()
    say({"sent": list(sent.items()), "commands": commands, "cpu_s": time.process_time() - began})


def there(way, domain, address, seconds):
    opened_way = opened(way, domain, address, False)
    pictures, began, sent, cpu = [], None, [], []
    is_over = threading.Event()

    def take(*picture):
        nonlocal began
        if began is None:
            began = time.monotonic()
        pictures.append(picture)
        cpu.append(time.process_time())
        if time.monotonic() - began < seconds:
            return True
        is_over.set()
        return False

    def command():
        tell = opened_way.commander()
        while not is_over.wait(1 / COMMANDS_HZ):
            sent.append(now_ns())
            tell(sent[-1])

    commander = threading.Thread(target=command)
    commander.start()
    opened_way.take_pictures(take)
    commander.join()
    # The last of them are still in transit.
    time.sleep(0.5)
    say({"pictures": pictures, "cpu_s": cpu[-1] - cpu[0], "commands": sent})


def say(said):
    print(json.dumps(said), flush=True)


if __name__ == "__main__":
    way, side, domain, address, *rest = sys.argv[1:]
    if side == "here":
        here(way, domain, address)
    else:
        there(way, domain, address, float(rest[0]))
    # There is no wait for threads and sessions that wait for the other side.
    os._exit(0)
