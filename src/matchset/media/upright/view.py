"""How the pictures of a source are handed out: what its header says, and what the user wants (`View`, `Wish`)."""

from typing import Literal, NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.media.upright.orientation import AS_STORED, Orientation, check_turn
from matchset.media.upright.square_pixels import is_credible, is_square, square_size, squared

WantedFields = Literal["frames", "top", "bottom", "auto"]
FIELDS: tuple[WantedFields, ...] = ("frames", "top", "bottom", "auto")  # format: what may be wanted of interlaced video


def checked_fields(fields: str) -> WantedFields:
    """Return what is wanted of interlaced video; ValueError if there is no such thing."""
    for known in FIELDS:
        if fields == known:
            return known
    raise ValueError(f"fields must be one of {', '.join(FIELDS)}, got {fields!r}")


class Wish(msgspec.Struct, frozen=True, kw_only=True):
    """How a user wants the pictures of any source.

    Parameters
    ----------
    square : bool
        Whether pixels are made square.
    turn : int
        Degrees by which pictures are turned, clockwise: 0, 90, 180 or 270.
    mirror : bool
        Whether left and right are swapped, after that.
    stream : int or None
        Which video stream of a file, from 0; None: the one that plays longest.
    damaged : bool or None
        Whether pictures whose decoder reports errors are handed out; None: of files, not of live sources.
    fields : str
        "frames"; or half-frames of interlaced pictures, by which field comes first: "top", "bottom" or "auto".

    Raises
    ------
    ValueError
        If one of them is something else.
    """

    square: bool = True
    turn: int = 0
    mirror: bool = False
    stream: int | None = None
    damaged: bool | None = None
    fields: WantedFields = "frames"

    def __post_init__(self) -> None:
        check_turn(self.turn)
        for name in ("square", "mirror"):
            if not isinstance(getattr(self, name), bool):
                raise ValueError(f"{name} must be True or False, got {getattr(self, name)!r}")
        if self.damaged is not None and not isinstance(self.damaged, bool):
            raise ValueError(f"damaged must be True, False or None, got {self.damaged!r}")
        checked_fields(self.fields)
        number = self.stream
        if number is not None and (isinstance(number, bool) or not isinstance(number, int) or number < 0):
            raise ValueError(f"stream must be the number of a video stream, from 0, got {number!r}")

    @property
    def orientation(self) -> Orientation:
        """What `turn` and `mirror` make of a picture."""
        return Orientation.of_turn(self.turn, self.mirror)


ANY = Wish()


class View(NamedTuple):
    """What is done to every picture of a source.

    Attributes
    ----------
    aspect : float
        Width of a stored pixel, in its heights, that is made square; 1 where nothing is resampled.
    orientation : Orientation
        In which it is put after that.
    pixel_aspect : float
        Width of a pixel that is handed out, in its heights; 1 unless the user wants pixels as they are stored.
    notes : tuple of str
        What is to be said of it.
    """

    aspect: float = 1.0
    orientation: Orientation = AS_STORED
    pixel_aspect: float = 1.0
    notes: tuple[str, ...] = ()

    @property
    def changes(self) -> bool:
        """Whether it does anything to a picture."""
        return self.aspect != 1.0 or self.orientation != AS_STORED

    def apply(self, image: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint8]:
        """Return a stored picture, (h, w) or (h, w, 3), as it is handed out."""
        return self.orientation.apply(squared(image, self.aspect))

    def shape(self, stored: tuple[int, ...]) -> tuple[int, ...]:
        """Return the shape of the array of a picture that is handed out, from that of the stored one."""
        width, height = square_size(stored[1], stored[0], self.aspect)
        return (width, height, *stored[2:]) if self.orientation.transposed else (height, width, *stored[2:])


def view_of(ratio: tuple[float, float], stored: Orientation, size: tuple[int, int], wish: Wish) -> View:
    """Say what is done to the pictures of a source.

    Parameters
    ----------
    ratio : tuple of float
        Width and height of a stored pixel, in any unit; not both positive where it is not known.
    stored : Orientation
        In which the header wants them to be shown.
    size : tuple of int
        Width and height of the pictures as stored, px.
    wish : Wish

    Returns
    -------
    View
    """
    orientation = stored.then(wish.orientation)
    aspect = ratio[0] / ratio[1] if ratio[0] > 0.0 and ratio[1] > 0.0 else 1.0
    words = f"{ratio[0]:.6g}:{ratio[1]:.6g}"
    if not is_credible(aspect):
        return View(1.0, orientation, 1.0, (f"the header's pixels of {words} are not credible: ignored",))
    if is_square(aspect):
        return View(1.0, orientation)
    if not wish.square:
        note = f"pixels are not square, {words}, and handed out as they are stored: circles are ellipses"
        return View(1.0, orientation, 1.0 / aspect if orientation.transposed else aspect, (note,))
    made = square_size(*size, aspect)
    stated = f"pictures of {size[0]} x {size[1]} px are made {made[0]} x {made[1]} px"
    return View(aspect, orientation, 1.0, (f"pixels are not square, {words}: {stated}",))
