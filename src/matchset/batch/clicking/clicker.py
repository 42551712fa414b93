"""Who is asked where it is doubtful what the ball is: a person at a page, or nobody (`Clicker`, `NOBODY`)."""

from typing import Protocol

import msgspec

from matchset.batch.jobs.job import VideoOutcome


class Click(msgspec.Struct, frozen=True):
    """A click in a video.

    Parameters
    ----------
    video, folder : str
        Its whole name, and that in the results.
    pick : str
        X,Y@FRAME.
    """

    video: str
    folder: str
    pick: str


class Clicker(Protocol):
    """Is asked, and answers later."""

    @property
    def waits(self) -> bool:
        """Whether an answer may still come."""
        ...

    def ask(self, outcome: VideoOutcome) -> None:
        """Ask where the ball is."""
        ...

    def clicks(self) -> list[Click]:
        """Return the answers since this was asked last."""
        ...

    def close(self) -> None:
        """Ask no more."""
        ...


class NoClicker:
    """NoClicker is there to be asked."""

    waits = False

    def ask(self, outcome: VideoOutcome) -> None:
        """See `Clicker`."""

    def clicks(self) -> list[Click]:
        """See `Clicker`."""
        return []

    def close(self) -> None:
        """See `Clicker`."""
