"""The run of `matchset locate`: from its options to files, a summary, and what to do where nothing was found."""

import itertools
import sys
from pathlib import Path
from typing import TextIO

from matchset.app.adapters.mavlink_poses import published
from matchset.app.backward.before_click import before_click
from matchset.app.drawing.picture_file import write_picture
from matchset.app.exit_codes import StopRequest
from matchset.app.guidance.explain import Explainer, explain_refused_click
from matchset.app.guidance.next_command import FailedRun, kept_options
from matchset.app.locate.annotate_pose import PosePainter
from matchset.app.locate.loop import LocatedFrame, Locator, PathLog, locate_frames
from matchset.app.locate.options import LocateOptions
from matchset.app.locate.rows import pose_table
from matchset.app.locate.what_options_name import (
    ball_target,
    ball_tracker,
    camera_for,
    load_camera,
    locator_of,
    targets_for,
)
from matchset.app.pictures.part import VideoPart
from matchset.app.pictures.run_pictures import RunPictures, WantedPictures
from matchset.app.progress import announce_if_slow
from matchset.app.run_folder import output_folder
from matchset.app.target.target_options import RefusedClickError
from matchset.app.track.loop import RunStatistics, exit_code, print_summary
from matchset.app.track.outputs import Outputs, latency_table, write_frames
from matchset.app.viewers.run import viewed
from matchset.camera.camera_model import CameraModel
from matchset.localization.ball_target import BallTarget
from matchset.localization.localizer import left_out

KEPT = {
    "camera": "--camera",
    "fov": "--fov",
    "focal_sigma": "--focal-sigma",
    "diameter": "--diameter",
    "diameter_sigma": "--diameter-sigma",
    "marker_diameter": "--marker-diameter",
    "markers": "--markers",
    "points": "--points",
    "params": "--params",
    "fps": "--fps",
}
KEPT_MARKER = {"marker_pick": "--marker-pick", "marker_color": "--marker-color"}


def run_locate(options: LocateOptions) -> int:
    """Follow and locate what the options say, write the files, and print a summary.

    Returns
    -------
    int
        The exit code.
    """
    ball, loaded, make = ball_of(options), load_camera(options), ball_tracker(options)
    with (
        StopRequest() as stop,
        options.silence.open(options.source, options.fps, options.topic, options.view) as video,
        published(options.mavlink, 2.0 * ball.radius) as publish,
    ):
        camera = camera_for(video, options, loaded)
        command = _command(options, video.live)
        try:
            target, marker_color, taken = targets_for(video, options.target, options.marker)
        except RefusedClickError as refused:
            explain_refused_click(refused, command, output_folder(options.out, "locate", options.force))
            raise
        target.say_notes()
        before = before_click(options, video, target, make, stop)
        locator: Locator = locator_of(options, target, marker_color, camera, ball, before)
        folder = output_folder(options.out, "locate", options.force)
        statistics, path, explainer = RunStatistics(), PathLog(), Explainer(command, target)
        painter = PosePainter(camera, ball.radius, options.marker.given)
        outputs = _outputs(options, WantedPictures.of(options, "locate", folder, video), painter, path)
        part = VideoPart.parse(options.shown.start, options.shown.end)
        out = sys.stderr if options.to_stdout else sys.stdout
        try:
            used = part.of(itertools.chain(taken, video.until(lambda: bool(stop))))
            located = locate_frames(used, locator, gaps=not video.live, stop=stop, whole=part.start is None)
            located = located if before is None else before.timed(located)
            located = viewed(located, options.viewers, (options.source, options.force), (camera, 2.0 * ball.radius))
            watched = explainer.watch(path.record(publish(located, video.live)))
            write_frames(watched, outputs, statistics, video, options.to_stdout, "locating")
        finally:
            files = [*_finish(options, folder, path, camera), *outputs.pictures.files]
            print_summary(video, statistics, "locating", files, out)
            if statistics.found:
                _say_left_out(camera, ball, out)
        if not stop:
            explainer.explain(folder, out)
    return exit_code(stop, statistics)


def ball_of(options: LocateOptions) -> BallTarget:
    """Ball, with its markers, that is located."""
    return ball_target(
        options.diameter, options.marker_diameter, options.markers, options.marker.given, options.diameter_sigma
    )


def _say_left_out(camera: CameraModel, ball: BallTarget, out: TextIO) -> None:
    """Say what the standard deviations leave out, and what would take it in."""
    told = {"--focal-sigma": camera.covariance is not None, "--diameter-sigma": ball.diameter_sigma > 0.0}
    missing = [option for option, known in told.items() if not known]
    if missing:
        print(f"{left_out(camera, ball)}: say how large they are by {' and '.join(missing)}", file=out)


def _command(options: LocateOptions, live: bool) -> FailedRun:
    """Describe the command for what is said where nothing was found."""
    kept = kept_options(options, KEPT) + kept_options(options.marker, KEPT_MARKER)
    clicked = options.target.pick or ""
    return FailedRun("locate", options.source, options.topic, clicked=clicked, kept=kept, live=live, view=options.view)


def _outputs(
    options: LocateOptions, wanted: WantedPictures, painter: PosePainter, path: PathLog
) -> Outputs[LocatedFrame]:
    """Begin the files of the run; the tables first, for a film that was begun must be closed."""
    table, latency = pose_table(wanted.folder, options.jsonl), latency_table(wanted.folder)
    pictures = RunPictures(wanted, painter.size, painter.paint, path)
    return Outputs(table, pictures, latency)


def _finish(options: LocateOptions, folder: Path, path: PathLog, camera: CameraModel) -> list[Path]:
    """Draw the path, if there is one; return the files of the run."""
    files = [folder / "poses.csv", folder / "poses.jsonl" if options.jsonl else None, folder / "latency.csv"]
    if path.any_found:
        with announce_if_slow("drawing the path ..."):
            from matchset.app.locate.path_picture import path_picture

            write_picture(folder / "poses.png", path_picture(path, camera))
        files.append(folder / "poses.png")
    return [each for each in (*files, *options.viewers.files) if each is not None]
