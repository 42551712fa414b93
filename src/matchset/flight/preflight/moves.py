"""A person moves the vehicle by hand: does it answer the right way? `Move`, `MOVES`, `StickWatch`.

A camera that is upside down, a mirrored picture, a wrong mount or a marker on the wrong side show here and nowhere else
before the first flight.
"""

from typing import Literal

import msgspec
import numpy as np

from matchset.flight.preflight.outcome import CheckOutcome, judged, skipped
from matchset.flight.preflight.parameters import PreflightParameters
from matchset.flight.preflight.would_be import WouldBe

Stick = Literal["roll", "pitch", "yaw", "throttle"]


class Move(msgspec.Struct, frozen=True):
    """What a person does, and which stick must answer, toward plus.

    Parameters
    ----------
    words : str
    stick : str
    answer : str
        What it would do in the air.
    """

    words: str
    stick: Stick
    answer: str

    @property
    def name(self) -> str:
        """Name of the check."""
        return f"signs: {self.stick}"

    @property
    def wanted(self) -> str:
        """What must be seen."""
        return f"{self.words.lower()}: it would {self.answer}"


MOVES = (
    Move("Move the vehicle 30 cm to its left, without turning it", "roll", "fly to the right, roll +"),
    Move("Move it 30 cm back, away from the ball", "pitch", "fly forward, pitch +"),
    Move("Lower it by 20 cm", "throttle", "climb, throttle +"),
    Move("Turn it 20 degrees to its left, so that the ball is to the right", "yaw", "turn to the right, yaw +"),
)


class StickWatch(msgspec.Struct):
    """Watches one stick from where it was at rest.

    Parameters
    ----------
    move : Move
    rest : float
        The stick before the move.
    parameters : PreflightParameters

    Attributes
    ----------
    ready : bool
        Whether it was at rest since this began: what comes after counts.
    change : float
        By how much the stick has gone, mean of the last steps.
    """

    move: Move
    rest: float
    parameters: PreflightParameters
    ready: bool = False
    change: float = 0.0
    values: list[float] = []

    def add(self, sticks: WouldBe) -> bool:
        """Note the sticks of a step; returns whether the move has been seen, one way or the other."""
        last, least = self.parameters.move_steps, self.parameters.move_stick
        self.values = [*self.values, getattr(sticks, self.move.stick) - self.rest][-last:]
        self.change = float(np.mean(self.values))
        far = [abs(value) for value in self.values]
        if len(far) < last:
            return False
        self.ready = self.ready or max(far) < least / 2.0
        return self.ready and min(far) >= least

    @property
    def outcome(self) -> CheckOutcome:
        """What was seen so far."""
        move, least = self.move, self.parameters.move_stick
        right, wrong = self.ready and self.change >= least, self.ready and self.change <= -least
        advice = (
            "IT WOULD FLY AWAY. Is the camera upside down or the picture mirrored, the marker on another side, the "
            "mount as [flight.pilot.follower.mount] says?"
            if wrong
            else "put it back to its set place, then move it farther, the ball and its marker in the picture"
        )
        return judged(move.name, move.wanted, f"{move.stick} {self.change:+.2f}", right, advice)


def skipped_moves(why: str) -> list[CheckOutcome]:
    """Return the checks of all moves, not made.

    Parameters
    ----------
    why : str
    """
    return [skipped(move.name, move.wanted, why) for move in MOVES]
