"""Each frame through a `MultiTracker`: `follow_several`."""

import contextlib
import sys
import time
from collections.abc import Iterable, Iterator
from typing import Any, Protocol

import msgspec

from matchset.app.backward.before_click import NO_WAY_BACK
from matchset.app.backward.both_ways import followed_both_ways
from matchset.app.backward.known_answers import KnownTargets
from matchset.app.exit_codes import StopRequest
from matchset.app.pictures.part import VideoPart
from matchset.app.several.chosen import ChosenTargets, PickedTarget
from matchset.app.several.crowd import CrowdWatch, Doubtful
from matchset.app.several.options import TypedOptions
from matchset.app.several.target_rows import TargetRow, TargetsRow, targets_row
from matchset.app.track.loop import UNDECODED, between
from matchset.image.frame import Frame
from matchset.media.video import Video
from matchset.tracking.many.multi_tracker import MultiTracker
from matchset.tracking.many.smoothing.sweep import Click
from matchset.tracking.many.target import Target
from matchset.tracking.track import Lost

Targets = tuple[Target[Any], ...]


class FollowedFrame(msgspec.Struct, frozen=True):
    """One frame and the answers for all targets.

    Parameters
    ----------
    frame : Frame or None
        The frame; None if it could not be decoded.
    answer : tuple of Target
        What the tracker returned.
    row : TargetsRow
        The same for the table.
    seconds : float
        Computing time of the tracker, s.
    """

    frame: Frame | None
    answer: Targets
    row: TargetsRow[TargetRow]
    seconds: float = 0.0


class FrameTargets(Protocol):
    """What follows targets from frame to frame."""

    def update(self, frame: Frame) -> Targets:
        """Track all targets in a frame."""
        ...


class TargetsFollower:
    """Puts frames through a tracker of several targets, with the clicks in their frames.

    Parameters
    ----------
    tracker : MultiTracker
    picks : iterable of PickedTarget
    finds : bool
        Whether the tracker finds all by itself; then what is clicked may be followed already.
    """

    def __init__(self, tracker: MultiTracker, picks: Iterable[PickedTarget], finds: bool) -> None:
        self._tracker, self._finds = tracker, finds
        self._picks = sorted(picks, key=lambda pick: pick.frame)

    def update(self, frame: Frame) -> Targets:
        """Track all targets in a frame.

        Raises
        ------
        ValueError
            If two clicks are on one target.
        """
        while self._picks and self._picks[0].frame <= frame.index:
            pick = self._picks.pop(0)
            # What is found without a click is on what was clicked, or there are as many as are wanted.
            with contextlib.suppress(*([ValueError] if self._finds else [])):
                self._tracker.add(pick.point, pick.label)
        return tuple(self._tracker.update(frame))


def known_targets(
    options: TypedOptions, video: Video, tracker: MultiTracker, chosen: ChosenTargets, stop: StopRequest
) -> KnownTargets | None:
    """Follow a file forward and backward, if `--smooth` or clicks in later frames ask for it; else None.

    Raises
    ------
    ValueError
        If a live source shall be smoothed.
    """
    later = not chosen.finds and any(pick.frame > 0 for pick in chosen.picks)
    if later and video.live:
        print(f"note: {NO_WAY_BACK}", file=sys.stderr)
    if not options.several.smooth and (video.live or not later):
        return None
    clicks = [Click(pick.frame, pick.point, pick.label) for pick in chosen.picks]
    return followed_both_ways(video, tracker, clicks, VideoPart.parse(options.shown.start, options.shown.end), stop)


def follow_several(
    frames: Iterable[Frame],
    follower: FrameTargets,
    gaps: bool,
    stop: StopRequest,
    whole: bool = True,
    watch: CrowdWatch | None = None,
) -> Iterator[FollowedFrame]:
    """Track a video frame by frame, see `matchset.app.track.loop.follow`.

    Parameters
    ----------
    frames : iterable of Frame
    follower : FrameTargets
    gaps : bool
        Whether a gap in the frames' indices is a frame that could not be decoded.
    stop : StopRequest
        Checked after each frame.
    whole : bool
        Whether the video is used from its beginning.
    watch : CrowdWatch, optional
        Told of each frame.

    Yields
    ------
    FollowedFrame
        One for each frame, in order.
    """
    last: Frame | None = None
    answer: Targets = ()
    for frame in frames:
        if gaps and (whole or last is not None):
            for index, moment in between(last, frame):
                lost = tuple(msgspec.structs.replace(each, track=Lost(UNDECODED, moment)) for each in answer)
                yield FollowedFrame(None, lost, targets_row(index, moment, lost))
        # The time of this thread only: the recorder's thread runs meanwhile.
        begin = time.thread_time()
        answer = follower.update(frame)
        seconds = time.thread_time() - begin
        doubtful: Doubtful = ()
        if watch is not None:
            watch.update(frame, answer)
            doubtful = watch.doubtful
        yield FollowedFrame(frame, answer, targets_row(frame.index, frame.time, answer, doubtful), seconds)
        last = frame
        if stop:
            return
