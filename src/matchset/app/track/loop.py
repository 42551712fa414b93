"""The loop of `matchset track`: which tracker runs (`trackers_for`), each frame through it (`follow`), the summary."""

import itertools
import re
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any, Protocol, TextIO

import msgspec

from matchset.app.exit_codes import FOUND, NOT_FOUND, StopRequest, print_warnings
from matchset.app.target.target_options import LearnedTarget
from matchset.app.timing.durations import Durations, ms_text
from matchset.app.track.rows import TrackRow, track_row
from matchset.image.frame import Frame
from matchset.media.video import Video
from matchset.tracking.track import Lost, Track
from matchset.tracking.tracker import Tracker

UNDECODED = "frame could not be decoded"

_NUMBER = re.compile(r"\d+(?:\.\d+)?")


class FrameTracker(Protocol):
    """What tracks a shape from frame to frame: `matchset.Tracker`, or anything with its `update`."""

    def update(self, frame: Frame) -> Track[Any] | Lost[Any]:
        """Track the shape into `frame`."""
        ...


TrackerAt = Callable[[Frame], FrameTracker | None]
"""Called before each frame: a new tracker to go on with, or None to keep the present one."""


class TrackedFrame(msgspec.Struct, frozen=True):
    """One frame and the tracker's answer.

    Parameters
    ----------
    frame : Frame or None
        The frame; None if it could not be decoded.
    answer : Track or Lost
        What the tracker returned.
    row : TrackRow
        The same for the table.
    seconds : float
        Computing time of the tracker, s.
    """

    frame: Frame | None
    answer: Track[Any] | Lost[Any]
    row: TrackRow
    seconds: float = 0.0


class CountedFrame(Protocol):
    """What `RunStatistics` needs to know of a frame, such as a `TrackedFrame`."""

    @property
    def frame(self) -> Frame | None:
        """The frame; None if it could not be decoded."""
        ...

    @property
    def row(self) -> Any:
        """With `found` and `reason`."""
        ...

    @property
    def seconds(self) -> float:
        """Computing time, s."""
        ...


class RunStatistics:
    """Counts over a run: frames, frames found, reasons of the others, computing times; a camera may run for weeks."""

    def __init__(self) -> None:
        self.frames = self.found = 0
        self._reasons: Counter[str] = Counter()
        self._numbers: dict[str, list[tuple[str, str]]] = {}
        self.durations = Durations()

    def count(self, counted: CountedFrame) -> None:
        """Count a frame."""
        self.frames += 1
        self.found += counted.row.found
        if counted.frame is not None:
            self.durations.add(counted.seconds)
        if not counted.row.found:
            words, numbers = _NUMBER.sub("…", counted.row.reason), _NUMBER.findall(counted.row.reason)
            self._reasons[words] += 1
            known = self._numbers.get(words, [(each, each) for each in numbers])
            self._numbers[words] = [
                (min(low, each, key=float), max(high, each, key=float))
                for (low, high), each in zip(known, numbers, strict=True)
            ]

    def reasons(self, most: int) -> list[tuple[str, int]]:
        """Return the most frequent reasons of frames without an answer, with how many those are.

        What differs by its numbers alone is one reason: it says from which to which they go.
        """
        return [(self._in_words(words), count) for words, count in self._reasons.most_common(most)]

    def _in_words(self, words: str) -> str:
        texts = [low if low == high else f"{low} to {high}" for low, high in self._numbers[words]]
        return "".join(itertools.chain(*itertools.zip_longest(words.split("…"), texts, fillvalue="")))


def trackers_for(
    target: LearnedTarget, make: Callable[..., Tracker[Any]], before: FrameTracker | None = None
) -> TrackerAt:
    """Make the trackers of a run: one searches from the first frame, another one starts in the frame of a click.

    Parameters
    ----------
    target : LearnedTarget
        What to track.
    make : callable
        Makes a tracker of a color; with the keyword `start`, a point, px, at which it begins.
    before : FrameTracker, optional
        Of the frames before that of the click; without one they are searched.

    Returns
    -------
    callable
        See `TrackerAt`.
    """
    searching = before or make(target.color)
    clicked = None if target.start is None else make(target.color, start=target.start)
    started = False

    def tracker_at(frame: Frame) -> FrameTracker | None:
        nonlocal started, clicked
        if clicked is not None and frame.index >= target.frame:
            started, chosen, clicked = True, clicked, None
            return chosen
        if not started:
            started = True
            return searching
        return None

    return tracker_at


