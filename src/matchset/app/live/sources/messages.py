"""What a page says of sources. They are named by keys of the menu alone: a page cannot open a path or an address."""

from typing import ClassVar

from matchset.app.live.wire.messages import Name, Up


class Show(Up, frozen=True, tag="show"):
    """Show the source of this key in the menu."""

    replaces: ClassVar[bool] = True
    key: Name


class LookAgain(Up, frozen=True, tag="look_again"):
    """Look again which cameras and files there are."""


MESSAGES: tuple[type[Up], ...] = (Show, LookAgain)
