"""Prints a line for each frame of /scan and /image_raw: stream, number, stamp, and a hash of header and payload.

Checks every millisecond, because a replay sends no notifications.
"""

import hashlib
import sys
import time

import belvedere

domain, what, seconds = sys.argv[1], sys.argv[2], float(sys.argv[3])
with belvedere.Node(f"frames-{what}", domain=domain) as node:
    subscribers = [node.subscribe(topic) for topic in ("scan", "image_raw")]
    print("ready", file=sys.stderr, flush=True)
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        for subscriber in subscribers:
            while (frame := subscriber.take()) is not None:
                with frame:
                    said = hashlib.sha256(frame.header.tobytes())
                    said.update(frame.payload)
                    print(subscriber.topic, frame.seq, frame.stamp_ns, said.hexdigest())
        time.sleep(0.001)
    for subscriber in subscribers:
        subscriber.close()
