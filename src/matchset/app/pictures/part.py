"""A part of a video: `--start` and `--end`, as frames or seconds (`VideoPart`)."""

import re
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

import msgspec

if TYPE_CHECKING:  # both options are checked before anything heavy is loaded
    from matchset.image.frame import Frame

_MOMENT = re.compile(r"\s*(?:(\d{1,9})|(\d+(?:\.\d+)?)\s*s)\s*")


class FrameOrTime(msgspec.Struct, frozen=True):
    """A frame's index, or a time since the first frame, s; the other one is None."""

    frame: int | None = None
    seconds: float | None = None

    def is_reached(self, frame: "Frame", first: float) -> bool:
        """Whether a frame is at or after it; `first` is the time of the video's first frame, s."""
        if self.frame is not None:
            return frame.index >= self.frame
        return frame.time - first >= (self.seconds or 0.0) - 1e-9


def parse_moment(text: str | None, option: str) -> FrameOrTime | None:
    """Read ``120`` (a frame) or ``4.5s`` (seconds since the first frame); None where nothing was given.

    Raises
    ------
    ValueError
        If it is neither.
    """
    if text is None:
        return None
    found = _MOMENT.fullmatch(text)
    if found is None:
        raise ValueError(f"{option} is a frame, as in 120, or seconds, as in 4.5s, got {text!r}")
    return FrameOrTime(int(found[1]), None) if found[1] is not None else FrameOrTime(None, float(found[2]))


class VideoPart(msgspec.Struct, frozen=True):
    """From where to where a video is used.

    Parameters
    ----------
    start, end : FrameOrTime or None
        The first frame that is used, and the first that is not any more; None for the video's own.
    """

    start: FrameOrTime | None = None
    end: FrameOrTime | None = None

    @classmethod
    def parse(cls, start: str | None, end: str | None) -> "VideoPart":
        """Read both options; ValueError if the end is not after the start."""
        part = cls(parse_moment(start, "--start"), parse_moment(end, "--end"))
        for name in ("frame", "seconds"):
            low, high = getattr(part.start, name, None), getattr(part.end, name, None)
            if low is not None and high is not None and high <= low:
                raise ValueError(f"--end {end} is not after --start {start}")
        return part

    def of(self, frames: "Iterable[Frame]") -> "Iterator[Frame]":
        """Yield the frames of the part; ValueError at the end if the video ends before it begins."""
        first: float | None = None
        begun = self.start is None
        frame: Frame | None = None
        for frame in frames:
            first = frame.time if first is None else first
            if self.end is not None and self.end.is_reached(frame, first):
                return
            begun = begun or self.start is None or self.start.is_reached(frame, first)
            if begun:
                yield frame
        if not begun and frame is not None and first is not None:
            raise ValueError(f"--start is after the last frame, {frame.index} at {frame.time - first:.2f} s")
