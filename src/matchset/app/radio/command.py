"""The command line of the transmitter: `matchset radio bind`, `monitor`, `test-sticks` and `config`."""

from typing import Annotated

import typer

from matchset.app.exit_codes import errors_in_one_line

RADIO_EXIT_CODES = (
    "Exit codes: 0 done, 1 the firmware refused or heard something else, 2 bad options, "
    "3 no transmitter there or it went away, 130 stopped by Ctrl-C."
)

radio = typer.Typer(
    name="radio",
    no_args_is_help=True,
    help="The transmitter: an Arduino with a radio. docs/radio.md has the wiring, and the way to a hover.",
    epilog=RADIO_EXIT_CODES,
)

Port = Annotated[str, typer.Argument(metavar="PORT", help="Its serial port: /dev/ttyUSB0, /dev/ttyACM0 or COM3.")]


@radio.command(epilog=RADIO_EXIT_CODES)
def bind(port: Port) -> None:
    """Make the quadcopter listen to this transmitter. Switch it on, lay it level, then run this."""
    with errors_in_one_line():
        from matchset.app.radio import actions as radio_commands
        from matchset.app.radio import connection as radio_link

        code = radio_commands.bind(radio_link.open_radio(port))
    raise typer.Exit(code)


@radio.command(epilog=RADIO_EXIT_CODES)
def monitor(
    port: Port,
    duration: Annotated[float | None, typer.Option(min=0.0, metavar="SECONDS", help="End by itself.")] = None,
    to_stdout: Annotated[bool, typer.Option("--print", help="One line of JSON each time, to stdout.")] = False,
) -> None:
    """Show what the transmitter says of itself: state, frames, errors, sticks, warnings. Sends no command."""
    with errors_in_one_line():
        from matchset.app.radio import actions as radio_commands
        from matchset.app.radio import connection as radio_link

        code = radio_commands.monitor(radio_link.open_radio(port), duration, to_stdout)
    raise typer.Exit(code)


@radio.command("test-sticks", epilog=RADIO_EXIT_CODES)
def sticks(
    port: Port,
    arm: Annotated[bool, typer.Option("--arm", help="Let the motors turn, after a countdown.")] = False,
    throttle: Annotated[float, typer.Option(help="How fast they turn, with --arm; at most 0.3.")] = 0.1,
    countdown: Annotated[int, typer.Option(metavar="SECONDS", help="Before they do, at least 3.")] = 5,
) -> None:
    """Move one stick after the other and compare with what the firmware hears. Motors stay off without --arm."""
    with errors_in_one_line():
        from matchset.app.radio import connection as radio_link
        from matchset.app.radio import stick_test

        options = stick_test.StickOptions(arm, throttle, countdown)
        code = stick_test.try_sticks(radio_link.open_radio(port), options)
    raise typer.Exit(code)


@radio.command(epilog=RADIO_EXIT_CODES)
def config(
    port: Port,
    identity: Annotated[
        str | None, typer.Option("--id", metavar="HEX", help="Four or five bytes; the fifth is a2 (X5SC, X5SW: a1).")
    ] = None,
    new_id: Annotated[bool, typer.Option("--new-id", help="A random id: each transmitter needs its own.")] = False,
    bind_channels: Annotated[
        str | None, typer.Option(metavar="A,B", help="Fourth bind channel, two in turn: 32,9; or one: 32.")
    ] = None,
    reverse: Annotated[
        str | None, typer.Option(metavar="AXES", help="What goes the wrong way: roll,pitch,yaw; or none.")
    ] = None,
    trims: Annotated[str | None, typer.Option(metavar="P,Y,R", help="Pitch, yaw, roll: -31 ... 31 each.")] = None,
    bind_at_power_on: Annotated[bool | None, typer.Option(help="Bind whenever power comes.")] = None,
    trim_follows_stick: Annotated[bool | None, typer.Option(help="More range, less fine.")] = None,
    tail: Annotated[int | None, typer.Option(help="Byte 8 of a packet: 0; X5SW 1.")] = None,
    defaults: Annotated[bool, typer.Option("--defaults", help="Begin from the defaults.")] = False,
) -> None:
    """Show what the transmitter keeps in its memory, or change what is named."""
    with errors_in_one_line():
        from matchset.app.radio import actions as radio_commands
        from matchset.app.radio import connection as radio_link
        from matchset.app.radio.config_options import config_changes

        changes = config_changes(identity, bind_channels, reverse, trims)
        flags = {"bind_at_power_on": bind_at_power_on, "trim_follows_stick": trim_follows_stick, "tail": tail}
        changes |= {name: value for name, value in flags.items() if value is not None}
        code = radio_commands.config(radio_link.open_radio(port), changes, new_id, defaults)
    raise typer.Exit(code)
