"""A picture and what is known of it as one binary message: `pack`, `unpack`.

Little-endian: u32 sequence, u32 flags, f64 time of capture in s, f64 age of the picture that this viewer
saw last in s (negative: none yet), u32 length of the JSON, the JSON, the JPEG. The flags: bit 0, there is a picture;
bit 1, the JSON is that of the session (`SessionState`) and nothing is acknowledged; bits 8 to 15, number of the stream;
bits 16 to 31, another number whenever something else is shown: the pictures of each begin at their own numbers.
"""

import struct
from typing import NamedTuple

HEADER = struct.Struct("<IIddI")
HAS_PICTURE = 1  # format: bit of the flags; without it the picture on the screen stays
OF_SESSION = 2  # format: bit of the flags
STREAM = 8  # format: first bit of the stream's number
STREAMS = 256  # format: numbers that fit
FEED, FEEDS = 16, 65536  # format: first bit of the number of what is shown, numbers that fit


class Packet(NamedTuple):
    """One message to a viewer.

    Attributes
    ----------
    sequence : int
        Number of the picture; what a viewer acknowledges, and what a click names.
    time : float
        When the picture was captured, s, on the clock of the server.
    shown_age : float
        From the capture of the picture that this viewer acknowledged last to that acknowledgment, s; negative if there
        is none. No clock of the browser is needed for it, and the picture on the screen was not older when it came.
    state : bytes
        JSON of a `matchset.live.wire.state.State`, or of a `SessionState`.
    picture : bytes
        JPEG; empty if there is none.
    stream : int
        Of which camera, 0 ... 255.
    session : bool
        Whether the JSON is that of the session.
    feed : int
        Of what is shown, 0 ... 65535.
    """

    sequence: int
    time: float
    shown_age: float
    state: bytes
    picture: bytes = b""
    stream: int = 0
    session: bool = False
    feed: int = 0


def pack(packet: Packet) -> bytes:
    """Write a packet as bytes."""
    flags = (HAS_PICTURE if packet.picture else 0) | (OF_SESSION if packet.session else 0)
    flags |= packet.stream << STREAM | packet.feed << FEED
    header = HEADER.pack(packet.sequence, flags, packet.time, packet.shown_age, len(packet.state))
    return header + packet.state + packet.picture


def unpack(data: bytes) -> Packet:
    """Read a packet.

    Raises
    ------
    ValueError
        If the bytes are no packet.
    """
    if len(data) < HEADER.size:
        raise ValueError(f"a packet has {HEADER.size} bytes or more, got {len(data)}")
    sequence, flags, time, shown_age, length = HEADER.unpack_from(data)
    state, picture = data[HEADER.size : HEADER.size + length], data[HEADER.size + length :]
    if len(state) != length or bool(flags & HAS_PICTURE) != bool(picture):
        raise ValueError(f"a packet of {len(data)} bytes does not hold what its header says")
    stream, feed = flags >> STREAM & STREAMS - 1, flags >> FEED & FEEDS - 1
    return Packet(sequence, time, shown_age, state, picture, stream, bool(flags & OF_SESSION), feed)
