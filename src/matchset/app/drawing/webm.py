"""The frame rate of a WebM file, changed in place.

OpenCV leaves libvpx a deadline of one second a frame, and libvpx takes that as leave to search long unless a
frame lasts as long. So VP8 is packed as if one frame a second were shown, 4 to 6 times as fast at equal size
and quality, and afterwards the file's tick is shortened to what it should be.
"""

from pathlib import Path

PACKING_FPS = 1.0
"""What to tell OpenCV while it packs."""

_SCALE_ID = b"\x2a\xd7\xb1"
_DURATION_ID = b"\x23\xe3\x83"
_DEFAULT_SCALE_NS = 1_000_000
_HEAD_BYTES = 4096


def set_frame_rate(path: Path, fps: float) -> None:
    """Give a file that was packed at `PACKING_FPS` its true frame rate.

    Parameters
    ----------
    path : Path
        The file: WebM as FFmpeg writes it, with ticks of 1 ms.
    fps : float
        Frames per second.

    Raises
    ------
    ValueError
        If the file is not such a one.
    """
    with path.open("r+b") as file:
        head = file.read(_HEAD_BYTES)
        at, size = _element(head, _SCALE_ID)
        if int.from_bytes(head[at : at + size]) != _DEFAULT_SCALE_NS:
            raise ValueError(f"{path} does not count in milliseconds")
        file.seek(at)
        file.write(round(_DEFAULT_SCALE_NS * PACKING_FPS / fps).to_bytes(size))
        if _DURATION_ID in head:
            at, size = _element(head, _DURATION_ID)
            file.seek(at)
            file.write(round(1e9 / fps).to_bytes(size))


def _element(head: bytes, name: bytes) -> tuple[int, int]:
    """Find where an EBML element's value begins, and its length."""
    at = head.find(name)
    if at < 0 or at + len(name) >= len(head):
        raise ValueError("this is no WebM file of FFmpeg's")
    # A length below 127 is one byte with its highest bit set.
    return at + len(name) + 1, head[at + len(name)] & 0x7F
