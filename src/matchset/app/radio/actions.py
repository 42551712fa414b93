"""`matchset radio bind`, `monitor` and `config`."""

import secrets

import msgspec
from rich.console import Console
from rich.live import Live
from rich.text import Text

from matchset.app import exit_codes as ending
from matchset.app.radio.connection import REFUSED, Radio
from matchset.links.arduino.messages import BIND_DURATION, Config, Report

LINE_PERIOD = 0.1  # s between lines of the monitor; the firmware speaks as often


def bind(radio: Radio) -> int:
    """Send bind packets for 1.4 s, throttle zero; returns the exit code."""
    with radio.link as link:
        if link.read_config()[0] == "default":
            print("note: this transmitter has the id that all have at first; 'matchset radio config PORT --new-id'")
        link.bind()
        if not radio.wait(lambda report: report.state == "binding", 0.5):
            ending.say_error(f"the firmware did not begin to bind; it is {link.report.state}")
            return REFUSED
        radio.wait(lambda report: report.state != "binding", 2 * BIND_DURATION)
        print("bind packets were sent. If the quadcopter's lights have stopped blinking, it is bound.")
        print("If not: switch it off and on, lay it level, and bind again within five seconds.")
        warn(link.report)
    return ending.FOUND


def warn(report: Report) -> None:
    """Print what is wrong with the transmitter."""
    for words in report.warnings:
        print(f"warning: {words}")


def monitor(radio: Radio, duration: float | None, to_stdout: bool) -> int:
    """Show what the firmware says of itself, ten times a second; nothing is sent meanwhile.

    Parameters
    ----------
    radio : Radio
        The transmitter.
    duration : float or None
        How long, s; None until Ctrl-C.
    to_stdout : bool
        One line of JSON each time instead of the live line.
    """
    start = radio.clock()
    console = Console(stderr=True)
    with radio.link as link, ending.StopRequest() as stop:
        with Live(console=console, refresh_per_second=15, transient=not to_stdout) as live:
            while not stop and (duration is None or radio.clock() - start < duration):
                report = link.report
                if to_stdout:
                    print(msgspec.json.encode(report).decode(), flush=True)
                else:
                    live.update(report_line(report))
                radio.sleep(LINE_PERIOD)
        if not to_stdout:
            console.print(report_line(link.report))
    return ending.FOUND


def report_line(report: Report) -> Text:
    """Say a report in one line."""
    age = "never" if report.age_ms == 0xFFFF else f"{report.age_ms} ms ago"
    throttle, pitch, yaw, roll = report.heard
    line = Text(no_wrap=True, overflow="ellipsis")
    line.append(f"{report.state:9s}", style="bold red" if report.state in ("armed", "holding") else "bold")
    line.append(f" frames {report.good}, bad {report.bad}, last {age}   ", style="dim")
    line.append(f"throttle {throttle:3d}  pitch {pitch:+4d}  yaw {yaw:+4d}  roll {roll:+4d}")
    line.append(f"   on the air {report.throttle_on_air:3d}   firmware {report.version}", style="dim")
    for words in report.warnings:
        line.append(f"   {words}", style="yellow")
    return line


def config(radio: Radio, changes: dict[str, object], new_id: bool, defaults: bool) -> int:
    """Show the configuration in the transmitter's memory, or change it.

    Parameters
    ----------
    radio : Radio
        The transmitter.
    changes : dict
        Fields of `Config` to change.
    new_id : bool
        Make a random id, as every transmitter should have its own.
    defaults : bool
        Begin from the defaults instead of what is stored.
    """
    with radio.link as link:
        result, old = link.read_config()
        new = msgspec.structs.replace(Config() if defaults else old, **changes)
        if new_id:
            new = msgspec.structs.replace(new, id=secrets.token_bytes(4) + new.id[4:])
        if new == old and not defaults:
            print_config(old, "nothing is stored, these are the defaults" if result == "default" else "as stored")
            return ending.FOUND
        answer = link.write_config(new)
        if answer != "stored":
            ending.say_error(f"the firmware did not take it, {answer}")
            return REFUSED
        print_config(new, "stored now")
        if new.id != old.id:
            print("The id has changed: bind again.")
    return ending.FOUND


def print_config(config: Config, title: str) -> None:
    """Print a configuration, with what each line is for."""
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
