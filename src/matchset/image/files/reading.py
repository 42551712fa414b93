"""Files that are read no further than a limit, also endless ones such as /dev/zero: `read_limited`."""

from pathlib import Path

PIECE = 1 << 20  # format: bytes that are read at once


def read_limited(path: Path, most: int, text: bool = False) -> bytes:
    """Read a file.

    Parameters
    ----------
    path : Path
    most : int
        Bytes; a longer file is refused.
    text : bool
        Whether it must be text: one with zero bytes is refused.

    Raises
    ------
    OSError
        If it cannot be read.
    ValueError
        If it is longer, or no text; without its name.
    """
    pieces, size = [], 0
    with path.open("rb") as file:
        while piece := file.read(PIECE):
            size += len(piece)
            if text and b"\0" in piece:
                raise ValueError("not a text file, it holds zero bytes")
            if size > most:
                raise ValueError(f"too large, longer than {most / 1e6:g} MB")
            pieces.append(piece)
    return b"".join(pieces)


def read_text(path: Path, most: int) -> str:
    """Read a text file in UTF-8.

    Raises
    ------
    OSError, UnicodeDecodeError
        If it cannot be read.
    ValueError
        If it is longer than `most` bytes, or holds zero bytes; with its name.
    """
    try:
        data = read_limited(path, most, text=True)
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    return data.decode("utf-8")
