"""What a page says: the common part of all messages, and how they are read. Each panel has its own in `MESSAGES`."""

import enum
from collections.abc import Iterable
from typing import Annotated, Any, ClassVar, Union

import msgspec

Px = Annotated[float, msgspec.Meta(ge=-1e5, le=1e5)]
Positive = Annotated[float, msgspec.Meta(gt=0.0, le=1e5)]
Name = Annotated[str, msgspec.Meta(min_length=1, max_length=60)]
Number = Annotated[int, msgspec.Meta(ge=0, le=2**31)]
LONGEST = 4096  # format: bytes of a message from a page; all real ones have less than 300


class Kernels(enum.IntEnum):
    """Which compiled code a message needs: none, that of circles, or that of other shapes and markers as well."""

    NONE = 0
    CIRCLE = 1
    ALL = 2


class PageMessage(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag_field="type"):
    """A message of a page.

    Attributes
    ----------
    replaces : bool
        Whether something else is shown after it: not while somebody flies.
    """

    replaces: ClassVar[bool] = False

    @property
    def needs(self) -> Kernels:
        """What must have been compiled before it can be done."""
        return Kernels.NONE


class Ack(PageMessage, frozen=True, tag="ack"):
    """A picture of a stream was painted."""

    sequence: Number
    stream: Number = 0


class PageMessageReader:
    """Reads the messages of a page.

    Parameters
    ----------
    types : iterable of types
        Those that there are.

    Attributes
    ----------
    types : tuple of types
    """

    def __init__(self, types: Iterable[type[PageMessage]]) -> None:
        self.types = tuple(types)
        self._decoder: msgspec.json.Decoder[Any] = msgspec.json.Decoder(Union[self.types])  # noqa: UP007

    def read(self, data: str | bytes) -> PageMessage:
        """Read a message.

        Raises
        ------
        ValueError
            If it is none; says what is wrong with it.
        """
        if len(data) > LONGEST:
            raise ValueError(f"a message has {LONGEST} bytes at most, got {len(data)}")
        try:
            message: PageMessage = self._decoder.decode(data)
        except (msgspec.DecodeError, UnicodeEncodeError, RecursionError) as error:
            raise ValueError(f"no message of the page: {error}") from None
        return message
