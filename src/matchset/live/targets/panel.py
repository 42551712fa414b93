"""The panel of what is followed: hands the page's wishes to the loop of the source (`TargetsPanel`)."""

from collections.abc import Callable

from matchset.live.feed import Panel
from matchset.live.targets.clicks import Clicks, TargetsState
from matchset.live.targets.messages import MESSAGES, Hold, Marker, Outline, Pick, Wish


class TargetsPanel(Panel):
    """Takes clicks and sizes.

    Parameters
    ----------
    ask : callable
        Gets each wish; does not wait.
    clicks : Clicks, optional
        What became of clicks.
    """

    name = "targets"
    messages = MESSAGES

    def __init__(self, ask: Callable[[Wish], None], clicks: Clicks | None = None) -> None:
        self._ask, self._clicks = ask, clicks or Clicks(lambda _: None)

    def take(self, message: Wish, page: str) -> None:  # noqa: ARG002
        """Hand it on."""
        self._ask(message)

    def waits(self, message: Wish) -> None:
        """Have the picture kept in which somebody clicked, since the click is answered later."""
        if isinstance(message, Pick | Outline | Marker):
            self._ask(Hold(message.sequence))

    def refused(self, message: Wish, words: str) -> None:
        """Tell pages that a click is given up."""
        if isinstance(message, Pick | Outline):
            self._clicks.turn_away(message, words)

    def state(self) -> TargetsState:
        """Return what became of the last clicks."""
        return self._clicks.state
