"""`matchset track`: a video in, its ball's circle in every frame out."""

import itertools
import shlex
import sys
from collections.abc import Callable, Iterable
from contextlib import ExitStack
from pathlib import Path

import msgspec

from matchset.app import exit_codes as ending
from matchset.app.drawing.video_writer import codecs_for
from matchset.app.exit_codes import StopRequest
from matchset.app.progress import screen_for
from matchset.app.run_folder import output_folder
from matchset.app.track.loop import Follower, Tally, follow
from matchset.app.track.outputs import live_figures, recorder_for, track_outlets
from matchset.app.track.shape_option import parse_shape
from matchset.app.track.summary import sum_up
from matchset.app.track.target_options import Wish, check_wish, target_for
from matchset.app.track.trackers import trackers_for
from matchset.image.frame import Frame
from matchset.image.video import Video


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
    shape: str = "circle"


def track(options: TrackOptions) -> int:
    """Run the command.

    Returns
    -------
    int
        The exit code.
    """
    check_wish(options.wish, shlex.quote(options.source))
    family = parse_shape(options.shape)
    if options.video is not None:
        codecs_for(options.video)
    with StopRequest() as stop, Video(options.source) as video:
        target, ahead = target_for(options.source, video, options.wish)
        trackers = trackers_for(target, options.points, family)
        folder = output_folder(options.folder, "track", options.force)
        tally = Tally()
        try:
            _run(options, video, itertools.chain(ahead, video), trackers, folder, tally, stop)
        finally:
            written = [folder / "tracks.csv", folder / "tracks.jsonl" if options.jsonl else None, options.video]
            files = [path for path in written if path is not None]
            sum_up(video, tally, "tracking", files, sys.stderr if options.print else sys.stdout)
    if stop:
        print("note: stopped; the files hold what was done so far", file=sys.stderr)
        return stop.code
    return ending.FOUND if tally.found else ending.NOT_FOUND


def _run(
    options: TrackOptions,
    video: Video,
    frames: Iterable[Frame],
    trackers: Callable[[Frame], Follower | None],
    folder: Path,
    tally: Tally,
    stop: StopRequest,
) -> None:
    with ExitStack() as stack:
        recorder = recorder_for(options.video, video, options.force)
        outlets = stack.enter_context(
            track_outlets(folder, parse_shape(options.shape).parameters, options.jsonl, recorder)
        )
        screen = stack.enter_context(screen_for(video, quiet=options.print))
        for step in follow(frames, trackers, gaps=not video.live, stop=stop):
            outlets.write(step)
            tally.count(step)
            screen.show(step.row)
            if options.print:
                outlets.print(step, live_figures(video, step.row.time))
            if outlets.pipe_closed:
                break
