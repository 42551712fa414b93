"""The command line: `matchset track`, `learn`, `calibrate`, `locate`, `replay`, `score`, `demo` and `radio`.

Heavy imports wait inside the commands, so that `matchset --help` answers at once.
"""

import sys
from pathlib import Path
from typing import Annotated

import typer

from matchset.app.cli_options import (
    AnnotatedVideo,
    Candidate,
    Color,
    Folder,
    Force,
    Gray,
    Hsv,
    Pick,
    Points,
    ShapeName,
    Source,
    ToStdout,
    command_of,
)
from matchset.app.exit_codes import EXIT_CODES, errors_in_one_line, say_error
from matchset.app.flight.command import FLY_EPILOG, fly
from matchset.app.flight.simulate import SIMULATE_EPILOG, simulate
from matchset.app.locate.command import LOCATE_EPILOG, locate
from matchset.app.radio.command import radio
from matchset.app.recording.command import REPLAY_EPILOG, replay

app = typer.Typer(
    name="matchset",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog=EXIT_CODES,
)
app.add_typer(radio)


@app.callback(invoke_without_command=True)
def matchset(
    version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False,
) -> None:
    """Find a ball of known color in bad video, from one click, thousands of times a second."""
    if version:
        from importlib.metadata import version as installed

        print("matchset", installed("matchset"))
        raise typer.Exit


TRACK_EPILOG = f"""
[bold]Examples[/bold]

  matchset track ball.mp4 --pick 427,146@60 --video out.mp4

  matchset track ball.mp4 --candidate 1

  matchset track 0 --color ball.npz --print | my_program

  matchset track red.mp4 --hsv 170,120,80:10,255,255

  matchset track sign.mp4 --shape octagon --pick 310,200

  matchset track eye.mp4 --shape ellipse --gray dark --pick 200,150

Without -o everything goes to a new folder, runs/0001-track and so on. tracks.csv holds one row a frame:
frame, time, found, the shape's parameters (x, y, radius), their standard deviations, support, and why it was lost.

{EXIT_CODES}
"""


@app.command(epilog=TRACK_EPILOG)
def track(
    source: Source,
    pick: Pick = None,
    candidate: Candidate = None,
    color: Color = None,
    hsv: Hsv = None,
    gray: Gray = None,
    shape: ShapeName = "circle",
    video: AnnotatedVideo = None,
    out: Folder = None,
    jsonl: Annotated[bool, typer.Option("--jsonl", help="Write tracks.jsonl too.")] = False,
    to_stdout: ToStdout = False,
    force: Force = False,
    points: Points = 64,
) -> None:
    """Follow a ball, or another shape, through a video or before a camera, and write it for every frame."""
    with errors_in_one_line():
        from matchset.app.track import command as track_command
        from matchset.app.track.target_options import Wish

        wish = Wish(pick, candidate, tuple(color or ()), tuple(hsv or ()), gray)
        options = track_command.TrackOptions(source, wish, out, video, jsonl, to_stdout, force, points, shape)
        code = track_command.track(options)
    raise typer.Exit(code)


LEARN_EPILOG = f"""
[bold]Examples[/bold]

  matchset learn ball.mp4

  matchset learn ball.mp4 --frame 60 --pick 427,146 -o ball.npz

{EXIT_CODES}
"""


@app.command(epilog=LEARN_EPILOG)
def learn(
    source: Source,
    frame: Annotated[
        int | None,
        typer.Option(min=0, help="The frame to look at; without it one that shows a ball is chosen."),
    ] = None,
    pick: Annotated[
        str | None,
        typer.Option(metavar="X,Y[@FRAME]", help="A pixel on the ball: learn its color and save it."),
    ] = None,
    out: Annotated[
        Path | None,
        typer.Option("-o", metavar="FILE", help="The color file (.npz); without a pick, the picture."),
    ] = None,
    shape: ShapeName = "circle",
    force: Force = False,
) -> None:
    """Show where the ball is, in a picture with a pixel grid; with a pick, learn its color and save it."""
    with errors_in_one_line():
        from matchset.app.track import learn_command

        options = learn_command.LearnOptions(source, frame, pick, out, force, shape)
        code = learn_command.learn(options)
    raise typer.Exit(code)


CALIBRATE_EPILOG = """
[bold]Examples[/bold]

  matchset calibrate --board 9x6 --square 0.025 --board-picture board.png

  matchset calibrate pictures/ --board 9x6 --square 0.025 -o camera.toml

  matchset calibrate 0 --board 9x6 --square 0.025 --charuco 0.018

  matchset calibrate ball.mp4 --ball-diameter 0.28 --at 0.5,1.0,1.5 --color ball.npz

The board is moved all over the picture and tilted, 20 to 40 degrees, each time differently. Distances of the ball are
from the lens to its nearest point; give one video in which it is held still at all of them in turn, or one for each.

Exit codes: 0 done, 1 no board or ball found or the views do not suffice, 2 bad input or options, 3 camera or stream
broke, 130 stopped by Ctrl-C.
"""


