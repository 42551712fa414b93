"""The commands of the transmitter: `matchset radio bind`, `monitor`, `test-sticks` and `config`.

Imports that take long stand inside the functions, so that `matchset --help` answers at once.
"""

from typing import TYPE_CHECKING

import msgspec
import typer

from matchset.app import exit_codes
from matchset.app.cli_options import command_of
from matchset.flight.radio.options import BindOptions, ConfigOptions, MonitorOptions, StickOptions

if TYPE_CHECKING:
    from rich.text import Text

    from matchset.links.arduino.messages import Config, StatusReport

RADIO_EXIT_CODES = (
    "Exit codes: 0 done, 1 the firmware refused or heard something else, 2 bad options, "
    "3 no transmitter there or it went away, 130 stopped by Ctrl-C."
)
LINE_PERIOD = 0.1  # format: s between lines of the monitor; the firmware reports as often
NEVER_MS = 0xFFFF  # format: `StatusReport.age_ms` if no frame ever came

radio = typer.Typer(
    name="radio",
    no_args_is_help=True,
    help="The transmitter: an Arduino with a radio. docs/radio.md has the wiring, and the way to a hover.",
    epilog=RADIO_EXIT_CODES,
)


def bind(options: BindOptions) -> int:
    """Make the quadcopter listen to this transmitter. Switch it on, lay it level, then run this."""
    from matchset.flight.radio import connection
    from matchset.links.arduino.messages import BIND_DURATION

    radio = connection.open_radio(options.port)
    with radio.link as link:
        if link.read_config()[0] == "default":
            print("note: this transmitter has the id that all have at first; 'matchset radio config PORT --new-id'")
        link.bind()
        if not radio.wait(lambda report: report.state == "binding", 0.5):
            exit_codes.print_error(f"the firmware did not begin to bind; it is {link.report.state}")
            return connection.REFUSED
        radio.wait(lambda report: report.state != "binding", 2 * BIND_DURATION)
        print("bind packets were sent. If the quadcopter's lights have stopped blinking, it is bound.")
        print("If not: switch it off and on, lay it level, and bind again within five seconds.")
        for warning in link.report.warnings:
            print(f"warning: {warning}")
    return exit_codes.FOUND


def monitor(options: MonitorOptions) -> int:
    """Show what the transmitter says of itself: state, frames, errors, sticks, warnings. Sends no command."""
    from rich.console import Console
    from rich.live import Live

    from matchset.flight.radio import connection

    radio = connection.open_radio(options.port)
    start, duration = radio.clock(), options.duration
    console = Console(stderr=True)
    with radio.link as link, exit_codes.StopRequest() as stop:
        with Live(console=console, refresh_per_second=15, transient=not options.to_stdout) as live:
            while not stop and (duration is None or radio.clock() - start < duration):
                report = link.report
                if options.to_stdout:
                    print(msgspec.json.encode(report).decode(), flush=True)
                else:
                    live.update(report_line(report))
                radio.sleep(LINE_PERIOD)
        if not options.to_stdout:
            console.print(report_line(link.report))
    return exit_codes.FOUND


def report_line(report: "StatusReport") -> "Text":
    """Write a report of the firmware in one line."""
    from rich.text import Text

    age = "never" if report.age_ms == NEVER_MS else f"{report.age_ms} ms ago"
    throttle, pitch, yaw, roll = report.heard
    line = Text(no_wrap=True, overflow="ellipsis")
    line.append(f"{report.state:9s}", style="bold red" if report.state in ("armed", "holding") else "bold")
    line.append(f" frames {report.good}, bad {report.bad}, last {age}   ", style="dim")
    line.append(f"throttle {throttle:3d}  pitch {pitch:+4d}  yaw {yaw:+4d}  roll {roll:+4d}")
    line.append(f"   on the air {report.throttle_on_air:3d}   firmware {report.version}", style="dim")
    for warning in report.warnings:
        line.append(f"   {warning}", style="yellow")
    return line


def sticks(options: StickOptions) -> int:
    """Move one stick after the other and compare with what the firmware hears. Motors stay off without --arm."""
    from matchset.flight.radio import connection, stick_test

    motor_test = stick_test.MotorTestParameters(throttle=options.throttle, countdown=options.countdown)
    return stick_test.run_stick_test(connection.open_radio(options.port), motor_test if options.arm else None)


def config(options: ConfigOptions) -> int:
    """Show what the transmitter keeps in its memory, or change what is named."""
    import secrets

    from matchset.flight.radio import connection
    from matchset.flight.radio.config_changes import config_changes
    from matchset.links.arduino.messages import Config

    changes = config_changes(options)
    with connection.open_radio(options.port).link as link:
        result, old = link.read_config()
        new = msgspec.structs.replace(Config() if options.defaults else old, **changes)
        if options.new_id:
            new = msgspec.structs.replace(new, id=secrets.token_bytes(4) + new.id[4:])
        if new == old and not options.defaults:
            print_config(old, "nothing is stored, these are the defaults" if result == "default" else "as stored")
            return exit_codes.FOUND
        answer = link.write_config(new)
        if answer != "stored":
            exit_codes.print_error(f"the firmware did not take it, {answer}")
            return connection.REFUSED
        print_config(new, "stored now")
        if new.id != old.id:
            print("The id has changed: bind again.")
    return exit_codes.FOUND


def print_config(config: "Config", title: str) -> None:
    """Print a configuration of the transmitter, a line for each field."""
    pitch, yaw, roll = config.trims
    yes_no = ("no", "yes")
    print(f"configuration ({title}):")
    print(f"  id                  {config.id.hex(' ')}")
    print(f"  bind channels       {config.bind_channels[0]},{config.bind_channels[1]}  (the fourth, in turn)")
    print(f"  reversed            {','.join(config.reversed) or 'none'}")
    print(f"  bind at power on    {yes_no[config.bind_at_power_on]}")
    print(f"  trim follows stick  {yes_no[config.trim_follows_stick]}")
    print(f"  trims               pitch {pitch:+d}, yaw {yaw:+d}, roll {roll:+d}")
    print(f"  tail                {config.tail}")


radio.command(epilog=RADIO_EXIT_CODES)(command_of(bind))
radio.command(epilog=RADIO_EXIT_CODES)(command_of(monitor))
radio.command("test-sticks", epilog=RADIO_EXIT_CODES)(command_of(sticks))
radio.command(epilog=RADIO_EXIT_CODES)(command_of(config))
