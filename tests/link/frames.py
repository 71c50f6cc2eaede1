"""Writes a line for each frame of a stream: number, stamp, times, and a hash of header and payload.

frames.py DOMAIN TOPIC FILE: until SIGTERM.
"""

import hashlib
import signal
import sys
import time

import belvedere

domain, topic, path = sys.argv[1:]
is_over = False


def end(*_):
    global is_over
    is_over = True


signal.signal(signal.SIGTERM, end)
with belvedere.Node("frames", domain=domain) as node, open(path, "w", buffering=1) as out:
    subscriber = node.subscribe(topic)
    while not is_over:
        if not subscriber.wait(0.05):
            continue
        while (frame := subscriber.take()) is not None:
            taken_ns = time.clock_gettime_ns(time.CLOCK_MONOTONIC)
            with frame:
                header = frame.header.copy()
                sent_ns = int(header["publish_mono_ns"])
                header["publish_mono_ns"] = 0
                said = hashlib.blake2b(header.tobytes(), digest_size=16)
                said.update(frame.payload)
                line = (frame.session, frame.seq, frame.stamp_ns, sent_ns, taken_ns, frame.missed, said.hexdigest())
                print(*line, file=out)
    subscriber.close()
