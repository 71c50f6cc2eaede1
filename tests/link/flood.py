"""A program that announces more streams by Zenoh than fit into a machine's memory.

flood.py ADDRESS,ADDRESS DOMAIN SECONDS: announces the existing streams, and alternately hundreds of large ones and thousands of
small ones. Prints their number, and the size of their frames.
"""

import json
import sys
import time

import zenoh

addresses, domain, seconds = sys.argv[1].split(","), sys.argv[2], float(sys.argv[3])
# The number of frames of a picture stream: eight consumers with two waiting and two held each, and three more.
FRAMES = 35
LARGE, SMALL = 32 << 20, 64
config = zenoh.Config()
config.insert_json5("scouting/multicast/enabled", "false")
config.insert_json5("listen/endpoints", "[]")
config.insert_json5("connect/endpoints", json.dumps(addresses))
session = zenoh.open(config)
heard = []
streams = session.declare_subscriber(
    f"belvedere/{domain}/streams", lambda sample: heard.append(bytes(sample.payload))
)
time.sleep(2)
assert heard, "nothing is received from the link"
good = json.loads(heard[-1])
streams.undeclare()
picture = next(stream for stream in good["streams"] if stream["topic"] == "image_raw")
floods = []
# With odd sizes: no two announcements are the same, so the memory of one is not reused for the next.
for number, size, step in ((300, LARGE, 4096), (3000, SMALL, 64)):
    more = [picture | {"topic": f"flood/{size}/{at}", "max_payload_len": size + at * step} for at in range(number)]
    floods.append(json.dumps(good | {"streams": good["streams"] + more}).encode())
end = time.monotonic() + seconds
sent = 0
while time.monotonic() < end:
    # Each lasts longer than a second, so that not only the streams of the genuine announcements in between are open.
    key = f"belvedere/{domain}/streams"
    session.put(key, floods[int(time.monotonic() / 2) % 2], attachment=key)
    sent += 1
    time.sleep(0.05)
session.close()
print(f"{sent} announcements, of 300 streams of {300 * FRAMES * LARGE >> 30} GiB, and of 3000 small ones")
