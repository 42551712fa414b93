"""The command line `matchset`: the list of its commands.

This module and all `command` and `options` modules load quickly, so that `matchset --help` does: the functions that run
a command import what they need.
"""

import io
import shutil
import sys
from typing import Annotated, Any

import typer

from matchset.app.calibrate.command import CALIBRATE_EPILOG, calibrate
from matchset.app.cli_options import command_of
from matchset.app.detect.command import DETECT_EPILOG, detect
from matchset.app.exit_codes import EXIT_CODES, errors_in_one_line, print_error
from matchset.app.help_printer import NARROW, load_help_printer, plain_help
from matchset.app.locate.command import LOCATE_EPILOG, locate
from matchset.app.track.command import (
    LEARN_EPILOG,
    PARAMS_EPILOG,
    SCORE_EPILOG,
    TRACK_EPILOG,
    demo,
    learn,
    params,
    score,
    track,
)
from matchset.app.warm import warm
from matchset.batch.command import BATCH_EPILOG, batch
from matchset.flight.fly.command import FLY_EPILOG, fly
from matchset.flight.identify.command import IDENTIFY_EPILOG, identify
from matchset.flight.preflight.command import PREFLIGHT_EPILOG, preflight
from matchset.flight.radio.command import radio
from matchset.flight.recording.command import REPLAY_EPILOG, replay
from matchset.flight.simulate.command import SIMULATE_EPILOG, simulate
from matchset.live.command import LIVE_EPILOG, live

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
    version: Annotated[bool, typer.Option("--version", metavar="", help="Print the version.")] = False,
) -> None:
    """Find a ball of known color in bad video, from one click, thousands of times a second."""
    if version:
        from importlib.metadata import version as installed

        print("matchset", installed("matchset"))
        raise typer.Exit


app.command(epilog=TRACK_EPILOG)(command_of(track))
app.command(epilog=LEARN_EPILOG)(command_of(learn))
app.command(epilog=DETECT_EPILOG)(command_of(detect))
app.command(epilog=CALIBRATE_EPILOG)(command_of(calibrate))
app.command(epilog=LOCATE_EPILOG)(command_of(locate))
app.command(epilog=BATCH_EPILOG)(command_of(batch))
app.command(epilog=LIVE_EPILOG)(command_of(live))
app.command(epilog=PREFLIGHT_EPILOG)(command_of(preflight))
app.command(epilog=FLY_EPILOG)(command_of(fly))
app.command(epilog=IDENTIFY_EPILOG)(command_of(identify))
app.command(epilog=SIMULATE_EPILOG)(command_of(simulate))
app.command(epilog=REPLAY_EPILOG)(command_of(replay))
app.command(epilog=SCORE_EPILOG)(command_of(score))
app.command(epilog=PARAMS_EPILOG)(command_of(params))
app.command()(command_of(demo))
app.command()(warm)


def what_was_typed(error: Any) -> str:
    """Say what a wrong option is: the value that was typed and what is wanted, or the commands that have it.

    Parameters
    ----------
    error : Exception
        Typer's, of a wrong option.

    Returns
    -------
    str
        What follows its own words; empty if there is nothing to add.
    """
    tried = getattr(error.__cause__, "errors", None)  # Pydantic's words lack the value and what it is
    if tried is not None:
        wanted = ": ".join(filter(None, (error.param.metavar, getattr(error.param, "help", None))))
        return f", got {tried()[0]['input']!r:.60}" + (f"; wanted is {wanted}" if wanted else "")
    option = getattr(error, "option_name", None)
    commands = getattr(typer.main.get_command(app), "commands", {}).items() if option else ()
    having = [name for name, command in commands if any(option in each.opts for each in command.params)]
    return f"; it is an option of {', '.join(having)}" if having else ""


def main() -> None:
    """Run the command line; the console script `matchset`."""
    for stream in (sys.stdout, sys.stderr):  # names of files that are no text are printed as they are
        if isinstance(stream, io.TextIOWrapper) and stream.errors == "strict":
            stream.reconfigure(errors="surrogateescape")
    if shutil.get_terminal_size().columns < NARROW:
        plain_help(app)
    if len(sys.argv) == 1 or not {"-h", "--help"}.isdisjoint(sys.argv):
        load_help_printer()
    try:
        code = app(standalone_mode=False)
    except Exception as error:
        # Typer's own errors (a wrong option) format themselves; anything else is a bug and shows its traceback.
        # Help that is shown because nothing was typed is no error to report.
        words = getattr(error, "format_message", None)
        if words is None:
            raise
        if type(error).__name__ != "NoArgsIsHelpError":
            print_error(words() + what_was_typed(error))
        code = getattr(error, "exit_code", 2)
    with errors_in_one_line():
        sys.stdout.flush()
    sys.exit(code if isinstance(code, int) else 0)


if __name__ == "__main__":
    main()