@app.command(epilog=CALIBRATE_EPILOG)
def calibrate(
    sources: Annotated[
        list[str] | None,
        typer.Argument(metavar="SOURCE...", help="A video, a folder of pictures, a camera's number, or a URL."),
    ] = None,
    board: Annotated[
        str | None, typer.Option(metavar="9x6", help="Inner corners of the board: 10 x 7 squares have 9x6.")
    ] = None,
    square: Annotated[float | None, typer.Option(metavar="M", help="Side of a square, m.")] = None,
    charuco: Annotated[
        float | None, typer.Option(metavar="M", help="It is a ChArUco board: a marker's side, m.")
    ] = None,
    dictionary: Annotated[str, typer.Option(metavar="NAME", help="The markers' dictionary.")] = "5X5_100",
    board_picture: Annotated[
        Path | None, typer.Option(metavar="OUT.png", help="Draw the board to print; no SOURCE then.")
    ] = None,
    ball_diameter: Annotated[
        float | None, typer.Option(metavar="M", help="Use the ball in place of a board: its diameter, m.")
    ] = None,
    at: Annotated[
        str | None, typer.Option(metavar="M,M,...", help="From the lens to the ball's nearest point, in turn, m.")
    ] = None,
    pick: Pick = None,
    candidate: Candidate = None,
    color: Color = None,
    hsv: Hsv = None,
    out: Annotated[Path | None, typer.Option("-o", metavar="FILE.toml", help="The camera file.")] = None,
    force: Force = False,
) -> None:
    """Find a camera's focal length and lens distortion, from a board or from the ball itself."""
    with errors_in_one_line():
        from matchset.app.calibrate.options import run
        from matchset.app.track.target_options import Wish

        wish = Wish(pick, candidate, tuple(color or ()), tuple(hsv or ()))
        code = run(
            tuple(sources or ()),
            (board, square, charuco, dictionary, board_picture),
            (ball_diameter, at, wish),
            out,
            force,
        )
    raise typer.Exit(code)


app.command(epilog=LOCATE_EPILOG)(locate)
app.command(epilog=FLY_EPILOG)(command_of(fly))
app.command(epilog=SIMULATE_EPILOG)(command_of(simulate))
app.command(epilog=REPLAY_EPILOG)(command_of(replay))

SCORE_EPILOG = """
[bold]Definitions[/bold]

The error of an answer is |x - x*| + |y - y*| + |r - r*| in px; rows of the truth marked lowconf are left out.
Valid: error below 5 px, among all frames with the ball visible and not lowconf. Lost: visible, not answered.
False lock: answered while the ball is absent, or with a center farther than r from the true one.
Trembling: mean over consecutive frames of the change of the error, |de_x| + |de_y| + |de_r|; jitter: rms of
its second difference. Both need truth in consecutive frames; where there is none they are "-" (JSON: null).
"""


@app.command(epilog=SCORE_EPILOG)
def score(
    tracks: Annotated[Path, typer.Argument(help="tracks.csv of 'matchset track'.")],
    truth: Annotated[Path, typer.Argument(help="Truth: video,frame,x,y,r,visible,method.")],
    as_json: Annotated[bool, typer.Option("--json", help="Print one line of JSON.")] = False,
    start: Annotated[int, typer.Option("--from", min=0, metavar="FRAME", help="Score from this frame on.")] = 0,
    video: Annotated[
        str | None, typer.Option(metavar="NAME", help="Which video's rows, if the truth holds several.")
    ] = None,
) -> None:
    """Measure tracks against the truth."""
    with errors_in_one_line():
        from matchset.app.track.score_command import score_files

        score_files(tracks, truth, start, video, as_json)


@app.command()
def demo(
    out: Annotated[Path | None, typer.Option("-o", metavar="DIR", help="Folder for what it writes.")] = None,
    frames: Annotated[int, typer.Option(min=10, max=100_000, help="Length of the clip.")] = 300,
    shape: ShapeName = "circle",
    force: Force = False,
) -> None:
    """Track a rendered clip with exact truth: no camera, no network, under a minute."""
    with errors_in_one_line():
        if shape == "circle":
            from matchset.app.track.demo import run_demo

            code = run_demo(out, frames, force)
        else:
            from matchset.app.track.shape_demo import run_shape_demo

            code = run_shape_demo(shape, out, frames, force)
    raise typer.Exit(code)


def main() -> None:
    """Run the command line; the console script `matchset`."""
    try:
        code = app(standalone_mode=False)
    except Exception as error:
        # Typer's own errors (a wrong option) know how to say themselves; anything else is a bug and shows its
        # trace. Help asked for by typing nothing is no error to speak of.
        words = getattr(error, "format_message", None)
        if words is None:
            raise
        if type(error).__name__ != "NoArgsIsHelpError":
            say_error(words())
        code = getattr(error, "exit_code", 2)
    with errors_in_one_line():
        sys.stdout.flush()
    sys.exit(code if isinstance(code, int) else 0)


if __name__ == "__main__":
    main()
