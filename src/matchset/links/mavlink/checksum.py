"""The checksum of MAVLink: CRC-16/MCRF4XX, known there as X.25.

Polynomial x^16 + x^12 + x^5 + 1, least significant bit first, start 0xFFFF, no final inversion.
"""

START = 0xFFFF  # format: of the CRC
POLYNOMIAL = 0x8408  # format: of the CRC, bits in reversed order


def _table() -> tuple[int, ...]:
    table = []
    for value in range(256):
        crc = value
        for _ in range(8):
            crc = crc >> 1 ^ (POLYNOMIAL if crc & 1 else 0)
        table.append(crc)
    return tuple(table)


_TABLE = _table()


def accumulate(data: bytes, crc: int = START) -> int:
    """Return the CRC of some bytes, 0 ... 65535.

    Parameters
    ----------
    data : bytes
    crc : int
        CRC of the bytes before them.
    """
    for byte in data:
        crc = crc >> 8 ^ _TABLE[(crc ^ byte) & 0xFF]
    return crc
