"""The stick test: whether the firmware hears every stick, and which way each moves the vehicle: `run_stick_test`.

Without `--arm` the arm switch stays low: the firmware reports what it hears, and the motors cannot turn. With it,
after a countdown, they do.
"""

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import msgspec

from matchset.app import exit_codes
from matchset.control.command import Command
from matchset.flight.kill_switch import KillSwitch
from matchset.flight.radio.connection import REFUSED, Radio

COMMAND_PERIOD = 0.033  # format: s between commands, as often as a camera delivers pictures

MOVES = (
    ("throttle", Command(throttle=0.5)),
    ("roll to the right", Command(roll=0.5)),
    ("roll to the left", Command(roll=-0.5)),
    ("pitch forward", Command(pitch=0.5)),
    ("pitch back", Command(pitch=-0.5)),
    ("yaw to the right", Command(yaw=0.5)),
    ("yaw to the left", Command(yaw=-0.5)),
)


class MotorsStopped(Exception):  # noqa: N818 - it is no error of the program
    """The motors stopped before the end of the test; says why."""


class MotorTestParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How the motors are tested.

    Parameters
    ----------
    throttle : float
        0 ... `max_throttle`. More is heard and felt better; less cannot lift the vehicle.
    countdown : int
        Time before the motors start, s, at least `min_countdown`.
    max_throttle : float
        Largest throttle that is accepted. Chosen by hand: the toy hovers near 0.5 or 0.6.
    min_countdown : int
        Shortest countdown that is accepted, s. Chosen by hand: time to take one's hands away.
    hold : float
        Time for which a stick is held, s. Chosen by hand.
    """

    throttle: float = 0.1
    countdown: int = 5
    max_throttle: float = 0.3
    min_countdown: int = 3
    hold: float = 1.0

    def __post_init__(self) -> None:
        if not 0.0 < self.throttle <= self.max_throttle:
            raise ValueError(f"--throttle must be above 0 and at most {self.max_throttle}, got {self.throttle:g}")
        if self.countdown < self.min_countdown:
            raise ValueError(f"--countdown must be at least {self.min_countdown} s, got {self.countdown}")


def run_stick_test(radio: Radio, motor_test: MotorTestParameters | None) -> int:
    """Move every stick with the motors off, then with the motors on if that is asked for.

    Parameters
    ----------
    radio : Radio
    motor_test : MotorTestParameters or None
        None: the motors stay off.

    Returns
    -------
    int
        The exit code.
    """
    with radio.link:
        if not all_heard(radio):
            exit_codes.print_error("the firmware did not hear what was sent")
            return REFUSED
        if motor_test is None:
            print("Every stick arrives. The motors stayed off; with --arm they turn, after a countdown.")
            return exit_codes.FOUND
        try:
            with KillSwitch(lambda _: radio.link.cut()) as kill:
                run_motors(radio, motor_test, kill)
        except MotorsStopped as stopped:
            radio.link.land(0)
            exit_codes.print_error(f"the motors are off: {stopped}")
            return REFUSED
        except (KeyboardInterrupt, SystemExit):  # Ctrl-C; SIGTERM and SIGHUP
            radio.link.land(0)
            raise
    return exit_codes.FOUND


class HeardMove(NamedTuple):
    """A stick that was moved with the motors off, and what the firmware heard.

    Attributes
    ----------
    name : str
        "roll to the right".
    sent, heard : int
        Of the stick that moved: throttle 0 ... 255, else -127 ... 127.
    same : bool
        Whether the firmware heard all four sticks as they were sent.
    """

    name: str
    sent: int
    heard: int
    same: bool


def heard_moves(radio: Radio, moves: Iterable[tuple[str, Command]] = MOVES) -> Iterator[HeardMove]:
    """Move one stick after the other with the arm switch low, and say what the firmware heard.

    Parameters
    ----------
    radio : Radio
    moves : iterable of (str, Command)
    """
    for name, command in moves:
        for _ in range(5):
            sent = radio.link.send_disarmed(command)
            radio.sleep(COMMAND_PERIOD)
        wanted = (round(255 * sent.throttle), *(round(127 * stick) for stick in (sent.pitch, sent.yaw, sent.roll)))
        heard = radio.link.report.heard
        moved = next((place for place, value in enumerate(wanted) if value), 0)
        yield HeardMove(name, wanted[moved], heard[moved], heard == wanted)


def all_heard(radio: Radio) -> bool:
    """Move every stick with the arm switch low, and compare what the firmware heard."""
    print(f"{'stick':20s} {'sent':>6s} {'heard':>6s}   (motors off)")
    good = True
    for name, sent, heard, same in heard_moves(radio):
        good = good and same
        print(f"{name:20s} {sent:6d} {heard:6d}   {'ok' if same else 'WRONG'}")
    return good


def run_motors(radio: Radio, motor_test: MotorTestParameters, kill: KillSwitch) -> None:
    """Count down, arm, and move every stick while the motors turn slowly.

    Raises
    ------
    MotorsStopped
        If the kill switch was used, or the link disarmed.
    """
    key = "The space key and Ctrl-C stop" if kill.reads_keys else "Ctrl-C stops"
    print(f"\nTAKE THE PROPELLERS OFF, or hold the quadcopter down. {key} the motors at any time.")
    for left in range(motor_test.countdown, 0, -1):
        print(f"  the motors start in {left} s", flush=True)
        hold(radio, kill, Command(), 1.0, armed=False)
    radio.link.arm()
    base = Command(throttle=motor_test.throttle)
    print("  all four turn alike", flush=True)
    hold(radio, kill, base, motor_test.hold)
    for name, command in MOVES[1:]:
        print(f"  {name}", flush=True)
        hold(radio, kill, msgspec.structs.replace(command, throttle=motor_test.throttle), motor_test.hold)
        hold(radio, kill, base, motor_test.hold / 2)
    radio.link.land(0)
    print("Motors off. Where a side answered the wrong way: matchset radio config PORT --reverse roll,pitch,yaw")


def hold(radio: Radio, kill: KillSwitch, command: Command, duration: float, armed: bool = True) -> None:
    """Send the same command for a time, s.

    Raises
    ------
    MotorsStopped
        If the kill switch was used, or the link, which was armed, is not any more.
    """
    end = radio.clock() + duration
    while radio.clock() < end:
        if kill.reason:  # before the first command, since `arm` begins anew
            raise MotorsStopped(kill.reason)
        if armed:
            refusal = radio.link.status().refusal
            if refusal:
                raise MotorsStopped(refusal)
            radio.link.send(command)
        else:
            radio.link.send_disarmed(command)
        radio.sleep(COMMAND_PERIOD)
