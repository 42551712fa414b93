"""The panel of what is followed: hands the page's wishes to the loop of the source (`TargetsPanel`)."""

from collections.abc import Callable

from matchset.app.live.feed import Panel
from matchset.app.live.targets.messages import MESSAGES, Wish


class TargetsPanel(Panel):
    """Takes clicks and sizes.

    Parameters
    ----------
    ask : callable
        Gets each wish; does not wait.
    """

    name = "targets"
    messages = MESSAGES

    def __init__(self, ask: Callable[[Wish], None]) -> None:
        self._ask = ask

    def take(self, message: Wish, page: str) -> None:  # noqa: ARG002
        """Hand it on."""
        self._ask(message)
