"""Follows a target through a file from its click back to the first frame: `follow_back`."""

import itertools
import sys
import time
from collections.abc import Callable

from matchset.app.backward.known_answers import KnownAnswers
from matchset.app.backward.mirrored import FrameFollower, MirroredTracker
from matchset.app.exit_codes import StopRequest
from matchset.app.pictures.part import VideoPart
from matchset.app.progress import progress_bar
from matchset.media.exact_reader import ExactReader
from matchset.media.frame_list import FrameList, StampedVideo


def follow_back(
    open_video: Callable[[], StampedVideo],
    click: int,
    make: Callable[[], FrameFollower],
    part: VideoPart,
    stop: StopRequest,
) -> KnownAnswers | None:
    """Follow a target from the frame of a click back to the first one that is used.

    The file is read up to the click to know its frames, and then backward in pieces, by jumps where they lead to the
    right frames: what is in memory at once is limited by `ReaderParameters.ahead_mb`.

    Parameters
    ----------
    open_video : callable
        Opens the file.
    click : int
        Index of the frame of the click.
    make : callable
        Makes the tracker, which begins at the click.
    part : VideoPart
        Which frames are used.
    stop : StopRequest
        Checked after each frame.

    Returns
    -------
    KnownAnswers or None
        Of the frames before the click; None where there is none.
    """
    frames, first = _frames_to(open_video, click, part, stop)
    if first is None or stop:
        return None
    known, tracker, earliest = KnownAnswers(), MirroredTracker(make()), click
    with (
        ExactReader(open_video, frames) as reader,
        progress_bar("following backward", len(frames) - first) as bar,
    ):
        for frame in itertools.islice(reader.backward(len(frames) - 1), len(frames) - first):
            begin = time.thread_time()
            answer = tracker.update(frame)
            if frame.index < click:
                known.put(frame.index, answer, time.thread_time() - begin)
                earliest = frame.index
            bar.advance()
            if stop:
                break
    print(f"note: followed backward from the click in frame {click} to frame {earliest}", file=sys.stderr)
    return known


def _frames_to(
    open_video: Callable[[], StampedVideo], click: int, part: VideoPart, stop: StopRequest
) -> tuple[FrameList, int | None]:
    """Read a file up to a click; return its frames, and the place of the first one used, None if none is before."""
    frames, first, start = FrameList(), None, 0.0
    with open_video() as video, progress_bar("reading up to the click", click + 1) as bar:
        for frame in video:
            if frame.index > click or stop:
                break
            start = frame.time if not len(frames) else start
            used = part.start is None or part.start.is_reached(frame, start)
            if first is None and used and frame.index < click:
                first = len(frames)
            frames.append(frame, video.stamp)
            bar.advance()
    frames.complete = True
    return frames, first
