"""The run of `matchset track` with several targets: from its options to files and a summary."""

import itertools
import sys
from pathlib import Path
from typing import Any

from matchset.app.exit_codes import StopRequest
from matchset.app.guidance.explain import Explainer
from matchset.app.guidance.next_command import kept_options
from matchset.app.pictures.part import VideoPart
from matchset.app.pictures.run_pictures import RunPictures, WantedPictures
from matchset.app.run_folder import output_folder
from matchset.app.several.chosen import ChosenTargets, check_targets, chosen_or_explained, failed_run
from matchset.app.several.counts import TargetCounts, print_counts
from matchset.app.several.crowd import watch_of
from matchset.app.several.follow import FollowedFrame, TargetsFollower, follow_several, known_targets
from matchset.app.several.mot_file import noted
from matchset.app.several.painter import TargetsPainter, TargetsSummary, target_words
from matchset.app.several.target_rows import TargetTable, target_columns
from matchset.app.target.shape_option import parse_shape
from matchset.app.track.loop import exit_code
from matchset.app.track.options import TrackOptions
from matchset.app.track.outputs import Outputs, latency_table, write_frames
from matchset.app.track.run import tables_of
from matchset.app.viewers.run import viewed
from matchset.media.video import Video
from matchset.tracking.many.multi_tracker import MultiTracker
from matchset.tracking.many.parameters import MultiTrackerParameters

_KEPT = {"points": "--points", "fps": "--fps"}


def run_several(options: TrackOptions) -> int:
    """Follow what the options say, write the files, and print a summary.

    Returns
    -------
    int
        The exit code.
    """
    check_targets(options)
    family = parse_shape(options.shape)
    silence, view = options.silence, options.view
    with StopRequest() as stop, silence.open(options.source, options.fps, options.topic, view) as video:
        command = failed_run(options, "track", family, kept_options(options, _KEPT), video.live)
        chosen = chosen_or_explained(video, options, command)
        parameters = MultiTrackerParameters(points=options.points)
        tracker = MultiTracker(family, chosen.colors, chosen.most, parameters, finds=chosen.finds)
        known = known_targets(options, video, tracker, chosen, stop)
        follower = known or TargetsFollower(tracker, chosen.picks, chosen.finds)
        folder = output_folder(options.out, "track", options.force)
        counts, explainer = TargetCounts(), Explainer(command, chosen.first)
        out = sys.stderr if options.to_stdout else sys.stdout
        watch = watch_of(tracker, family, known is None, out)
        files = tables_of(options, folder)
        try:
            outputs = _outputs(options, folder, video, family, chosen)
            part = VideoPart.parse(options.shown.start, options.shown.end)
            used = part.of(itertools.chain(chosen.taken, video.until(lambda: bool(stop))))
            frames = follow_several(used, follower, not video.live, stop, part.start is None, watch)
            frames = frames if known is None else known.timed(frames)
            frames = noted(frames, options.several.mot, options.force, options.source)
            frames = viewed(frames, options.viewers, (options.source, options.force))
            write_frames(explainer.watch(frames), outputs, counts, video, options.to_stdout)
            files += outputs.pictures.files
        finally:
            print_counts(video, counts, files, out, watch=watch)
        if not stop:
            explainer.explain(folder, out)
    return exit_code(stop, counts)


def _outputs(
    options: TrackOptions, folder: Path, video: Video, family: type[Any], chosen: ChosenTargets
) -> Outputs[FollowedFrame]:
    """Begin the files of the run; the tables first, for a film that was begun must be closed."""
    jsonl = folder / "tracks.jsonl" if options.jsonl else None
    columns = target_columns(family.parameters)
    table, latency = TargetTable(folder / "tracks.csv", columns, jsonl), latency_table(folder)
    labels = tuple(chosen.colors)
    painter = TargetsPainter((video.width, video.height), target_words(len(labels) > 1))
    pictures = RunPictures[FollowedFrame](
        WantedPictures.of(options, "track", folder, video),
        painter.size,
        lambda frame, followed: painter.paint(frame, followed.answer, followed.row),
        summary=TargetsSummary(target_words(len(labels) > 1)),
    )
    return Outputs(table, pictures, latency)
