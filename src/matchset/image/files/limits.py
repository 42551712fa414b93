"""How large a file may be, and what is unpacked from it: `InputLimits`."""

import msgspec


class InputLimits(msgspec.Struct, frozen=True, kw_only=True):
    """What is read of files that may come from a stranger. What is larger is refused in one line before it is unpacked.

    Parameters
    ----------
    picture : int
        Pixels of a picture. More takes more memory (3 bytes each, several times over); less refuses pictures of large
        cameras. Chosen by: four times the pixels of an 8K picture (33 million), 0.4 GB in BGR.
    picture_file : int
        Bytes of a picture file, packed. Chosen by: a picture of that many pixels that does not pack at all.
    color : int
        Bytes of a color file, unpacked. Chosen by: 60 times those of the table of one (131 kB), for later versions.
    table : int
        Bytes of a table (CSV). Chosen by: a day of a camera at 30 pictures a second, 100 bytes a row.
    text : int
        Bytes of a file of settings, of a camera, of a ball. Chosen by: 100 times the longest of them (10 kB).
    nodes : int
        Values in a YAML file when all its aliases are written out. Chosen by: 100 times those of a camera's file.
    chunk : int
        Bytes of a chunk of an MCAP file, unpacked. Chosen by: 100 times what recorders write (1 to 10 MB).
    """

    picture: int = 134_000_000
    picture_file: int = 536_000_000
    color: int = 8_000_000
    table: int = 260_000_000
    text: int = 1_000_000
    nodes: int = 10_000
    chunk: int = 1_000_000_000


LIMITS = InputLimits()
