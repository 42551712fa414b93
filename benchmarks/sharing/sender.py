"""The partner of the benchmark, a process: shares a pose thirty times a second, and puts the same bytes plainly.

Both carry when they were sent: programs of one computer have one clock of `time.monotonic`.
"""

import random
import sys
import time

import msgspec
import numpy as np

import matchset as ms
from matchset.sharing.connection import Connection, zenoh_settings

RATE = 30.0  # Hz
NAME = "sender"
POSE = ms.Pose(
    position=np.array((0.1, -0.2, 1.9)),
    rotation_matrix=np.eye(3),
    covariance=np.eye(6) * 1e-4,
    observed="full",
    time=0.0,
)


class Stamped(msgspec.Struct):
    """What is put plainly: when, s, and as many bytes as a message of a pose has."""

    sent: float
    rest: bytes


def main(key: str, loss: float, seed: int) -> None:
    """Send until this process is ended; of the messages a share is dropped here, before Zenoh, as a network would."""
    chance = random.Random(seed)
    with ms.Share(NAME, key=key) as share, Connection(zenoh_settings("loopback", (), ())) as plain:
        put, send, size = plain.publisher(f"{key}/plain", "application/msgpack"), share._send, [0]

        def lossy(data: bytes, attached: bytes | None) -> None:
            size[0] = len(data)
            if chance.random() >= loss:
                send(data, attached)

        share._send = lossy
        due = time.monotonic()
        while True:
            share.publish(POSE, time.monotonic())
            due += 0.5 / RATE
            time.sleep(max(due - time.monotonic(), 0.0))
            stamped = Stamped(time.monotonic(), bytes(size[0] - len("sent") - len("rest") - 13))
            put(msgspec.msgpack.encode(stamped), None)
            due += 0.5 / RATE
            time.sleep(max(due - time.monotonic(), 0.0))


if __name__ == "__main__":
    main(sys.argv[1], float(sys.argv[2]), int(sys.argv[3]))
