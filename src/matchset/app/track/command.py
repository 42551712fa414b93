"""The commands `track`, `learn`, `score`, `demo` and `params`.

This module is loaded for every `matchset --help`; the functions import what they need.
"""

import msgspec

from matchset.app.cli_options import shape_file
from matchset.app.exit_codes import EXIT_CODES, FOUND
from matchset.app.several.options import are_several, check_several, color_files
from matchset.app.track.options import DemoOptions, LearnOptions, ParamsOptions, ScoreOptions, TrackOptions

TRACK_EPILOG = f"""
[bold]Examples[/bold]

  matchset track ball.mp4 --pick 427,146@60 --video out.webm

  matchset track ball.mp4 --candidate 1

  matchset track 0 --color ball.npz --print | my_program

  matchset track red.mp4 --hsv 170,120,80:10,255,255

  matchset track sign.mp4 --shape octagon --pick 310,200

  matchset track eye.mp4 --shape ellipse --gray dark --pick 200,150

  matchset track flight.bag --topic /cam/image_raw --color ball.npz

  matchset track juggling.mp4 --pick 427,146 --all --mot juggling.txt

  matchset track rtsp://10.0.0.7/live --color ball.npz --timeout 1 --reconnect 60

Without -o everything goes to a new folder, runs/0001-track and so on. tracks.csv holds one row a frame:
frame, time, found, the shape's parameters (x, y, radius), their standard deviations, support, and why it was lost.

{EXIT_CODES}
"""


def track(options: TrackOptions) -> int:
    """Follow a ball, or another shape, through a video or before a camera, and write it for every frame."""
    check_several(options)
    _check_track(options)
    if are_several(options):
        from matchset.app.several.run import run_several

        return run_several(options)
    from matchset.app.track.run import run_track

    return run_track(msgspec.structs.replace(options, target=options.target.single))


def _check_track(options: TrackOptions) -> None:
    """Check the outputs before anything is opened or loaded."""
    from matchset.app.run_folder import check_run

    shown = options.shown.names("track", options.video, options.to_stdout)
    names = "tracks.csv", "latency.csv", "why.png", *(("tracks.jsonl",) if options.jsonl else ()), *shown
    inputs = [options.source, shape_file(options.shape), options.params, *color_files(options.target.color)]
    files = [options.video, options.shown.gif, options.several.mot, *options.viewers.files]
    check_run(options.out, names, files, inputs, options.force)
    options.shown.check(options.video)
    options.viewers.check()


LEARN_EPILOG = f"""
[bold]Examples[/bold]

  matchset learn ball.mp4

  matchset learn ball.mp4 --frame 60 --pick 427,146 -o ball.npz

{EXIT_CODES}
"""


def learn(options: LearnOptions) -> int:
    """Show where the ball is, in a picture with a pixel grid; with a pick, learn its color and save it."""
    _check_learn(options)
    from matchset.app.track.learn_command import learn_color, show_candidates

    return show_candidates(options) if options.pick is None else learn_color(options)


def _check_learn(options: LearnOptions) -> None:
    """Check the outputs before anything is opened or loaded."""
    from matchset.app.run_folder import check_run

    out = options.out
    if options.pick is None and (options.marker or options.reading != 1):
        raise ValueError("--marker and --reading say what a --pick means: give one")
    if options.marker and options.reading != 1:
        raise ValueError("give one of --marker and --reading, not both")
    if out is not None and options.pick is not None and out.suffix.lower() != ".npz":
        raise ValueError(f"a color file's name must end in .npz, got {str(out)!r}")
    if out is not None and options.pick is None and out.suffix.lower() not in (".png", ".jpg"):
        raise ValueError(f"without --pick, -o names a picture (.png or .jpg), got {str(out)!r}")
    mask = out.with_name(out.stem + "-mask.png") if out is not None and options.pick is not None else None
    check_run(None, (), [out, mask], [options.source, shape_file(options.shape)], options.force)


SCORE_EPILOG = """
[bold]Definitions[/bold]

The error of an answer is |x - x*| + |y - y*| + |r - r*| in px; rows of the truth marked lowconf are left out.
Valid: error below 5 px, among all frames with the ball visible and not lowconf. Lost: visible, not answered.
False lock: answered while the ball is absent, or with a center farther than r from the true one.
Trembling: mean over consecutive frames of the change of the error, |de_x| + |de_y| + |de_r|; jitter: rms of
its second difference. Both need truth in consecutive frames; where there is none they are "-" (JSON: null).
"""


def score(options: ScoreOptions) -> int:
    """Measure tracks against the truth."""
    from matchset.app.track.score import score_files

    score_files(options.tracks, options.truth, options.start, options.video, options.as_json, options.identity)
    return FOUND


def demo(options: DemoOptions) -> int:
    """Track a rendered clip with exact truth: no camera, no network, under a minute."""
    from matchset.app.run_folder import check_run

    names = "demo.webm", "sheet.png", "tracks.csv", "truth.csv"
    check_run(options.out, names, [], [shape_file(options.shape)], options.force)
    from matchset.app.track.demo import demonstrate_circle, demonstrate_shape

    return demonstrate_circle(options) if options.shape == "circle" else demonstrate_shape(options)


PARAMS_EPILOG = """
[bold]Example[/bold]

  matchset params > tracker.toml

  matchset track ball.mp4 --pick 427,146@60 --params tracker.toml

A file may hold some of them only; the others have their defaults.
"""


def params(options: ParamsOptions) -> int:
    """Print all parameters of a tracker as TOML, with their meanings, for --params of track and locate."""
    from matchset.app.parameters_file import parameters_toml, tracker_parameters

    print(parameters_toml(tracker_parameters(options.params)), end="")
    return FOUND
