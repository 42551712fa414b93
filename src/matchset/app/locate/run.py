"""`matchset locate`: a video in, where its ball is in every frame out, in meters."""

import itertools
import math
import shlex
import sys
from collections.abc import Iterable
from contextlib import ExitStack
from pathlib import Path

import msgspec

from matchset.app import exit_codes as ending
from matchset.app.drawing.video_writer import codecs_for
from matchset.app.exit_codes import StopRequest
from matchset.app.locate.annotate_pose import annotate_pose
from matchset.app.locate.loop import Locator, Sighting, locate
from matchset.app.locate.marker_wish import MarkerWish, check_marker_wish, targets_for
from matchset.app.locate.options import ball_target
from matchset.app.locate.path_log import Course
from matchset.app.locate.pose_table import PoseWriter
from matchset.app.patience import if_slow
from matchset.app.progress import screen_for
from matchset.app.run_folder import output_folder
from matchset.app.track.learn_command import write_picture
from matchset.app.track.loop import Tally
from matchset.app.track.outputs import Outlets, Picture, live_figures, recorder_for
from matchset.app.track.summary import sum_up
from matchset.app.track.target_options import Wish, check_wish
from matchset.app.track.trackers import trackers_for
from matchset.camera.camera_model import CameraModel
from matchset.image.frame import Frame
from matchset.image.video import Video
from matchset.localization.ball_target import BallTarget
from matchset.localization.localizer import Localizer
from matchset.localization.markers.marker_tracker import MarkerTracker


class LocateOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options of `matchset locate`, as typed."""

    source: str
    wish: Wish
    marker: MarkerWish = MarkerWish()
    camera: Path | None = None
    fov_deg: float | None = None
    diameter: float | None = None
    marker_diameter: float | None = None
    markers: Path | None = None
    folder: Path | None = None
    video: Path | None = None
    jsonl: bool = False
    print: bool = False
    force: bool = False
    points: int = 64


def run_locate(options: LocateOptions) -> int:
    """Run the command.

    Returns
    -------
    int
        The exit code.
    """
    check_wish(options.wish, shlex.quote(options.source))
    check_marker_wish(options.marker)
    ball = ball_target(options.diameter, options.marker_diameter, options.markers, options.marker.given)
    _check_camera(options)
    if options.video is not None:
        codecs_for(options.video)
    loaded = None if options.camera is None else CameraModel.load(options.camera)
    with StopRequest() as stop, Video(options.source) as video:
        camera = loaded or CameraModel.from_fov(video.width, video.height, math.radians(options.fov_deg or 0.0))
        camera.check((video.width, video.height))
        locator, ahead = _locator(options, video, camera, ball)
        folder = output_folder(options.folder, "locate", options.force)
        tally, course = Tally(), Course()
        outlets = _outlets(options, video, camera, ball, folder)
        try:
            _run(options, video, itertools.chain(ahead, video), locator, outlets, (tally, course), stop)
        finally:
            files = _finish(options, folder, course, camera)
            sum_up(video, tally, "locating", files, sys.stderr if options.print else sys.stdout)
    if stop:
        print("note: stopped; the files hold what was done so far", file=sys.stderr)
        return stop.code
    return ending.FOUND if tally.found else ending.NOT_FOUND


def _check_camera(options: LocateOptions) -> None:
    if (options.camera is None) == (options.fov_deg is None):
        raise ValueError(
            "say what the camera is like: --camera FILE from 'matchset calibrate', or --fov DEG, its horizontal "
            "field of view; one of the two"
        )
    if options.fov_deg is not None and not 0.0 < options.fov_deg < 180.0:
        raise ValueError(f"--fov must lie between 0 and 180 degrees, got {options.fov_deg:g}")


def _locator(
    options: LocateOptions, video: Video, camera: CameraModel, ball: BallTarget
) -> tuple[Locator, tuple[Frame, ...]]:
    target, marker_color, ahead = targets_for(options.source, video, options.wish, options.marker)
    finder = None if marker_color is None else MarkerTracker(marker_color, ball)
    return Locator(trackers_for(target, options.points), finder, Localizer(camera, ball)), ahead


def _outlets(
    options: LocateOptions, video: Video, camera: CameraModel, ball: BallTarget, folder: Path
) -> Outlets[Sighting]:
    def draw(sighting: Sighting) -> Picture | None:
        return None if sighting.frame is None else annotate_pose(sighting.frame, sighting, camera, ball.radius)

    recorder = recorder_for(options.video, video, options.force)
    return Outlets(PoseWriter(folder, options.jsonl), draw, recorder)


def _run(
    options: LocateOptions,
    video: Video,
    frames: Iterable[Frame],
    locator: Locator,
    outlets: Outlets[Sighting],
    notes: tuple[Tally, Course],
    stop: StopRequest,
) -> None:
    tally, course = notes
    with ExitStack() as stack:
        stack.enter_context(outlets)
        screen = stack.enter_context(screen_for(video, options.print, "locating"))
        for sighting in locate(frames, locator, gaps=not video.live, stop=stop):
            outlets.write(sighting)
            tally.count(sighting)
            course.add(sighting)
            screen.show(sighting.row)
            if options.print:
                outlets.print(sighting, live_figures(video, sighting.row.time))
            if outlets.pipe_closed:
                break


def _finish(options: LocateOptions, folder: Path, course: Course, camera: CameraModel) -> list[Path]:
    """Draw the picture, if there is anything to draw; return the files of the run."""
    files = [folder / "poses.csv", folder / "poses.jsonl" if options.jsonl else None, options.video]
    if course.any_found:
        with if_slow("drawing the path ..."):
            from matchset.app.locate.path_picture import path_picture

            write_picture(folder / "poses.png", path_picture(course, camera))
        files.append(folder / "poses.png")
    return [path for path in files if path is not None]
