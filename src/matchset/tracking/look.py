"""How far to look for a shape in a picture: `Look`."""

from typing import NamedTuple


class Look(NamedTuple):
    """How far to look for a shape.

    Attributes
    ----------
    reach : float
        How far the outline may be from where the fit begins, px.
    speed : float
        How fast the shape moves, px per frame: the two fields of an interlaced picture lie apart by a part of that.
    sigma : float
        How far the edge points are expected from there, px; 0 for a third of the reach.
    free : bool
        Whether the shape may be anywhere, or only as far from its prediction as the motion has room.
    least : float
        Agreement below which it gives up.
    blind : bool
        Whether nothing is known of the direction in which the shape moves.
    """

    reach: float
    speed: float = 0.0
    sigma: float = 0.0
    free: bool = True
    least: float = 0.0
    blind: bool = False
