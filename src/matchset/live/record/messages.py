"""What a page says of recording."""

from matchset.live.wire.messages import PageMessage


class Record(PageMessage, frozen=True, tag="record"):
    """Begin to record, or end it; again does no harm."""

    on: bool


MESSAGES: tuple[type[PageMessage], ...] = (Record,)
