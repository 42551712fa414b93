"""Several targets of a file, followed forward and backward before anything is written: `followed_both_ways`."""

import sys
import time
from collections.abc import Callable, Iterator, Sequence

from matchset.app.backward.known_answers import KnownTargets
from matchset.app.exit_codes import StopRequest
from matchset.app.pictures.part import VideoPart
from matchset.app.progress import progress_bar
from matchset.image.frame import Frame
from matchset.media.both_ways import BothWays
from matchset.media.video import Video
from matchset.tracking.many.multi_tracker import MultiTracker
from matchset.tracking.many.smoothing.sweep import Click


def followed_both_ways(
    video: Video, tracker: MultiTracker, clicks: Sequence[Click], part: VideoPart, stop: StopRequest
) -> KnownTargets:
    """Follow several targets through a file and back, and explain all of it together, see `MultiTracker.smooth`.

    Parameters
    ----------
    video : Video
        That is about to be read; it is opened twice more.
    tracker : MultiTracker
        Which says what is followed, and how.
    clicks : sequence of Click
    part : VideoPart
        Which frames are used.
    stop : StopRequest
        Checked after each frame: what was not read backward is known from the forward reading alone.

    Returns
    -------
    KnownTargets

    Raises
    ------
    ValueError
        If the video is live, or two clicks are on one target.
    """
    ways, smoother, seconds = BothWays(video, part.of), tracker.smoother(clicks), dict[int, float]()
    _read(ways.forward(), smoother.forward, ("following forward", video.length), seconds, stop)
    _read(ways.backward(), smoother.backward, ("following backward", len(ways)), seconds, stop)
    known = KnownTargets()
    for each in smoother.answers():
        known.put(each.index, tuple(each.targets), seconds.get(each.index, 0.0))
    print(f"note: followed forward and backward through {len(ways)} frames", file=sys.stderr)
    return known


def _read(
    frames: Iterator[Frame],
    take: Callable[[Frame], None],
    said: tuple[str, int | None],
    seconds: dict[int, float],
    stop: StopRequest,
) -> None:
    """Let frames be taken, and note how long that takes for each, by its index, s."""
    with progress_bar(*said) as bar:
        for frame in frames:
            begin = time.thread_time()
            take(frame)
            seconds[frame.index] = seconds.get(frame.index, 0.0) + time.thread_time() - begin
            bar.advance()
            if stop:
                return
