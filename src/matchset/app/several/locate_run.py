"""The run of `matchset locate` with several balls: from its options to files and a summary."""

import itertools
import sys
from pathlib import Path

import msgspec

from matchset.app.drawing.picture_file import write_picture
from matchset.app.exit_codes import StopRequest
from matchset.app.guidance.explain import Explainer
from matchset.app.guidance.next_command import kept_options
from matchset.app.locate.options import LocateOptions
from matchset.app.locate.run import KEPT, KEPT_MARKER, ball_of
from matchset.app.locate.what_options_name import camera_for, load_camera, marker_color_of
from matchset.app.pictures.part import VideoPart
from matchset.app.pictures.run_pictures import RunPictures, WantedPictures
from matchset.app.progress import announce_if_slow
from matchset.app.run_folder import output_folder
from matchset.app.several.chosen import ChosenTargets, check_targets, chosen_or_explained, failed_run
from matchset.app.several.counts import TargetCounts, print_counts
from matchset.app.several.crowd import watch_of
from matchset.app.several.follow import TargetsFollower, known_targets
from matchset.app.several.painter import TargetsPainter, TargetsSummary
from matchset.app.several.poses import LocatedTargets, PathsLog, TargetsLocator, locate_several, target_pose_columns
from matchset.app.several.target_rows import TargetTable
from matchset.app.track.loop import exit_code
from matchset.app.track.outputs import Outputs, latency_table, write_frames
from matchset.app.viewers.run import viewed
from matchset.camera.camera_model import CameraModel
from matchset.image.color import ColorModel
from matchset.media.video import Video
from matchset.shapes.circle import Circle
from matchset.tracking.many.multi_tracker import MultiTracker
from matchset.tracking.many.parameters import MultiTrackerParameters


def run_locate_several(options: LocateOptions) -> int:
    """Follow and locate what the options say, write the files, and print a summary.

    Returns
    -------
    int
        The exit code.
    """
    if options.mavlink is not None:
        raise ValueError("--mavlink is of one ball: leave it out with --all or several balls")
    check_targets(options)
    ball = ball_of(options)
    loaded = load_camera(options)
    with (
        StopRequest() as stop,
        options.silence.open(options.source, options.fps, options.topic, options.view) as video,
    ):
        camera = camera_for(video, options, loaded)
        kept = kept_options(options, KEPT) + kept_options(options.marker, KEPT_MARKER)
        command = failed_run(options, "locate", Circle, kept, video.live)
        chosen, marker_color = _with_markers(video, options, chosen_or_explained(video, options, command))
        parameters = MultiTrackerParameters(points=options.points)
        tracker = MultiTracker(Circle, chosen.colors, chosen.most, parameters, finds=chosen.finds)
        known = known_targets(options, video, tracker, chosen, stop)
        follower = known or TargetsFollower(tracker, chosen.picks, chosen.finds)
        locator = TargetsLocator(follower, camera, ball, marker_color)
        folder = output_folder(options.out, "locate", options.force)
        counts, paths, explainer = TargetCounts(), PathsLog(), Explainer(command, chosen.first)
        out = sys.stderr if options.to_stdout else sys.stdout
        watch = watch_of(tracker, Circle, known is None, out)
        outputs = _outputs(options, WantedPictures.of(options, "locate", folder, video), locator, video)
        try:
            part = VideoPart.parse(options.shown.start, options.shown.end)
            used = part.of(itertools.chain(chosen.taken, video.until(lambda: bool(stop))))
            located = locate_several(used, locator, not video.live, stop, part.start is None, watch)
            located = located if known is None else known.timed(located)
            located = viewed(located, options.viewers, (options.source, options.force), (camera, 2.0 * ball.radius))
            watched = explainer.watch(paths.record(located))
            write_frames(watched, outputs, counts, video, options.to_stdout, "locating")
        finally:
            files = [*_finish(options, folder, paths, camera), *outputs.pictures.files]
            print_counts(video, counts, files, out, "locating", watch)
        if not stop:
            explainer.explain(folder, out)
    return exit_code(stop, counts)


def _with_markers(
    video: Video, options: LocateOptions, chosen: ChosenTargets
) -> tuple[ChosenTargets, ColorModel | None]:
    """Add the color of the markers, if there are any, to that of each ball; return that of the markers alone, too."""
    clicked = chosen.picks[0].frame if chosen.picks else 0
    color, taken = marker_color_of(video, options.marker, clicked, chosen.taken)
    if color is None:
        return chosen, None
    colors = {label: each | color for label, each in chosen.colors.items()}
    return msgspec.structs.replace(chosen, colors=colors, taken=taken), color


def _outputs(
    options: LocateOptions, wanted: WantedPictures, locator: TargetsLocator, video: Video
) -> Outputs[LocatedTargets]:
    """Begin the files of the run; the tables first, for a film that was begun must be closed."""
    folder = wanted.folder
    jsonl = folder / "poses.jsonl" if options.jsonl else None
    table, latency = TargetTable(folder / "poses.csv", target_pose_columns(), jsonl), latency_table(folder)
    painter = TargetsPainter((video.width, video.height), locator.distance_words)
    pictures = RunPictures[LocatedTargets](
        wanted,
        painter.size,
        lambda frame, located: painter.paint(frame, located.answer, located.row),
        summary=TargetsSummary(locator.distance_words),
    )
    return Outputs[LocatedTargets](table, pictures, latency)


def _finish(options: LocateOptions, folder: Path, paths: PathsLog, camera: CameraModel) -> list[Path]:
    """Draw the paths, if there are any; return the files of the run."""
    files = [folder / "poses.csv", *([folder / "poses.jsonl"] if options.jsonl else []), folder / "latency.csv"]
    if paths.any_found:
        with announce_if_slow("drawing the paths ..."):
            from matchset.app.several.paths_picture import paths_picture

            write_picture(folder / "poses.png", paths_picture(paths.paths, camera))
        files.append(folder / "poses.png")
    return [*files, *options.viewers.files]
