"""The panel of what is followed: hands the page's wishes to the loop of the source (`TargetsPanel`)."""

from collections.abc import Callable

from matchset.app.live.feed import Panel
from matchset.app.live.targets.clicks import Clicks, TargetsState
from matchset.app.live.targets.messages import MESSAGES, Outline, Pick, Wish


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

    def refused(self, message: Wish, words: str) -> None:
        """Tell pages what became of a click that may not be done now; it is noted by whoever refused it."""
        if isinstance(message, Pick | Outline):
            self._clicks.turn_away(message, words)

    def state(self) -> TargetsState:
        """Return what became of the last clicks."""
        return self._clicks.state
