"""What a batch shows while it runs."""

import io
import time

from rich.console import Console

from batched_videos import HerePool
from matchset.batch.jobs.job import State, VideoOutcome
from matchset.batch.progress import BatchCounts, BatchDisplay, rate_text


class BusyPool(HerePool):
    """Has been at it for a while."""

    @property
    def running(self) -> dict[str, float]:
        now = time.monotonic()
        return {"/v/quick.mp4": now - 2.0, "/v/slow.mp4": now - 400.0, "/v/b": now - 3.0, "/v/a": now - 1.0}


def counted(*states: State) -> BatchCounts:
    counts = BatchCounts(10)
    for state in states:
        counts.count(VideoOutcome(video="v", folder="v", settings="", state=state))
    return counts


def test_words() -> None:
    counts = counted("found", "found", "failed")
    counts.earlier = 3
    assert counts.words.startswith("6 of 10 videos, 1 failed, ")
    assert counts.words.endswith(" left")
    assert counted().words == "0 of 10 videos"
    assert (rate_text(2.0), rate_text(0.5)) == ("2.0 a second", "30.0 a minute")


def test_terminal_shows_the_slowest() -> None:
    text = io.StringIO()
    with BatchDisplay(counted("found"), Console(file=text, force_terminal=True, width=100)) as display:
        display.show(BusyPool())
    assert "slow.mp4" in text.getvalue()
    assert "/v/a" not in text.getvalue()
    assert "1 of 10 videos" in text.getvalue()


def test_a_pipe_gets_notes_in_one_line() -> None:
    text, pool = io.StringIO(), BusyPool()
    pool.notes.append("a worker died over a very long name of a video " * 4)
    with BatchDisplay(counted(), Console(file=text, width=40)) as display:
        display.show(pool)
    assert len(text.getvalue().splitlines()) == 1
    assert pool.notes == []
