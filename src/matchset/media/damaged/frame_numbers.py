"""Pictures of H.264 that are missing as a whole, by the numbers of the others: `FrameNumbers`.

A decoder says nothing of them: it makes the next picture from the one before. Some encoders make no key pictures, but a
part of each picture anew; a recovery point says after how many pictures all is new. Layouts: ITU-T H.264, 7.3.2.1,
7.3.2.3, 7.3.3 and D.1.8.
"""

import itertools
from collections.abc import Iterator

START = b"\0\0\1"  # format: before every unit
SLICE, KEY_SLICE, INFORMATION, PARAMETERS = 1, 5, 6, 7  # format: kinds of units
RECOVERY_POINT, MORE = 6, 255  # format: a kind of information; a byte after which its kind or length goes on
HIGH = (44, 83, 86, 100, 110, 118, 122, 128, 134, 135, 138, 139, 244)  # format: profiles whose parameters are longer
LONGEST_PARAMETERS, LONGEST_HEADER = 512, 32  # format: bytes within which all stands that is read
ESCAPED, PLAIN = b"\0\0\3", b"\0\0"  # format: a byte that is put between zeros
MOST_FRAMES = 256  # format: in the cycle of the order of pictures


class Bits:
    """Reads bits, the highest of a byte first; ValueError at the end."""

    def __init__(self, data: bytes) -> None:
        plain = data.replace(ESCAPED, PLAIN)
        self._value, self._left = int.from_bytes(plain), 8 * len(plain)

    def number(self, count: int) -> int:
        """Next number of a count of bits."""
        if count > self._left:
            raise ValueError("a unit of H.264 ends too early")
        self._left -= count
        return (self._value >> self._left) & ((1 << count) - 1)

    def golomb(self) -> int:
        """Next number in Exp-Golomb code."""
        zeros = 0
        while not self.number(1):
            zeros += 1
        return (1 << zeros) - 1 + self.number(zeros)

    def signed_golomb(self) -> int:
        """Next number with a sign, in the same code."""
        code = self.golomb()
        return (code + 1) // 2 if code % 2 else -code // 2


class FrameNumbers:
    """Follows the numbers of the pictures of a video.

    Parameters
    ----------
    headers : bytes
        What stands before the first picture, if it is known: of a stream, what its server says of it.

    Attributes
    ----------
    refresh_begins, refresh_ends : bool
        Whether from the picture of the last packet on all is made anew, piece by piece; whether in it all is new.
    """

    def __init__(self, headers: bytes = b"") -> None:
        self._bits, self._planes, self._gaps_allowed, self._before = 0, False, False, -1
        self._left: int | None = None  # pictures until all is new
        self.is_gap(headers)

    def is_gap(self, data: bytes) -> bool:
        """Whether a picture is missing before that of a packet, of which pictures after it may be made.

        Parameters
        ----------
        data : bytes
            Units, each with its start code; others are not looked at.
        """
        gap, begins, some = False, None, False
        for kind, referred, unit in _units(data):
            try:
                if kind == PARAMETERS:
                    self._read_parameters(Bits(unit[:LONGEST_PARAMETERS]))
                elif kind in (SLICE, KEY_SLICE) and self._bits:
                    gap |= self._is_gap(Bits(unit[:LONGEST_HEADER]), kind == KEY_SLICE, referred)
                    some |= referred
                elif kind == INFORMATION and begins is None:
                    begins = _recovery(unit)
            except ValueError:  # damaged: the decoder says so
                continue
        self._count(gap, begins, some)
        return gap

    def _count(self, gap: bool, begins: int | None, some: bool) -> None:
        """Count the pictures until all is new; a recovery point within a refresh that goes on says nothing new."""
        if gap:
            self._left = None
        elif some and self._left is not None:
            self._left -= 1
        self.refresh_ends = self._left == 0
        if self.refresh_ends:
            self._left = None
        self.refresh_begins = bool(begins) and self._left is None  # 0: the decoder calls that a key picture
        if self.refresh_begins:
            self._left = begins

    def _is_gap(self, bits: Bits, key: bool, referred: bool) -> bool:
        for _ in range(3):  # first macroblock, kind of the slice, its parameters
            bits.golomb()
        if self._planes:
            bits.number(2)
        number, before = bits.number(self._bits), self._before
        if referred:
            self._before = number
        expected = (before, (before + 1) % (1 << self._bits))
        return not key and before >= 0 and not self._gaps_allowed and number not in expected

    def _read_parameters(self, bits: Bits) -> None:
        profile = bits.number(8)
        bits.number(16)
        bits.golomb()
        planes = False
        if profile in HIGH:
            chroma = bits.golomb()
            planes = chroma == 3 and bits.number(1) == 1
            for _ in range(2):
                bits.golomb()
            bits.number(1)
            if bits.number(1):
                _pass_scaling(bits, 12 if chroma == 3 else 8)
        size = bits.golomb() + 4
        _pass_order(bits)
        bits.golomb()  # how many pictures are kept
        self._gaps_allowed, self._planes, self._bits = bits.number(1) == 1, planes, size


def _recovery(unit: bytes) -> int | None:
    """Return after how many pictures all is new; None if a unit of information does not say, ValueError at its end."""
    data = iter(unit.replace(ESCAPED, PLAIN))
    while (kind := _more(data)) != RECOVERY_POINT:
        length = _more(data)
        if kind is None or length is None:
            return None
        for _ in range(length):
            next(data, None)
    length = _more(data) or 0
    return Bits(bytes(itertools.islice(data, length))).golomb()


def _more(data: Iterator[int]) -> int | None:
    """Return a kind or a length of information, which may take several bytes; None at the end."""
    total = 0
    for byte in data:
        total += byte
        if byte != MORE:
            return total
    return None


def _pass_scaling(bits: Bits, count: int) -> None:
    for index in range(count):
        if not bits.number(1):
            continue
        last = following = 8
        for _ in range(16 if index < 6 else 64):
            if following:
                following = (last + bits.signed_golomb()) % 256
            last = following or last


def _pass_order(bits: Bits) -> None:
    kind = bits.golomb()
    if kind == 0:
        bits.golomb()
    elif kind == 1:
        bits.number(1)
        for _ in range(2):
            bits.golomb()
        for _ in range(min(bits.golomb(), MOST_FRAMES)):
            bits.golomb()


def _units(data: bytes) -> Iterator[tuple[int, bool, bytes]]:
    """Yield kind, whether others may be made from it, and the beginning of the content of each unit."""
    place = data.find(START)
    while 0 <= place < len(data) - 4:
        head = data[place + 3]
        yield head & 31, bool(head & 96), data[place + 4 : place + 4 + LONGEST_PARAMETERS]
        place = data.find(START, place + 4)
