"""A program that puts invalid messages on a link's keys by Zenoh.

hostile.py ADDRESS,ADDRESS DOMAIN SECONDS: sends invalid or impossible lists of streams, and frames and commands that are
truncated, too long or have inverted bytes. Prints their number.
"""

import json
import random
import struct
import sys
import time

import zenoh

addresses, domain, seconds = sys.argv[1].split(","), sys.argv[2], float(sys.argv[3])
config = zenoh.Config()
config.insert_json5("scouting/multicast/enabled", "false")
config.insert_json5("listen/endpoints", "[]")
config.insert_json5("connect/endpoints", json.dumps(addresses))
session = zenoh.open(config)
dice = random.Random(15)
real, heard = {}, {}


def take_frame(sample):
    real[str(sample.key_expr)] = bytes(sample.payload)


def take_streams(sample):
    heard["streams"] = bytes(sample.payload)


frames = session.declare_subscriber(f"belvedere/{domain}/frames/**", take_frame)
streams = session.declare_subscriber(f"belvedere/{domain}/streams", take_streams)
time.sleep(2)
assert real and heard, "nothing is received from the link"
# From here on, this program only sends.
frames.undeclare()
streams.undeclare()


def spoilt(frame):
    """Corrupts a valid frame."""
    frame = bytearray(frame)
    match dice.randrange(5):
        case 0:
            return bytes(frame[: dice.randrange(len(frame))])
        case 1:
            return bytes(frame) + bytes(dice.randrange(1, 5000))
        case 2:
            # Sizes and strides: width, height, row_stride, elem_stride, payload_len.
            at = dice.choice((48, 52, 56, 60))
            struct.pack_into("<I", frame, at, dice.choice((0, 1, 2**31, 2**32 - 1, dice.getrandbits(32))))
            return bytes(frame)
        case 3:
            struct.pack_into("<Q", frame, 64, dice.choice((0, 1, 2**63, 2**64 - 1, dice.getrandbits(64))))
            return bytes(frame)
        case _:
            for _ in range(dice.randrange(1, 40)):
                frame[dice.randrange(16)] = dice.randrange(256)
            return bytes(frame)


def spoilt_streams(good):
    """Corrupts a valid list of streams."""
    listing = json.loads(good)
    one = dice.choice(listing["streams"])
    match dice.randrange(6):
        case 0:
            return good[: dice.randrange(len(good))]
        case 1:
            return dice.randbytes(dice.randrange(200))
        case 2:
            listing["version"] = dice.choice((0, 2, -1, "1", None, 2**40))
        case 3:
            one[dice.choice(list(one))] = dice.choice(
                (None, -1, 2**70, 1e308, "", "x" * 5000, [], {}, "../../a", "a//b")
            )
        case 4:
            one["max_payload_len"] = dice.choice((2**27, 2**40, 2**63))
        case _:
            listing["streams"] = listing["streams"] * 200
    return json.dumps(listing).encode()


keys = sorted(real)
commands = [
    "cmd_vel",
    "mobile_base/commands/motor_power",
    "mobile_base/commands/reset_odometry",
    "simulation/command",
]
sent = 0
end = time.monotonic() + seconds
while time.monotonic() < end:
    key = dice.choice(keys)
    bad = spoilt(real[key])
    command = f"belvedere/{domain}/commands/{dice.choice(commands)}"
    for to, message in (
        (key, bad),
        (command, dice.choice((bad, dice.randbytes(432)))),
        (f"belvedere/{domain}/streams", spoilt_streams(heard["streams"])),
    ):
        # The message contains the key that it is for.
        said = to if dice.randrange(8) else dice.choice((None, "", key, "\u00fc" * 500))
        session.put(to, message, attachment=said)
    sent += 3
    time.sleep(0.002)
session.close()
print(sent)
