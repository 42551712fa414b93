"""`matchset radio test-sticks`: whether every stick arrives, and moves what it should.

Without `--arm` the arm switch stays low: the firmware reports what it hears, and the motors cannot turn. With it,
after a countdown, they do.
"""

import msgspec

from matchset.app import exit_codes as ending
from matchset.app.radio.connection import REFUSED, Radio
from matchset.control.command import Command

MOST_THROTTLE = 0.3
"""A test on the bench needs no more; the toy hovers near 0.5 or 0.6."""
PERIOD = 0.033  # s between commands
HOLD = 1.0  # s that a stick is held

MOVES = (
    ("throttle", Command(throttle=0.5)),
    ("roll to the right", Command(roll=0.5)),
    ("roll to the left", Command(roll=-0.5)),
    ("pitch forward", Command(pitch=0.5)),
    ("pitch back", Command(pitch=-0.5)),
    ("yaw to the right", Command(yaw=0.5)),
    ("yaw to the left", Command(yaw=-0.5)),
)


class StickOptions(msgspec.Struct, frozen=True):
    """The options of `matchset radio test-sticks`.

    Attributes
    ----------
    arm : bool
        Let the motors turn.
    throttle : float
        How fast, 0 ... 0.3: enough to spin, too little to lift off.
    countdown : int
        Seconds before they do, at least 3.
    """

    arm: bool = False
    throttle: float = 0.1
    countdown: int = 5

    def __post_init__(self) -> None:
        if not 0.0 < self.throttle <= MOST_THROTTLE:
            raise ValueError(f"--throttle must be above 0 and at most {MOST_THROTTLE}, got {self.throttle:g}")
        if self.countdown < 3:
            raise ValueError(f"--countdown must be at least 3 s, got {self.countdown}")


def try_sticks(radio: Radio, options: StickOptions) -> int:
    """Run the test; returns the exit code."""
    with radio.link:
        good = rehearse(radio)
        if not good:
            ending.say_error("the firmware did not hear what was sent")
            return REFUSED
        if not options.arm:
            print("Every stick arrives. The motors stayed off; with --arm they turn, after a countdown.")
            return ending.FOUND
        try:
            with_motors(radio, options)
        except KeyboardInterrupt:
            radio.link.land(0)
            raise
    return ending.FOUND


def rehearse(radio: Radio) -> bool:
    """Move every stick with the arm switch low, and compare what the firmware heard."""
    print(f"{'stick':20s} {'sent':>6s} {'heard':>6s}   (motors off)")
    good = True
    for name, command in MOVES:
        for _ in range(5):
            sent = radio.link.send_disarmed(command)
            radio.sleep(PERIOD)
        wanted = (round(255 * sent.throttle), *(round(127 * stick) for stick in (sent.pitch, sent.yaw, sent.roll)))
        heard = radio.link.report.heard
        moved = next((place for place, value in enumerate(wanted) if value), 0)
        same = heard == wanted
        good = good and same
        print(f"{name:20s} {wanted[moved]:6d} {heard[moved]:6d}   {'ok' if same else 'WRONG'}")
    return good


def with_motors(radio: Radio, options: StickOptions) -> None:
    """Count down, arm, and move every stick while the motors turn slowly."""
    print("\nTAKE THE PROPELLERS OFF, or hold the quadcopter down. Ctrl-C stops the motors at any time.")
    for left in range(options.countdown, 0, -1):
        print(f"  the motors start in {left} s", flush=True)
        hold(radio, Command(), 1.0, armed=False)
    radio.link.arm()
    base = Command(throttle=options.throttle)
    print("  all four turn alike", flush=True)
    hold(radio, base, HOLD)
    for name, command in MOVES[1:]:
        print(f"  {name}", flush=True)
        hold(radio, msgspec.structs.replace(command, throttle=options.throttle), HOLD)
        hold(radio, base, HOLD / 2)
    radio.link.land(0)
    print("Motors off. Where a side answered the wrong way: matchset radio config PORT --reverse roll,pitch,yaw")


def hold(radio: Radio, command: Command, duration: float, armed: bool = True) -> None:
    """Keep the sticks somewhere for a time, s."""
    end = radio.clock() + duration
    while radio.clock() < end:
        if armed:
            radio.link.send(command)
        else:
            radio.link.send_disarmed(command)
        radio.sleep(PERIOD)
