"""`matchset track`: a video in, its ball's circle in every frame out."""

import itertools
import shlex
import sys
import time
from collections.abc import Callable, Iterable
from contextlib import ExitStack
from pathlib import Path

import msgspec

from matchset.app import ending
from matchset.app.draw import shape_names
from matchset.app.ending import StopRequest
from matchset.app.follow import Follower, Tally, follow
from matchset.app.outlets import Outlets, table_in
from matchset.app.patience import if_slow
from matchset.app.recorder import Recorder, codecs_for
from matchset.app.runs import output_file, output_folder
from matchset.app.screen import screen_for
from matchset.app.target import Target, Wish, check_wish, known_target, target_in
from matchset.image.frame import Frame
from matchset.image.video import Video
from matchset.shapes.circle import Circle
from matchset.tracking.tracker import Tracker

COMPILING = "compiling kernels (only once on this machine) ..."
_FPS_IF_UNKNOWN = 30.0


class TrackOptions(msgspec.Struct, frozen=True):
    """The options of `matchset track`, as typed."""

    source: str
    wish: Wish
    folder: Path | None = None
    video: Path | None = None
    jsonl: bool = False
    print: bool = False
    force: bool = False
    points: int = 64


def track(options: TrackOptions) -> int:
    """Run the command.

    Returns
    -------
    int
        The exit code.
    """
    check_wish(options.wish, shlex.quote(options.source))
    if options.video is not None:
        codecs_for(options.video)
    with StopRequest() as stop, Video(options.source) as video:
        target, ahead = _target(options, video)
        trackers = _trackers(target, options.points)
        folder = output_folder(options.folder, "track", options.force)
        tally = Tally()
        try:
            _run(options, video, itertools.chain(ahead, video), trackers, folder, tally, stop)
        finally:
            _sum_up(options, video, folder, tally)
    if stop:
        print("note: stopped; the files hold what was done so far", file=sys.stderr)
        return stop.code
    return ending.FOUND if tally.found else ending.NOT_FOUND


def _target(options: TrackOptions, video: Video) -> tuple[Target, Iterable[Frame]]:
    """Find out what to follow; a camera gives a frame away for it, which is tracked all the same."""
    known = known_target(options.wish)
    if known is not None:
        return known, ()
    if video.live:
        target, frame = target_in(video, options.wish)
        return msgspec.structs.replace(target, frame=frame.index), (frame,)
    with Video(options.source) as look:
        target, frame = target_in(look, options.wish)
    return target, ()


def _trackers(target: Target, points: int) -> Callable[[Frame], Follower | None]:
    """Make the trackers; a click counts in its own frame, so the tracker begins anew there."""
    with if_slow(COMPILING):
        searching = Tracker(Circle, target.color, points=points)
        clicked = None if target.start is None else Tracker(Circle, target.color, points=points, start=target.start)
    begun = False

    def follower_at(frame: Frame) -> Follower | None:
        nonlocal begun, clicked
        if clicked is not None and frame.index >= target.frame:
            begun, chosen, clicked = True, clicked, None
            return chosen
        if not begun:
            begun = True
            return searching
        return None

    return follower_at


def _run(
    options: TrackOptions,
    video: Video,
    frames: Iterable[Frame],
    trackers: Callable[[Frame], Follower | None],
    folder: Path,
    tally: Tally,
    stop: StopRequest,
) -> None:
    names = shape_names(Circle)
    with ExitStack() as stack:
        recorder = None
        if options.video is not None:
            path = output_file(options.video, options.force)
            size = video.width, video.height
            recorder = Recorder(path, video.fps or _FPS_IF_UNKNOWN, size, video.live)
            if recorder.note:
                print("note: " + recorder.note, file=sys.stderr)
        outlets = stack.enter_context(Outlets(table_in(folder, names, options.jsonl), recorder))
        screen = stack.enter_context(screen_for(video, quiet=options.print))
        for step in follow(frames, trackers, gaps=not video.live, stop=stop):
            outlets.write(step)
            tally.count(step)
            screen.show(step.row)
            if options.print:
                extra = {}
                if video.live:
                    age_ms = 1000.0 * (time.monotonic() - step.row.time)
                    extra = {"age_ms": round(age_ms, 1), "dropped": video.dropped}
                outlets.print(step, names, extra)
            if outlets.pipe_closed:
                break


def _sum_up(options: TrackOptions, video: Video, folder: Path, tally: Tally) -> None:
    """Say what was done: to stdout, or to stderr if stdout is a pipe's."""
    out = sys.stderr if options.print else sys.stdout
    for warning in video.warnings:
        print("note: " + warning, file=sys.stderr)
    if not tally.frames:
        return
    share = 100.0 * tally.found / tally.frames
    print(f"found in {tally.found} of {tally.frames} frames ({share:.1f} %)", file=out)
    for reason, count in tally.reasons.most_common(5):
        print(f"  {count:6d}  {reason}", file=out)
    if tally.seconds:
        print(f"tracking took {tally.median_ms:.2f} ms of computing a frame (median)", file=out)
    written = [folder / "tracks.csv", folder / "tracks.jsonl" if options.jsonl else None, options.video]
    for path in written:
        if path is not None:
            print(f"  {path}", file=out)
