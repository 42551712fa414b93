"""Which field of a source comes first, by what is wanted, what the pictures show and what a header says."""

from collections.abc import Callable, Iterable
from typing import Literal

from matchset.image.frame import Frame
from matchset.media.fields.field_reader import FieldReader, swapped
from matchset.media.fields.interlace import DEFAULT, FieldEvidence, Fields
from matchset.media.upright.square_pixels import square_size
from matchset.media.upright.view import View

SIDE = 1000  # geometry: px, of a picture whose rows would stay or not when its pixels are made square


class FieldChoice:
    """Finds out which field comes first.

    Parameters
    ----------
    wanted : str
        "top", "bottom" or "auto".
    view : View
        What is done to the pictures: in those that are turned upside down the fields may change places.
    height : int
        Of the pictures as they are handed out, px.

    Attributes
    ----------
    looks : bool
        Whether pictures are to be looked at.

    Raises
    ------
    ValueError
        If fields are wanted of pictures whose rows become columns, or are resampled.
    """

    def __init__(self, wanted: Literal["top", "bottom", "auto"], view: View, height: int) -> None:
        blocked = _why_not(view)
        if blocked and wanted != "auto":
            raise ValueError(f"fields lie in the rows of a picture, and {blocked}: got fields={wanted!r}")
        self.looks = wanted == "auto" and not blocked
        self._swapped = view.orientation.d < 0 and height % 2 == 0
        self._given: Fields | None = None if wanted == "auto" else swapped(wanted, self._swapped)
        self._notes = [f"fields: {blocked}, so whole frames are used"] if blocked else []
        self._found: Fields | None = "frames" if blocked else None
        self._looked = False

    def look(self, frames: Iterable[Frame]) -> None:
        """Find out what the frames of a file are, of as many as are needed for that."""
        evidence, self._looked = FieldEvidence(), True
        for count, frame in enumerate(frames, 1):
            evidence.add(frame.image)
            if evidence.verdict is not None or count >= DEFAULT.most_frames:
                break
        self._found = evidence.verdict

    def reader(self, fps: float | None, stated: Fields | None, by_arrival: Callable[[], bool]) -> FieldReader:
        """Return what hands out the frames.

        Parameters
        ----------
        fps : float or None
            Frames per second.
        stated : str or None
            What the header of the file says; what the pictures show counts.
        by_arrival : callable
            See `FieldReader`.
        """
        reader = FieldReader(self._given, fps, by_arrival, self._swapped)
        reader.notes += self._notes
        if self._looked:
            reader.decide(self._found, stated)
        elif self._notes:
            reader.stop_looking()
        return reader


def _why_not(view: View) -> str:
    """Say why pictures in a view have no fields; empty if they may have."""
    if view.orientation.transposed:
        return "these pictures are turned by a quarter"
    if view.aspect != 1.0 and square_size(SIDE, SIDE, view.aspect)[1] != SIDE:
        return "these are resampled to make pixels square"
    return ""
