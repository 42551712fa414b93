"""The run of `matchset track`: from its options to files, a summary, and what to do where nothing was found."""

import functools
import itertools
import shlex
import sys
from pathlib import Path
from typing import Any

import msgspec

from matchset.app.backward.before_click import before_click
from matchset.app.cli_options import source_words
from matchset.app.course.log import ShapeLog
from matchset.app.exit_codes import StopRequest
from matchset.app.guidance.explain import Explainer, explain_refused_click
from matchset.app.guidance.next_command import FailedRun, kept_options
from matchset.app.parameters_file import tracker_parameters
from matchset.app.pictures.part import VideoPart
from matchset.app.pictures.run_pictures import WantedPictures
from matchset.app.run_folder import output_folder
from matchset.app.several.mot_file import noted
from matchset.app.target.shape_option import parse_shape
from matchset.app.target.target_options import RefusedClickError, check_target_options, target_for
from matchset.app.track.loop import RunStatistics, TrackedFrame, exit_code, follow, print_summary, trackers_for
from matchset.app.track.options import TrackOptions
from matchset.app.track.outputs import Outputs, latency_table, track_outputs, write_frames
from matchset.app.track.rows import track_table
from matchset.app.viewers.run import viewed
from matchset.shapes.circle import Circle
from matchset.tracking.tracker import Tracker

_KEPT = {"points": "--points", "params": "--params", "fps": "--fps"}


def run_track(options: TrackOptions) -> int:
    """Follow what the options say, write the files, and print a summary.

    Returns
    -------
    int
        The exit code.
    """
    check_target_options(options.target, shlex.join(source_words(options.source, options.topic, options.view)))
    family = parse_shape(options.shape)
    parameters = tracker_parameters(options.params)
    make = functools.partial(Tracker, family, points=options.points, parameters=parameters)
    silence, view = options.silence, options.view
    with StopRequest() as stop, silence.open(options.source, options.fps, options.topic, view) as video:
        command = _command(options, family, video.live)
        try:
            target, taken = target_for(video, msgspec.structs.replace(options.target, ball=family is Circle))
        except RefusedClickError as refused:
            explain_refused_click(refused, command, output_folder(options.out, "track", options.force))
            raise
        target.say_notes()
        before = before_click(options, video, target, make, stop)
        tracker_at = trackers_for(target, make, before)
        folder = output_folder(options.out, "track", options.force)
        statistics, explainer = RunStatistics(), Explainer(command, target)
        out = sys.stderr if options.to_stdout else sys.stdout
        tables = tables_of(options, folder)
        files = list(tables)
        try:
            log = ShapeLog(family)
            wanted_pictures = WantedPictures.of(options, "track", folder, video)
            outputs = _outputs(options, wanted_pictures, (video.width, video.height), log)
            files = [*tables, *outputs.pictures.files]
            part = VideoPart.parse(options.shown.start, options.shown.end)
            used = part.of(itertools.chain(taken, video.until(lambda: bool(stop))))
            frames = follow(used, tracker_at, gaps=not video.live, stop=stop, whole=part.start is None)
            frames = frames if before is None else before.timed(frames)
            frames = noted(frames, options.several.mot, options.force, options.source)
            frames = viewed(frames, options.viewers, (options.source, options.force))
            frames = frames if video.live else log.record(frames)  # a camera may run for weeks, and has no summary
            write_frames(explainer.watch(frames), outputs, statistics, video, options.to_stdout)
            files = [*tables, *outputs.pictures.files]
        finally:
            print_summary(video, statistics, "tracking", files, out)
        if not stop:
            explainer.explain(folder, out)
    return exit_code(stop, statistics)


def tables_of(options: TrackOptions, folder: Path) -> list[Path]:
    """Return the tables of a run, for its summary."""
    asked = [folder / "tracks.jsonl"] if options.jsonl else []
    mot = [] if options.several.mot is None else [options.several.mot]
    return [folder / "tracks.csv", *asked, folder / "latency.csv", *mot, *options.viewers.files]


def _outputs(
    options: TrackOptions, wanted: WantedPictures, size: tuple[int, int], log: ShapeLog
) -> Outputs[TrackedFrame]:
    """Begin the files of the run; the tables first, for a film that was begun must be closed."""
    folder, family = wanted.folder, log.family
    table = track_table(folder / "tracks.csv", family.parameters, folder / "tracks.jsonl" if options.jsonl else None)
    return track_outputs(table, wanted, size, log, latency_table(folder))


def _command(options: TrackOptions, family: type[Any], live: bool) -> FailedRun:
    """Describe the command for what is said where nothing was found."""
    clicked = options.target.pick or ""
    kept = kept_options(options, _KEPT)
    return FailedRun("track", options.source, options.topic, family, clicked, kept, live, options.view)
