"""What a page says of recording."""

from matchset.live.wire.messages import Up


class Record(Up, frozen=True, tag="record"):
    """Begin to record, or end it; again does no harm."""

    on: bool


MESSAGES: tuple[type[Up], ...] = (Record,)
