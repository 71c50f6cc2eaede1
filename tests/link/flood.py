"""Another program of Zenoh, which announces more streams than a machine has room for.

flood.py ADDRESS,ADDRESS DOMAIN SECONDS: beside the streams that are there, by turns hundreds of large ones and thousands of small
ones. Says how many, and how many bytes their frames would take.
"""

import json
import sys
import time

import zenoh

addresses, domain, seconds = sys.argv[1].split(","), sys.argv[2], float(sys.argv[3])
# Frames of a stream of pictures: eight consumers with two that wait and two that are held, three more.
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
assert heard, "the link is not heard"
good = json.loads(heard[-1])
streams.undeclare()
picture = next(stream for stream in good["streams"] if stream["topic"] == "image_raw")
floods = []
# Of odd sizes: no two announcements are the same, and what was opened for one is not for the next.
for number, size, step in ((300, LARGE, 4096), (3000, SMALL, 64)):
    more = [picture | {"topic": f"flood/{size}/{at}", "max_payload_len": size + at * step} for at in range(number)]
    floods.append(json.dumps(good | {"streams": good["streams"] + more}).encode())
end = time.monotonic() + seconds
sent = 0
while time.monotonic() < end:
    # Longer than a second each, so that what is open is not only that of the true announcements in between.
    key = f"belvedere/{domain}/streams"
    session.put(key, floods[int(time.monotonic() / 2) % 2], attachment=key)
    sent += 1
    time.sleep(0.05)
session.close()
print(f"{sent} announcements, of 300 streams of {300 * FRAMES * LARGE >> 30} GiB, and of 3000 small ones")
