"""A flight that tells others what its followers see: `SharedFlight`. Nobody flies by what they tell: docs/safety.md."""

from collections.abc import Callable
from typing import TYPE_CHECKING

from matchset.flight.chain.chain_step import ChainStep
from matchset.media.closing import Closing

if TYPE_CHECKING:
    from matchset.sharing.sent_targets import Shareable
    from matchset.sharing.share import Share


class SharedFlight(Closing):
    """Publishes ball and pose of every follower, and says who comes, goes or cannot be read.

    One follower sees "ball"; of several the first sees "ball 1".

    Parameters
    ----------
    share : Share or None
        Closed at the end; None: nothing is shared.
    say : callable
        Told each line.
    lines : int
        Lines that are said in a step; the rest waits for the next one. More says sooner what happens to many, less
        takes less time from a step: a line may wait for a terminal. Chosen by hand.
    """

    def __init__(self, share: "Share | None", say: Callable[[str], None], lines: int = 2) -> None:
        self._share, self._say, self._most = share, say, lines
        self._news = list[str]()
        self._found, self._times = dict[str, "Shareable"](), dict[str, float]()
        self._refused = False

    def add(self, chain_step: ChainStep) -> None:
        """Publish what was found in the pictures of a step; nothing that comes of it ends a flight."""
        if self._share is None:
            return
        several = len(chain_step.steps) > 1
        for number, step in enumerate(chain_step.steps, 1):
            if step.frame is not None:
                name = f"ball {number}" if several else "ball"
                self._found[name], self._times[name] = (step.ball, step.pose), step.frame.time
        try:
            self._share.publish(self._found, self._times, max(step.now for step in chain_step.steps))
        except (ValueError, TypeError) as error:  # such as a number that is too large to be told
            if not self._refused:
                self._refused = True
                self._say(f"not shared: {error}")
        self._news += self._share.news()
        self._tell(self._most)

    def close(self) -> None:
        """Say what came from each partner, and share nothing more."""
        if self._share is not None:
            self._news += self._share.news()
            self._tell(len(self._news))
            for each in self._share.partners():
                self._say(f"shared with {each.summary}")
            self._share.close()

    def _tell(self, count: int) -> None:
        """Say so many of the lines that wait."""
        for line in self._news[:count]:
            self._say(f"shared with {line}")
        del self._news[:count]
