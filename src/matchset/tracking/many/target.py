"""One of several targets in one frame: `Target`."""

from typing import Any, Generic, TypeVar

import msgspec

from matchset.numeric.words import one_line, short
from matchset.tracking.track import Lost, Track

S = TypeVar("S")


class Target(msgspec.Struct, Generic[S], frozen=True):
    """One of several targets in one frame.

    Parameters
    ----------
    identity : int
        Its number, from 0 in the order in which targets were found; it is never given again.
    label : str
        The name of its color.
    track : Track or Lost
        Where it is in this frame; or why it is not seen, and where its motion would have it.
    since : float
        When it was found first, s.
    alternatives : tuple of int
        Which other targets this may be as well, after both touched. Empty while there is no doubt.
    behind : int or None
        Behind which target it is hidden, as far as that is known.
    """

    identity: int
    label: str
    track: Track[Any] | Lost[Any]
    since: float
    alternatives: tuple[int, ...] = ()
    behind: int | None = None

    @one_line
    def __repr__(self) -> str:
        others = "".join(f", or {each}" for each in self.alternatives)
        return f"Target({self.identity} {self.label!r}, since {short(self.since)} s{others}: {self.track!r})"
