"""Do the sticks arrive, each its own and the right way round, while the motors are off? `stick_check`.

An Arduino says what it heard. A flight controller behind a transmitter module shows its sticks to a person. Nothing is
armed, and the throttle stays zero.
"""

import time
from collections.abc import Callable

import msgspec

from matchset.control.command import Command
from matchset.flight.preflight.outcome import CheckOutcome, judged, skipped
from matchset.flight.preflight.parameters import PreflightParameters
from matchset.flight.preflight.person import Person
from matchset.flight.radio.connection import Radio
from matchset.flight.radio.stick_test import COMMAND_PERIOD, MOVES, heard_moves
from matchset.links.arduino.arduino_link import ArduinoLink
from matchset.links.crsf.crsf_link import CrsfLink
from matchset.links.link import Link

NAME = "sticks: arrive"
READY = (
    "Connect the flight controller's USB to Betaflight's configurator and open its Receiver tab. The motors stay off; "
    "sticks will move one after the other. Ready?"
)
SEEN = (
    "Did the bars move so: roll right (longer), roll left (shorter), pitch forward (longer), pitch back (shorter), yaw "
    "right (longer), yaw left (shorter), and no other bar meanwhile?"
)


def moved(name: str, command: Command, size: float) -> tuple[str, Command]:
    """Return a move of the stick test, made as large as is wanted, without throttle.

    Parameters
    ----------
    name : str
    command : Command
    size : float
        0 ... 1.
    """
    signs = (0 if stick == 0.0 else 1 if stick > 0.0 else -1 for stick in (command.roll, command.pitch, command.yaw))
    return name, Command(*(size * sign for sign in signs))


def stick_check(
    link: Link,
    person: Person,
    parameters: PreflightParameters,
    clock: Callable[[], float] = time.monotonic,
    sleep: Callable[[float], None] = time.sleep,
) -> CheckOutcome:
    """Move one stick after the other with the motors off.

    Parameters
    ----------
    link : Link
        Not armed.
    person : Person
        Looks at the flight controller's bars.
    parameters : PreflightParameters
    clock, sleep : callables
        The time, s, and a function that waits.

    Raises
    ------
    LinkError
        If the link is gone, or its vehicle is armed.
    """
    moves = [moved(name, command, parameters.stick) for name, command in MOVES if not command.throttle]
    if isinstance(link, ArduinoLink):
        return _heard(Radio(link, clock, sleep), moves)
    wanted = "roll, pitch and yaw move, each by itself and the right way"
    if not isinstance(link, CrsfLink):
        return skipped(NAME, wanted, "this link moves no stick while the motors are off: see its page in docs/")
    ready = person.confirm(READY)
    if ready is None:
        return skipped(NAME, wanted, "nobody was there to look: run it at a terminal, without --unattended")
    if not ready:
        return judged(NAME, wanted, "not ready", False, "connect the configurator, then begin again")
    for name, command in moves:
        person.say(f"  {name}")
        end = clock() + parameters.stick_time
        while clock() < end:
            link.send_disarmed(command)
            sleep(COMMAND_PERIOD)
        link.send_disarmed(Command())
    right = bool(person.confirm(SEEN))
    return judged(
        NAME,
        wanted,
        "as told" if right else "not as told",
        right,
        "channel map AETR1234 in the Receiver tab; a bar that moves the other way: 'rxrange' or the transmitter's "
        "setup. Do not fly",
    )


def _heard(radio: Radio, moves: list[tuple[str, Command]]) -> CheckOutcome:
    found = list(heard_moves(radio, moves))
    for _ in moves:
        radio.link.send_disarmed(Command())
        radio.sleep(COMMAND_PERIOD)
    wrong = [move for move in found if not move.same]
    words = "; ".join(f"{move.name}: sent {move.sent}, heard {move.heard}" for move in wrong)
    return judged(
        NAME,
        "the firmware hears every stick as it was sent",
        words or f"{len(found)} of {len(found)}",
        not wrong,
        "another cable or port; which way each moves the toy shows 'matchset radio test-sticks PORT --arm', "
        "propellers off",
    )


class SteadyZero(msgspec.Struct):
    """Sends zero commands at the pace of pictures, as a pilot that is not armed does.

    Parameters
    ----------
    clock, sleep : callables
        The time, s, and a function that waits.
    """

    clock: Callable[[], float] = time.monotonic
    sleep: Callable[[float], None] = time.sleep

    def send(self, link: Link, duration: float) -> int:
        """Send for a time, s; returns how many commands.

        Raises
        ------
        LinkError
            If the link is gone or silent.
        """
        end, count = self.clock() + duration, 0
        while self.clock() < end:
            link.send(Command())
            self.sleep(COMMAND_PERIOD)
            count += 1
        return count
