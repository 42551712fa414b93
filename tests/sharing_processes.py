"""Partners as processes of their own: each shares a pose thirty times a second until it is told to end."""

import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

from matchset.sharing.share import Share
from sharing_poses import LEVEL

PROGRAM = """
import sys, time
import matchset.sharing.share as sharing
from sharing_poses import LEVEL
clock = None
{first}
with sharing.Share({name!r}, key={key!r}, clock=clock, **{network!r}) as share:
    print("ready", flush=True)
    while True:
        share.publish({{"ball": LEVEL}}, {taken})
        for line in share.news():
            print(line, flush=True)
        time.sleep(1 / 30)
"""
HOUR_OFF = """
right, through_sleep = time.time, sharing.Clock().now
time.time = lambda: right() + 3600.0
clock = sharing.Clock(lambda: through_sleep() + 3600.0)
"""
"""Before a partner shares: its clocks are an hour ahead."""
NEWER = """
import matchset.sharing.messages as messages
sharing.FORMAT = messages.FORMAT = 2
"""
"""Before a partner shares: it sends messages of the next version."""
LONGEST = 60.0  # s, that a test waits for what must happen


def begun(
    name: str, key: str, first: str = "", taken: str = "time.monotonic()", **network: object
) -> subprocess.Popen[str]:
    """Begin a partner, and wait until it shares."""
    program = PROGRAM.format(name=name, key=key, first=first, taken=taken, network=network)
    made = subprocess.Popen(
        [sys.executable, "-c", program],
        cwd=Path(__file__).parent,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert made.stdout is not None
    assert made.stdout.readline() == "ready\n"
    return made


def until(happens: Callable[[], object], process: "subprocess.Popen[str] | None" = None) -> None:
    """Wait until something happens; where a process makes it happen, as long as it runs."""
    end = time.monotonic() + LONGEST
    while not happens():
        assert process is None or process.poll() is None, process.communicate()
        assert time.monotonic() < end
        time.sleep(0.005)


def told(share: Share) -> bool:
    """Publish a pose of now; True."""
    share.publish(LEVEL, time.monotonic())
    return True


class Heard:
    """All lines that a share has told so far."""

    def __init__(self, share: Share) -> None:
        self.share, self.lines = share, list[str]()

    def has(self, words: str) -> bool:
        """Whether a line with these words was told."""
        self.lines += self.share.news()
        return any(words in line for line in self.lines)

    def count(self, words: str) -> int:
        """How many lines with these words were told."""
        self.lines += self.share.news()
        return sum(words in line for line in self.lines)
