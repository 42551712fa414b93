"""What came before a click, as the options of a command ask for it: `before_click`."""

import functools
import sys
from collections.abc import Callable
from typing import Any, Protocol

from matchset.app.backward.follow_back import follow_back
from matchset.app.backward.known_answers import KnownAnswers
from matchset.app.cli_options import ShownOptions, TargetOptions
from matchset.app.exit_codes import StopRequest
from matchset.app.pictures.part import VideoPart
from matchset.app.target.target_options import LearnedTarget
from matchset.media.frame_list import StampedVideo
from matchset.media.video import Video
from matchset.tracking.tracker import Tracker

NO_WAY_BACK = "a live source has no way back: the rows begin in the frame of the click"


class ReadingOptions(Protocol):
    """What is needed of the options of a command that follows a click."""

    @property
    def target(self) -> TargetOptions:
        """With the click."""
        ...

    @property
    def shown(self) -> ShownOptions:
        """With the part that is used."""
        ...


def before_click(
    options: ReadingOptions,
    video: Video,
    target: LearnedTarget,
    make: Callable[..., Tracker[Any]],
    stop: StopRequest,
) -> KnownAnswers | None:
    """Follow a target back from its click to the first frame that is used; None where nothing comes before it.

    Parameters
    ----------
    options : TrackOptions or LocateOptions
    video : Video
        That is about to be read.
    target : LearnedTarget
        What to follow.
    make : callable
        Makes a tracker of a color, at a `start`.
    stop : StopRequest
    """
    if target.start is None:
        return None
    if video.live:
        if options.target.pick is not None and "@" in options.target.pick:
            print(f"note: {NO_WAY_BACK}", file=sys.stderr)
        return None
    if target.frame == 0:
        return None
    part = VideoPart.parse(options.shown.start, options.shown.end)
    begin = functools.partial(make, target.color, start=target.start)
    opened = functools.partial(StampedVideo.of, video)
    return follow_back(opened, target.frame, begin, part, stop)
