"""What a page says of sources: keys of the menu, and addresses of streams; it cannot open a path."""

from typing import Annotated, ClassVar

import msgspec

from matchset.live.wire.messages import Name, PageMessage


class Show(PageMessage, frozen=True, tag="show"):
    """Show the source of this key in the menu."""

    replaces: ClassVar[bool] = True
    key: Name


class ShowAddress(PageMessage, frozen=True, tag="show_address"):
    """Show the stream of this URL; over /ws alone."""

    replaces: ClassVar[bool] = True
    url: Annotated[str, msgspec.Meta(min_length=1, max_length=2000)]


class LookAgain(PageMessage, frozen=True, tag="look_again"):
    """Look again which cameras and files there are."""


MESSAGES: tuple[type[PageMessage], ...] = (Show, ShowAddress, LookAgain)
