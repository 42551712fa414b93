"""What a flight says of its gains, kept for its report: `GainNotes`."""

import math
from collections.abc import Sequence

from matchset.control.stability.follower_loops import LOOPS
from matchset.flight.chain.pilot import PilotStep

MOST_NOTES = 100  # format: of a flight; a flight may last for hours


class GainNotes:
    """Least margins of each follower's loops, and when gains were lowered.

    Parameters
    ----------
    followers : int

    Attributes
    ----------
    lowered : list of (float, int, str)
        When, s, whose, from 0, and why, in words; the first `MOST_NOTES`.
    """

    def __init__(self, followers: int) -> None:
        self.lowered: list[tuple[float, int, str]] = []
        self._factors = [(1.0,) * len(LOOPS)] * followers
        self._least = [[(math.inf, math.inf)] * len(LOOPS) for _ in range(followers)]
        self._known = [False] * followers

    def add(self, time: float, steps: Sequence[PilotStep]) -> None:
        """Note the steps of a time."""
        for number, step in enumerate(steps):
            if step.control is None:
                continue
            gains = step.control.gains
            fell = any(now < before for now, before in zip(gains.factors, self._factors[number], strict=True))
            self._factors[number] = gains.factors
            if fell and len(self.lowered) < MOST_NOTES:
                self.lowered.append((time, number, gains.words))
            least = self._least[number]
            for k, margins in enumerate(gains.margins):
                if margins is not None:
                    self._known[number] = True
                    least[k] = min(least[k][0], margins[0]), min(least[k][1], margins[1])

    def margins_text(self, number: int) -> str:
        """Write a follower's least margins: ``level 14.5 dB, 48°; yaw 44.8 dB, 78°``; ``-`` if none are known."""
        parts = [
            f"{name} " + ", ".join(filter(None, (_text(gain, ".1f", " dB"), _text(phase, ".0f", "°"))))
            for name, (gain, phase) in zip(LOOPS, self._least[number], strict=True)
            if math.isfinite(gain) or math.isfinite(phase)
        ]
        return "; ".join(parts) if self._known[number] else "-"

    def lines(self) -> list[str]:
        """Say when gains were lowered: ``12.7 s: vehicle 1: swings to the side: gains lowered to 70 %``."""
        return [f"{time:.1f} s: vehicle {number + 1}: {words}" for time, number, words in self.lowered]


def _text(value: float, form: str, unit: str) -> str:
    return f"{value:{form}}{unit}" if math.isfinite(value) else ""
