"""The run of `matchset locate` with several balls: from its options to files and a summary."""

import itertools
import sys

from matchset.app.exit_codes import StopRequest, print_note
from matchset.app.locate.options import LocateOptions
from matchset.app.locate.what_options_name import ball_target, camera_for, load_camera
from matchset.app.pictures.part import VideoPart
from matchset.app.pictures.run_pictures import RunPictures, WantedPictures
from matchset.app.run_folder import output_folder
from matchset.app.several.chosen import check_targets, chosen_targets
from matchset.app.several.counts import TargetCounts, print_counts
from matchset.app.several.follow import TargetsFollower
from matchset.app.several.painter import TargetsPainter, TargetsSummary
from matchset.app.several.poses import LocatedTargets, TargetsLocator, locate_several, target_pose_columns
from matchset.app.several.target_rows import TargetTable
from matchset.app.track.loop import exit_code
from matchset.app.track.outputs import Outputs, latency_table, write_frames
from matchset.app.viewers.run import viewed
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
    if options.marker.given or options.markers is not None or options.mavlink is not None:
        raise ValueError("markers and --mavlink are of one ball: leave them out with --all or several balls")
    check_targets(options)
    ball = ball_target(options.diameter, options.marker_diameter, None, False, options.diameter_sigma)
    loaded = load_camera(options)
    with (
        StopRequest() as stop,
        options.silence.open(options.source, options.fps, options.topic, options.view) as video,
    ):
        camera = camera_for(video, options, loaded)
        chosen = chosen_targets(video, options, True)
        parameters = MultiTrackerParameters(points=options.points)
        tracker = MultiTracker(Circle, chosen.colors, chosen.most, parameters, finds=chosen.finds)
        locator = TargetsLocator(TargetsFollower(tracker, chosen.picks, chosen.finds), camera, ball)
        folder = output_folder(options.out, "locate", options.force)
        counts, out = TargetCounts(), sys.stderr if options.to_stdout else sys.stdout
        jsonl = folder / "poses.jsonl" if options.jsonl else None
        files = [
            folder / "poses.csv",
            *([] if jsonl is None else [jsonl]),
            folder / "latency.csv",
            *options.viewers.files,
        ]
        try:
            table, latency = TargetTable(folder / "poses.csv", target_pose_columns(), jsonl), latency_table(folder)
            wanted = WantedPictures.of(options, "locate", folder, video)
            pictures = _pictures(wanted, (video.width, video.height), locator)
            outputs = Outputs[LocatedTargets](table, pictures, latency)
            part = VideoPart.parse(options.shown.start, options.shown.end)
            used = part.of(itertools.chain(chosen.taken, video.until(lambda: bool(stop))))
            located = locate_several(used, locator, gaps=not video.live, stop=stop, whole=part.start is None)
            located = viewed(located, options.viewers, (options.source, options.force), (camera, 2.0 * ball.radius))
            write_frames(located, outputs, counts, video, options.to_stdout, "locating")
            files += outputs.pictures.files
        finally:
            print_counts(video, counts, files, out, "locating")
        if not counts.found and not stop:
            print_note("nothing was found: 'matchset locate' without --all says in why.png why one ball is not")
    return exit_code(stop, counts)


def _pictures(wanted: WantedPictures, size: tuple[int, int], locator: TargetsLocator) -> RunPictures[LocatedTargets]:
    """Begin the pictures of the run."""
    painter = TargetsPainter(size, locator.distance_words)
    return RunPictures[LocatedTargets](
        wanted,
        painter.size,
        lambda frame, located: painter.paint(frame, located.answer, located.row),
        summary=TargetsSummary(locator.distance_words),
    )
