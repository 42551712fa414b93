"""The numbers of the link through a transmitter module, and its URI: `CrsfParameters`, `parse_uri`."""

from urllib.parse import parse_qsl

import msgspec

from matchset.numeric.arguments import require_positive, require_within

SCHEME = "crsf://"


class CrsfParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Parameters of the link; in a URI they follow a question mark: ``crsf:///dev/ttyUSB0?baud=400000&arm_channel=5``.

    Parameters
    ----------
    baud : int
        Bits per second of the port. A module tries its rates in turn until it understands frames. By the manual of
        ExpressLRS: 921600 for the USB socket of a module, 400000 for its bay connector and for mLRS.
    rate : float
        Channel frames per second until the module says its own rate. More is fresher, less costs fewer processor
        cycles. The rate of radios at 400000 baud.
    arm_channel : int
        Channel of the arm switch, 5 ... 16. ExpressLRS transmits the fifth without delay, as one bit.
    receiver : int or None
        Number of the receiver, 0 ... 63, for one whose model match is on: it obeys a module with its number only. None
        leaves the module's own.
    hold_after, cut_after : float
        Silence of the caller after which the sticks become neutral, and after which the motors are stopped, s. Longer
        survives longer pauses of the program; shorter flies less by an old command. Those of the firmware
        ``syma_transmitter``.
    disarm_time : float
        How long frames with the arm switch low are sent after that; then nothing is sent, so that the failsafe of the
        receiver acts too, s. Also how long they are sent at the end of a landing. Derived: 125 frames, of which one
        must arrive.
    timeout : float
        Longest time without a frame from the module, s; then the link is broken. ExpressLRS sends one every 0.2 s.
    startup_timeout : float
        How long a module may take to understand the baud rate, s. ExpressLRS tries seven, one second each.
    vehicle_timeout : float
        Longest time without news of the vehicle while armed, s; then the link is broken, and lands. Shorter notices
        earlier, and fails with rare telemetry. inf for receivers without telemetry: then nothing says that the vehicle
        is lost. ExpressLRS reports its link statistics every 0.32 s.
    arm_low_time : float
        How long the arm switch is low before it goes high, s: a flight controller wants to have seen it. Chosen by
        hand.
    arm_timeout : float
        How long the flight controller may take to arm or to disarm, s. Its mode is repeated about once a second, less
        often by slow telemetry. Chosen by hand.
    poll_period : float
        Time between looks while waiting, s, and of the commands of a landing. Chosen by hand, far below `hold_after`.
    alike : int
        Messages in a row, 1 or more, that must say in flight that the motors are off until it is believed: one frame in
        256 damaged ones has a good checksum.
    shortest, longest : float
        Limits of the time between frames, s: a module that wants them more often gets every second or third.
        Derived: a thread of Python keeps 2 ms; the slowest rate of ExpressLRS has 40 ms.
    step : float
        Largest change of the time between two frames, as a share, by which the module's timing is followed, 0 ... 1.
        More follows faster, less disturbs the rate less. Chosen by hand; `test_frame_timer` shows a change.
    poor_quality : int
        Link quality below which `LinkStatus.warnings` says it, percent. Chosen by hand: betaflight's own alarm is 80.
    """

    baud: int = 921_600
    rate: float = 250.0
    arm_channel: int = 5
    receiver: int | None = None
    hold_after: float = 0.1
    cut_after: float = 0.24
    disarm_time: float = 0.5
    timeout: float = 1.0
    startup_timeout: float = 9.0
    vehicle_timeout: float = 2.0
    arm_low_time: float = 0.3
    arm_timeout: float = 4.0
    poll_period: float = 0.01
    alike: int = 2
    shortest: float = 0.002
    longest: float = 0.04
    step: float = 0.1
    poor_quality: int = 70

    def __post_init__(self) -> None:
        limits = {"baud": (9600, 6_000_000), "rate": (25.0, 500.0), "arm_channel": (5, 16), "alike": (1, 100)}
        require_within(self, limits | {"step": (0.0, 1.0), "poor_quality": (0, 100)})
        if self.receiver is not None:
            require_within(self, {"receiver": (0, 63)})
        times = "hold_after", "disarm_time", "timeout", "startup_timeout", "arm_low_time", "poll_period"
        require_positive(self, times)
        for name, less in (("cut_after", "hold_after"), ("vehicle_timeout", "cut_after"), ("longest", "shortest")):
            if not getattr(self, name) > getattr(self, less) > 0.0:
                raise ValueError(f"{name} must be more than {less}, got {getattr(self, name)}")
        if not self.arm_timeout > self.arm_low_time:
            raise ValueError(f"arm_timeout must be more than arm_low_time, got {self.arm_timeout}")


def parse_uri(uri: str) -> tuple[str, CrsfParameters]:
    """Read a URI; returns the path of the port and the parameters.

    Raises
    ------
    ValueError
        If it is no such URI, or a parameter is unknown or out of range; with its name.
    """
    path, _, query = uri.removeprefix(SCHEME).partition("?")
    if not uri.startswith(SCHEME) or not path:
        raise ValueError(f"a transmitter module is named like crsf:///dev/ttyUSB0?baud=921600, got {uri!r}")
    try:
        pairs = dict(parse_qsl(query, keep_blank_values=True, strict_parsing=bool(query)))
        return path, msgspec.convert(pairs, CrsfParameters, strict=False)
    except (msgspec.ValidationError, ValueError) as error:
        raise ValueError(f"{uri}: {error}") from None