def follow(
    frames: Iterable[Frame], tracker_at: TrackerAt, gaps: bool, stop: StopRequest, whole: bool = True
) -> Iterator[TrackedFrame]:
    """Track a video frame by frame.

    Parameters
    ----------
    frames : iterable of Frame
        The video.
    tracker_at : callable
        See `TrackerAt`.
    gaps : bool
        Whether a gap in the frames' indices is a frame that could not be decoded, and gets a row that says so; of
        a live source it is a frame that was dropped, and gets none.
    stop : StopRequest
        Checked after each frame.
    whole : bool
        Whether the video is used from its beginning: then frames before the first one are gaps, too.

    Yields
    ------
    TrackedFrame
        One for each frame, in order.
    """
    tracker: FrameTracker | None = None
    last: Frame | None = None
    for frame in frames:
        if gaps and (whole or last is not None):
            yield from _undecoded(last, frame)
        tracker = tracker_at(frame) or tracker
        if tracker is None:
            raise ValueError(f"no tracker for frame {frame.index}")
        # The time of this thread only: the recorder's thread runs meanwhile.
        begin = time.thread_time()
        answer = tracker.update(frame)
        seconds = time.thread_time() - begin
        yield TrackedFrame(frame, answer, track_row(frame.index, answer), seconds)
        last = frame
        if stop:
            return


def _undecoded(last: Frame | None, frame: Frame) -> Iterator[TrackedFrame]:
    """Yield the frames between two frames as lost, their times interpolated."""
    for index, moment in between(last, frame):
        lost: Lost[Any] = Lost(UNDECODED, moment)
        yield TrackedFrame(None, lost, track_row(index, lost))


def between(last: Frame | None, frame: Frame) -> Iterator[tuple[int, float]]:
    """Yield the indices of the frames between two frames, that could not be decoded, and their times, interpolated."""
    first = 0 if last is None else last.index + 1
    start = 0.0 if last is None else last.time
    for index in range(first, frame.index):
        share = (index - first + 1) / (frame.index - first + 1)
        yield index, round(start + share * (frame.time - start), 6)


def computing_lines(durations: Durations, words: str) -> list[str]:
    """Say in two lines what a frame took; none where none was timed.

    Parameters
    ----------
    durations : Durations
    words : str
        What took the time, "tracking".
    """
    times = durations.times()
    if times is None:
        return []
    mean, most, worst = map(ms_text, (times.mean, times.percentile_95, times.worst))
    rest = f"  mean {mean} ms, 95 % within {most} ms, worst {worst} ms"
    return [f"{words} took {ms_text(times.median)} ms of computing a frame (median)", rest]


def print_summary(video: Video, statistics: RunStatistics, words: str, files: Iterable[Path], out: TextIO) -> None:
    """Print what a run did.

    Parameters
    ----------
    video : Video
        The source; its warnings go to stderr.
    statistics : RunStatistics
        The counts of the run.
    words : str
        What took the time, "tracking".
    files : iterable of Path
        What was written.
    out : file
        stdout, or stderr if stdout carries JSON.
    """
    print_warnings(video.warnings)
    if not statistics.frames:
        return
    share = 100.0 * statistics.found / statistics.frames
    print(f"found in {statistics.found} of {statistics.frames} frames ({share:.1f} %)", file=out)
    for reason, count in statistics.reasons(5):
        print(f"  {count:6d}  {reason}", file=out)
    for line in computing_lines(statistics.durations, words):
        print(line, file=out)
    for path in files:
        print(f"  {path}", file=out)


def exit_code(stop: StopRequest, statistics: RunStatistics) -> int:
    """Say that the run was stopped, if it was, and return its exit code."""
    if stop:
        print("note: stopped; the files hold what was done so far", file=sys.stderr)
        return stop.code
    return FOUND if statistics.found else NOT_FOUND
