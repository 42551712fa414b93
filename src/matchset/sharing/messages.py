"""What partners send to each other, in msgpack: names and fields are the format; `read_targets`, `read_clock`.

A pose has the fields that it has in a recording, numbers of an outline are named as in `tracks.csv`. All times are on
the clock of the sender (`Clock`); whoever receives them measures how that clock stands to the own one.
"""

from typing import Annotated, Any, TypeVar

import msgspec

from matchset.localization.pose import Observed

FORMAT = 1  # format: version of the messages; every one carries it, and another one is refused
MOST_BYTES = 65_536  # format: of a message; a longer one is refused unread
MOST_TARGETS = 64  # format: of a message, and of partners whose clocks it tells
MOST_NUMBERS = 32  # format: of an outline
LONGEST_NAME = 64  # format: characters
LONGEST_ERROR = 200  # format: characters of what is wrong with a message, which quotes it
LARGEST = 1e12  # format: of any number; it refuses infinities and NaN, too
ENCODING = f"application/msgpack;matchset.sharing/{FORMAT}"

# format: what may stand in a message
Number = Annotated[float, msgspec.Meta(ge=-LARGEST, le=LARGEST)]
Positive = Annotated[float, msgspec.Meta(ge=0.0, le=LARGEST)]
Word = Annotated[str, msgspec.Meta(min_length=1, max_length=LONGEST_NAME)]
Words = Annotated[str, msgspec.Meta(max_length=200)]
Count = Annotated[int, msgspec.Meta(ge=0, le=2**62)]
Triple = tuple[Number, Number, Number]
Row = tuple[Number, Number, Number, Number, Number, Number]
Rotation = tuple[Triple, Triple, Triple]
Covariance = tuple[Row, Row, Row, Row, Row, Row]

M = TypeVar("M")


class PoseMessage(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """A pose, with the fields of `Pose`, as a recording has it."""

    position: Triple
    rotation_matrix: Rotation | None
    covariance: Covariance
    observed: Observed
    time: Number
    systematic_covariance: Covariance | None = None


class TrackMessage(msgspec.Struct, frozen=True, kw_only=True):
    """An outline in the picture of the sender.

    Parameters
    ----------
    shape : str
        Family: ``Circle``.
    values : dict of str to float
        Its parameters, px and rad, named as in `tracks.csv`.
    stds : dict of str to float
        Their standard deviations, as far as they are finite.
    support : float
        As `Track.support`.
    """

    shape: Word
    values: Annotated[dict[Word, Number], msgspec.Meta(max_length=MOST_NUMBERS)]
    stds: Annotated[dict[Word, Positive], msgspec.Meta(max_length=MOST_NUMBERS)]
    support: Number


class TargetMessage(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """A target in the newest picture of a camera of the sender.

    Parameters
    ----------
    name : str
        One name for one target of the sender.
    captured : float
        When the picture was taken, s on the clock of the sender.
    identity : int
        As `Target.identity`; 0 where there is one target of this name.
    track : TrackMessage or None
    pose : PoseMessage or None
    lost : str
        Why it is not seen; empty if it is.
    """

    name: Word
    captured: Number
    identity: Count = 0
    track: TrackMessage | None = None
    pose: PoseMessage | None = None
    lost: Words = ""


class OffsetMessage(msgspec.Struct, frozen=True, kw_only=True):
    """How the clock of a partner stands to that of the sender, as the sender has measured it.

    Parameters
    ----------
    partner : str
    run : int
        Of the partner's program.
    offset : float
        Clock of the sender minus clock of the partner, s.
    uncertainty : float
        The offset is off by no more, s.
    """

    partner: Word
    run: Count
    offset: Number
    uncertainty: Positive


class TargetsMessage(msgspec.Struct, frozen=True, kw_only=True):
    """All targets in the newest pictures of the sender.

    Parameters
    ----------
    format : int
    name : str
        Of the sender.
    run : int
        A number that the sender's program drew when it began: another one began anew.
    number : int
        Counts the messages of a run, from 0.
    sent : float
        When the message was made, s on the clock of the sender.
    offsets : list of OffsetMessage
    targets : list of TargetMessage
    """

    format: int
    name: Word
    run: Count
    number: Count
    sent: Number
    offsets: Annotated[list[OffsetMessage], msgspec.Meta(max_length=MOST_TARGETS)]
    targets: Annotated[list[TargetMessage], msgspec.Meta(max_length=MOST_TARGETS)]


class ClockMessage(msgspec.Struct, frozen=True, kw_only=True):
    """The answer to who asks for the time.

    Parameters
    ----------
    format : int
    name : str
    run : int
        As in `TargetsMessage`.
    received, answered : float
        When the question came and the answer left, s on the clock of who answers.
    wall : float
        What time it is there, s since 1970, UTC.
    """

    format: int
    name: Word
    run: Count
    received: Number
    answered: Number
    wall: Number


class _Version(msgspec.Struct, frozen=True):
    """What every version of the messages has."""

    format: int


_ENCODER = msgspec.msgpack.Encoder()
_VERSION = msgspec.msgpack.Decoder(_Version)
_TARGETS = msgspec.msgpack.Decoder(TargetsMessage)
_CLOCK = msgspec.msgpack.Decoder(ClockMessage)


class ForeignMessageError(ValueError):
    """What came is no message of this version: of another one, of another program, or damaged."""


def written(message: TargetsMessage | ClockMessage) -> bytes:
    """Encode a message as msgpack."""
    return _ENCODER.encode(message)


def read_targets(data: bytes | None) -> TargetsMessage:
    """Decode a message with targets; None is one that was too long to be taken.

    Raises
    ------
    ForeignMessageError
        Whatever else the bytes are; its text says what, and names no partner.
    """
    return _read(data, _TARGETS)


def read_clock(data: bytes) -> ClockMessage:
    """Decode an answer to who asks for the time; raises as `read_targets`."""
    return _read(data, _CLOCK)


def _read(data: bytes | None, decoder: "msgspec.msgpack.Decoder[M]") -> M:
    if data is None or len(data) > MOST_BYTES:
        raise ForeignMessageError(f"sends more than {MOST_BYTES} bytes at once")
    try:
        version = _VERSION.decode(data).format
    except (msgspec.DecodeError, ValueError, RecursionError):
        raise ForeignMessageError("sends what is no message of matchset") from None
    if version != FORMAT:
        newer = "this computer's" if version > FORMAT else "its"
        raise ForeignMessageError(f"sends messages of version {version}, this is {FORMAT}: {newer} matchset is older")
    try:
        return decoder.decode(data)
    except (msgspec.DecodeError, ValueError, RecursionError) as error:
        raise ForeignMessageError(f"sends a damaged message: {str(error)[:LONGEST_ERROR]}") from None


def schema() -> dict[str, Any]:
    """Return the JSON Schema of a message with targets, for programs that are not matchset."""
    return msgspec.json.schema(TargetsMessage)
