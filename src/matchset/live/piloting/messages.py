"""What a page says of a flight."""

from matchset.live.wire.messages import Number, PageMessage


class Arm(PageMessage, frozen=True, tag="arm"):
    """Take off, and command from here on; sent when a person has held the button for a second."""


class Alive(PageMessage, frozen=True, tag="alive"):
    """The page is in view; `sequence` is the picture that it painted last. Ten times a second, by who commands."""

    sequence: Number


class Land(PageMessage, frozen=True, tag="land"):
    """Everybody down."""


class Kill(PageMessage, frozen=True, tag="kill"):
    """Motors off, now."""


class BackToStart(PageMessage, frozen=True, tag="again"):
    """Everybody is back at the start; arms nobody."""


Order = Arm | Alive | Land | Kill | BackToStart
MESSAGES: tuple[type[PageMessage], ...] = (Arm, Alive, Land, Kill, BackToStart)
