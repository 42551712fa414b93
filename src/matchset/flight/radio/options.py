"""The options of `matchset radio`, one class each. This module is loaded for every `matchset --help`."""

from typing import Annotated

import msgspec
import typer

Port = Annotated[str, typer.Argument(metavar="PORT", help="Its serial port: /dev/ttyUSB0, /dev/ttyACM0 or COM3.")]


MonitorDuration = Annotated[float | None, typer.Option(min=0.0, metavar="SECONDS", help="End by itself.")]


JsonLines = Annotated[bool, typer.Option("--print", help="One line of JSON each time, to stdout.")]


Arm = Annotated[bool, typer.Option("--arm", help="Let the motors turn, after a countdown.")]


Throttle = Annotated[float, typer.Option(help="How fast they turn, with --arm; at most 0.3.")]


Countdown = Annotated[int, typer.Option(metavar="SECONDS", help="Before they do, at least 3.")]


Identity = Annotated[
    str | None, typer.Option("--id", metavar="HEX", help="Four or five bytes; the fifth is a2 (X5SC, X5SW: a1).")
]


NewIdentity = Annotated[bool, typer.Option("--new-id", help="A random id: each transmitter needs its own.")]


BindChannels = Annotated[
    str | None, typer.Option(metavar="A,B", help="Fourth bind channel, two in turn: 32,9; or one: 32.")
]


Reverse = Annotated[str | None, typer.Option(metavar="AXES", help="What goes the wrong way: roll,pitch,yaw; or none.")]


Trims = Annotated[str | None, typer.Option(metavar="P,Y,R", help="Pitch, yaw, roll: -31 ... 31 each.")]


BindAtPowerOn = Annotated[bool | None, typer.Option(help="Bind whenever power comes.")]


TrimFollowsStick = Annotated[bool | None, typer.Option(help="More range, less fine.")]


Tail = Annotated[int | None, typer.Option(help="Byte 8 of a packet: 0; X5SW 1.")]


Defaults = Annotated[bool, typer.Option("--defaults", help="Begin from the defaults.")]


class BindOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options of `matchset radio bind`; each is explained where its type is defined."""

    port: Port


class MonitorOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options of `matchset radio monitor`; each is explained where its type is defined."""

    port: Port
    duration: MonitorDuration = None
    to_stdout: JsonLines = False


class StickOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options of `matchset radio test-sticks`; each is explained where its type is defined."""

    port: Port
    arm: Arm = False
    throttle: Throttle = 0.1
    countdown: Countdown = 5


class ConfigOptions(msgspec.Struct, frozen=True, kw_only=True):
    """The options of `matchset radio config`; each is explained where its type is defined."""

    port: Port
    identity: Identity = None
    new_id: NewIdentity = False
    bind_channels: BindChannels = None
    reverse: Reverse = None
    trims: Trims = None
    bind_at_power_on: BindAtPowerOn = None
    trim_follows_stick: TrimFollowsStick = None
    tail: Tail = None
    defaults: Defaults = False
