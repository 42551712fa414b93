"""What a page says of a flight."""

from matchset.live.wire.messages import Number, Up


class Arm(Up, frozen=True, tag="arm"):
    """Take off, and command from here on; sent when a person has held the button for a second."""


class Alive(Up, frozen=True, tag="alive"):
    """The page is in view; `sequence` is the picture that it painted last. Ten times a second, by who commands."""

    sequence: Number


class Land(Up, frozen=True, tag="land"):
    """Everybody down."""


class Kill(Up, frozen=True, tag="kill"):
    """Motors off, now."""


class Again(Up, frozen=True, tag="again"):
    """Everybody is back at the start; arms nobody."""


Order = Arm | Alive | Land | Kill | Again
MESSAGES: tuple[type[Up], ...] = (Arm, Alive, Land, Kill, Again)
