"""What became of each click, so that a page ends the ring that it drew where one clicked: `Clicks`."""

from collections import deque
from collections.abc import Callable

import msgspec

from matchset.live.targets.messages import Begin, Pick

KEPT = 16  # format: answers that are told; a page hears of each within two tenths of a second
AGAIN = "Click on its middle, or draw along its rim"
NEWER = "given up for the next click"
CROWDED = "too many clicks at once: some were left out"


class ClickAnswer(msgspec.Struct, frozen=True, omit_defaults=True):
    """What became of a click.

    Parameters
    ----------
    sequence : int
        Number of the picture in which it was.
    x, y : float
        Where, px; of a drawn line its first point.
    words : str
        Why nothing is followed; empty: what was clicked is followed.
    click : int
        The number that the page gave it, by which it is told from others at the same place; 0: none.
    """

    sequence: int
    x: float
    y: float
    words: str = ""
    click: int = 0


class TargetsState(msgspec.Struct, frozen=True, omit_defaults=True):
    """The clicks that were answered last.

    Parameters
    ----------
    answered : list of ClickAnswer
        The newest last.
    """

    answered: list[ClickAnswer] = []


class Clicks:
    """Remembers what became of clicks; any thread may ask and answer.

    Parameters
    ----------
    note : callable
        Told why a click was refused.
    """

    def __init__(self, note: Callable[[str], None]) -> None:
        self._note = note
        self._answers: deque[ClickAnswer] = deque(maxlen=KEPT)
        self.state = TargetsState()

    def accept(self, begin: Begin) -> None:
        """Say that what was clicked is followed."""
        self._answer(begin, "")

    def refuse(self, begin: Begin, words: str) -> None:
        """Say why nothing is followed."""
        self._note(words)
        self._answer(begin, words)

    def turn_away(self, begin: Begin, words: str) -> None:
        """Say why nothing is followed, without a note: there is one already, or a newer click has taken its place."""
        self._answer(begin, words)

    def leave_out(self, wish: object) -> None:
        """Say that too much was asked for at once, and that this was not done; of a click its page hears."""
        self._note(CROWDED)
        if isinstance(wish, Begin):
            self._answer(wish, CROWDED)

    def _answer(self, begin: Begin, words: str) -> None:
        x, y = (begin.x, begin.y) if isinstance(begin, Pick) else begin.points[:2]
        self._answers.append(ClickAnswer(begin.sequence, x, y, words, begin.click))
        self.state = TargetsState(list(self._answers))
