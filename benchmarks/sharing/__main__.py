"""A pose from one program to another over Zenoh: `python -m benchmarks.sharing [--seconds 20]`.

The sender (`sender.py`) is a process of its own, on this computer; so both have one clock. A pose is late by the time
from its `publish` there to the `Pose` that `others` gives here. Between the poses the sender puts as many bytes through
Zenoh without matchset: what is late there is the network's, and the machine's. Loss is made at the sender, which hands
every tenth message, by chance, to nobody.
"""

import argparse
import secrets
import subprocess
import sys
import time

import msgspec
import numpy as np

import matchset as ms
from benchmarks.machine import Machine
from benchmarks.sharing.sender import RATE, Stamped
from matchset.sharing.connection import Connection, zenoh_settings

LOSSES = (0.0, 0.1)
BAR, PRIZE = 0.002, 0.0006  # s, median
SEED = 46


class Lateness(msgspec.Struct):
    """What one run saw, s.

    Parameters
    ----------
    poses, plain : list of float
        How late each was.
    missed : float
        Share of the messages that did not come, as the receiver counts them.
    usable : float
        Share of looks, thirty a second, at which the newest pose could be used.
    offset : float
        Largest uncertainty of the clocks' offset.
    wrong : float
        Largest share of that uncertainty by which the offset was off: of one clock it is 0.
    """

    poses: list[float]
    plain: list[float]
    missed: float
    usable: float
    offset: float
    wrong: float


def measured(seconds: float, loss: float) -> Lateness:
    """Listen to a sender for some time."""
    key, plain, poses = f"bench/{secrets.token_hex(6)}", list[float](), list[float]()
    with Connection(zenoh_settings("loopback", (), ())) as connection, ms.Share("receiver", key=key) as share:
        connection.listen(
            f"{key}/plain",
            lambda _, data: plain.append(time.monotonic() - msgspec.msgpack.decode(data or b"", type=Stamped).sent),
        )
        words = [sys.executable, "-m", "benchmarks.sharing.sender", key, str(loss), str(SEED)]
        sender = subprocess.Popen(words)
        try:
            while not any(share.others()):
                share.wait(0.1)
            return _listened(share, seconds, poses, plain)
        finally:
            sender.kill()
            sender.wait()


def _listened(share: ms.Share, seconds: float, poses: list[float], plain: list[float]) -> Lateness:
    plain.clear()
    end, looks, usable, offset, wrong = time.monotonic() + seconds, 0, 0, 0.0, 0.0
    look, taken = time.monotonic(), 0.0
    while (now := time.monotonic()) < end:
        came = share.wait(max(look - now, 0.0))
        (found,) = share.others()
        now = time.monotonic()
        if came and isinstance(found.pose, ms.Pose) and found.pose.time != taken:
            taken = found.pose.time
            (state,) = share.partners()
            assert state.offset is not None
            poses.append(now - (taken - state.offset.seconds))
            offset = max(offset, state.offset.uncertainty)
            wrong = max(wrong, abs(state.offset.seconds) / state.offset.uncertainty)
        if now >= look:
            look, looks, usable = look + 1.0 / RATE, looks + 1, usable + bool(found)
    (state,) = share.partners()
    missed = state.missed / (state.missed + state.received)
    return Lateness(poses, plain, missed, usable / looks, offset, wrong)


def row(name: str, late: list[float]) -> str:
    """Write a row of the table."""
    worst = " | ".join(f"{1e3 * value:.2f}" for value in np.percentile(late, (50, 95, 99)))
    return f"| {name} | {len(late)} | {worst} | {1e3 * max(late):.1f} |"


def main() -> int:
    """Print the table; returns whether the median is above the bar."""
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--seconds", type=float, default=20.0, help="of each run")
    seconds: float = options.parse_args().seconds
    print(f"{Machine.here().words()}\n")
    print("| what | messages | median, ms | 95 %, ms | 99 %, ms | longest, ms |\n| --- | --- | --- | --- | --- | --- |")
    late, notes = 0.0, []
    for loss in LOSSES:
        found = measured(seconds, loss)
        print(row(f"pose to pose, {100 * loss:.0f} % lost", found.poses))
        print(row("as many bytes, put plainly", found.plain), flush=True)
        late = max(late, float(np.median(found.poses)))
        notes.append(
            f"{100 * loss:.0f} % lost: {100 * found.missed:.1f} % told as missed, the newest pose was usable at "
            f"{100 * found.usable:.2f} % of all looks, offset known to ±{1e3 * found.offset:.2f} ms and off by "
            f"{100 * found.wrong:.0f} % of that at most"
        )
    print("\n" + "\n".join(notes))
    print(f"bar: median {1e3 * BAR:g} ms, here {1e3 * late:.2f} ms")
    return int(late > BAR)


if __name__ == "__main__":
    sys.exit(main())
