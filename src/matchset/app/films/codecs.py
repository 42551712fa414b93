"""How films are packed, by the ending of the name: `CODECS`."""

from pathlib import Path
from typing import TYPE_CHECKING, Protocol, TypeAlias

import msgspec

if TYPE_CHECKING:  # the endings of names are checked before anything heavy is loaded
    import numpy as np
    import numpy.typing as npt

Picture: TypeAlias = "npt.NDArray[np.uint8]"


class FilmCodec(msgspec.Struct, frozen=True):
    """A video codec: its FourCC, and its usual name."""

    fourcc: str
    name: str


MPEG4 = FilmCodec("mp4v", "MPEG-4")
VP8 = FilmCodec("VP80", "VP8")
MJPEG = FilmCodec("MJPG", "Motion JPEG")
CODECS = {".mp4": (MPEG4,), ".webm": (VP8,), ".avi": (MJPEG,)}
"""OpenCV's codecs by file extension, best first. Its wheels write no H.264, and their VP9 takes a second a picture."""
EVEN = 2  # format: width and height of H.264 with 4:2:0 chroma are multiples of this


ANIMATIONS = (".gif", ".webp")
"""Endings of animated pictures."""


def check_animation(path: Path) -> None:
    """Refuse an animated picture's name of another kind (ValueError)."""
    if path.suffix.lower() not in ANIMATIONS:
        raise ValueError(f"an animated picture's name must end in {' or '.join(ANIMATIONS)}, got {str(path)!r}")


def codecs_for(path: Path) -> tuple[FilmCodec, ...]:
    """Return the codecs to try for a file's extension; ValueError if there are none."""
    try:
        return CODECS[path.suffix.lower()]
    except KeyError:
        raise ValueError(f"a video's name must end in {', '.join(CODECS)}, got {str(path)!r}") from None


class Film(msgspec.Struct, frozen=True):
    """What an encoder writes.

    Parameters
    ----------
    path : Path
        The file; its ending says how it is packed.
    fps : float
        Frames per second.
    size : tuple of two ints
        Width and height of the pictures, px.
    live : bool
        Whether the pictures come from a camera, which does not wait.
    small : bool
        Whether the noise of the pictures may be smoothed, for a file that can be sent to others.
    """

    path: Path
    fps: float
    size: tuple[int, int]
    live: bool = False
    small: bool = False


class Encoder(Protocol):
    """Packs pictures and writes them."""

    note: str
    """What the user should know about the file; empty if nothing."""

    def write(self, picture: Picture) -> None:
        """Append a BGR picture; OSError if it does not fit on the disk."""

    def close(self) -> None:
        """Finish the file, once; OSError if its end does not fit on the disk."""
