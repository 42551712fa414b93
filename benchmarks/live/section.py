"""`python -m benchmarks --only live`: the live page's ages, costs and limits on this computer."""

import asyncio
import contextlib
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from typing import NamedTuple
from urllib.parse import urlsplit

import msgspec
import numpy as np

from benchmarks.live.clients import SlowLink, Watcher
from benchmarks.live.day import growth_mb
from benchmarks.live.screen import ages_on_screen
from benchmarks.live.server import Load
from benchmarks.options import Options
from benchmarks.results import Figure, Finding, Goal, Section

SECONDS, QUICK_SECONDS = 30.0, 8.0
VIEWERS = 4
SLOW = 8e6  # bit/s
DAY = 24 * 3600 * 30  # pictures
QUICK_DAY = 20_000
MEDIAN_MS, MOST_MS = 60.0, 120.0
SAME_RATE = 98.0  # %


class Spent(NamedTuple):
    """What a server did in a time: rate of the loop, 1/s, and processor, % of a core."""

    rate: float
    processor: float


class Server:
    """A server with a drawn camera, in a process of its own."""

    def __init__(self, process: "subprocess.Popen[str]") -> None:
        self._process = process
        assert process.stdout is not None
        self.address = process.stdout.readline().strip()

    def load(self) -> Load:
        """Ask what it has used so far."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write("\n")
        self._process.stdin.flush()
        return msgspec.json.decode(self._process.stdout.readline(), type=Load)

    def watched(self, seconds: float, watchers: list[Watcher]) -> Spent:
        """Let viewers look for a time, s."""
        end = time.monotonic() + seconds

        async def look() -> None:
            await asyncio.gather(*(each.watch(seconds) for each in watchers))
            await asyncio.sleep(max(0.0, end - time.monotonic()))

        before = self.load()
        asyncio.run(look())
        after = self.load()
        span = after.time - before.time
        used = 100.0 * (after.processor - before.processor) / span
        return Spent((after.frames - before.frames) / span, used)


@contextlib.contextmanager
def running() -> Iterator[Server]:
    """Start a server; it ends with the block."""
    command = [sys.executable, "-m", "benchmarks.live.server"]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        yield Server(process)
        assert process.stdin is not None
        process.stdin.close()


def run(options: Options) -> Section:
    """Measure the live page."""
    seconds = QUICK_SECONDS if options.quick else SECONDS
    with running() as server:
        findings = [on_screen(server, seconds), *beside(server, seconds), slow_link(server, seconds)]
    findings.append(long_run(QUICK_DAY if options.quick else DAY))
    busy = os.getloadavg()[0]
    text = (
        "A drawn camera of 640 x 480 px and 30 frames/s, whose pictures carry the time of their capture as a bar code. "
        "*On the screen*: read from the page's canvas in the first frame of the browser that shows it. "
        "*Arrival*: at a viewer without a browser, that acknowledges at once. "
        f"Load of the computer at the end, with all that is measured here: {busy:.1f}."
    )
    return Section("The live page", findings, text)


def spread(values: list[float], unit: str = "ms", digits: int = 0) -> tuple[Figure, Figure]:
    """Median and 95 %."""
    known = values or [float("nan")]
    return (
        Figure("median", float(np.median(known)), unit, digits),
        Figure("95 %", float(np.percentile(known, 95.0)), unit, digits),
    )


def on_screen(server: Server, seconds: float) -> Finding:
    """Age of the picture that a person sees."""
    ages = ages_on_screen(server.address, seconds)
    return Finding(
        name="live_age",
        what="from the capture of a picture to its place on the screen, one viewer",
        figures=(*spread(ages), Figure("shown", len(ages) / seconds, "1/s", 1)),
        bar=(Goal("median", high=MEDIAN_MS), Goal("95 %", high=MOST_MS)),
    )


def beside(server: Server, seconds: float) -> list[Finding]:
    """Measure what viewers cost."""
    alone = server.watched(seconds, [])
    watchers = [Watcher(server.address) for _ in range(VIEWERS)]
    four = server.watched(seconds, watchers)
    one = (four.processor - alone.processor) / VIEWERS
    sizes = [size for each in watchers for size in each.sizes]
    share = Figure("rate of the loop", 100.0 * four.rate / alone.rate, "% of that without", 1)
    return [
        Finding(
            name="live_viewers",
            what=f"{VIEWERS} viewers: rate of the loop, processor of the server, bytes of a picture with its state",
            figures=(
                share,
                Figure("server without", alone.processor, "% of a core", 1),
                Figure("a viewer", one, "% of a core", 2),
                Figure("picture", float(np.mean(sizes)) / 1e3 if sizes else None, "KB", 1),
                *spread([1000.0 * age for each in watchers for age in each.ages], digits=0),
            ),
            bar=(Goal(share.name, low=SAME_RATE),),
        )
    ]


def slow_link(server: Server, seconds: float) -> Finding:
    """Age of a picture behind a slow link."""

    async def look() -> list[float]:
        async with SlowLink(urlsplit(server.address).port or 0, SLOW) as link:
            watcher = Watcher(server.address, through=link.port)
            await watcher.watch(seconds)
        return watcher.ages

    ages = [1000.0 * age for age in asyncio.run(look())]
    return Finding(
        name="live_slow_link",
        what=f"the same to its arrival behind a link of {SLOW / 1e6:g} Mbit/s",
        figures=(*spread(ages), Figure("arrived", len(ages) / seconds, "1/s", 1)),
    )


def long_run(pictures: int) -> Finding:
    """Memory of the server's parts."""
    return Finding(
        name="live_memory",
        what=f"memory over {pictures:,} pictures through the server's parts, from the tenth part of them to the end",
        figures=(Figure("growth", growth_mb(pictures), "MB", 2),),
        bar=(Goal("growth", high=1.0),),
    )
