"""A line with latency and packet loss, like netem, for kernels without it.

line.py DEVICE DEVICE DELAY_MS JITTER_MS LOSS_PERCENT: creates two network devices and forwards packets from one to the
other. Each packet is delayed, with jitter but in order, and some are dropped. The devices are the kernel's (TUN), so
TCP has real round trips and real losses. Prints "there" once the devices exist; they are removed when it ends. On
SIGTERM it prints the number of forwarded and dropped packets, and its own largest delay.
"""

import fcntl
import json
import os
import random
import select
import signal
import struct
import sys
import time
from collections import deque

TUNSETIFF = 0x400454CA
IFF_TUN, IFF_NO_PI = 0x0001, 0x1000
#: The greatest number of waiting packets per direction; further ones are dropped, like netem's `limit`.
MOST = 100_000
#: The number of packets that are read at once before the other direction is served.
BATCH = 64


def device(name):
    file = os.open("/dev/net/tun", os.O_RDWR | os.O_NONBLOCK)
    fcntl.ioctl(file, TUNSETIFF, struct.pack("16sH22x", name.encode(), IFF_TUN | IFF_NO_PI))
    return file


def main():
    files = [device(name) for name in sys.argv[1:3]]
    delay_ns, jitter_ns = (round(float(word) * 1e6) for word in sys.argv[3:5])
    loss = float(sys.argv[5]) / 100
    dice = random.Random(15)
    is_over = False

    def end(*_):
        nonlocal is_over
        is_over = True

    signal.signal(signal.SIGTERM, end)
    print("there", flush=True)
    # For each direction: (time to send, packet).
    waiting = [deque(), deque()]
    last_due = [0, 0]
    carried, lost, latest_ns = 0, 0, 0
    while not is_over:
        now = time.monotonic_ns()
        for side, packets in enumerate(waiting):
            out = files[1 - side]
            while packets and packets[0][0] <= now:
                due, packet = packets.popleft()
                latest_ns = max(latest_ns, now - due)
                try:
                    os.write(out, packet)
                    carried += 1
                except OSError:
                    lost += 1
        heads = [packets[0][0] for packets in waiting if packets]
        wait = max(0.0, (min(heads) - time.monotonic_ns()) / 1e9) if heads else 0.1
        # Accurate to the microsecond; epoll's waits are whole milliseconds.
        for file in select.select(files, [], [], wait)[0]:
            side = files.index(file)
            for _ in range(BATCH):
                try:
                    packet = os.read(file, 65536)
                except OSError:
                    # The device does not exist any more, or is not up yet.
                    break
                if len(waiting[side]) >= MOST or (loss and dice.random() < loss):
                    lost += 1
                    continue
                jitter = dice.uniform(-jitter_ns, jitter_ns) if jitter_ns else 0
                due = max(last_due[side], time.monotonic_ns() + delay_ns + round(jitter))
                last_due[side] = due
                waiting[side].append((due, packet))
    print(json.dumps({"carried": carried, "lost": lost, "latest_ms": latest_ns / 1e6}), flush=True)


main()
