"""The pinhole camera: `CameraModel`."""

import math

import msgspec


class CameraModel(msgspec.Struct, frozen=True, kw_only=True):
    """A pinhole camera: x = fx X / Z + cx, y = fy Y / Z + cy, in px.

    Camera frame: x right, y down, z forward (m). Pixel centers lie at integer coordinates.

    Parameters
    ----------
    width, height : int
        Size of the picture, px.
    fx, fy : float
        Focal lengths, px.
    cx, cy : float
        Principal point, px.
    """

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float

    @classmethod
    def from_fov(cls, width: int, height: int, fov: float) -> "CameraModel":
        """Camera with square pixels and its principal point in the middle, from the horizontal field of view.

        fx = fy = (width / 2) / tan(fov / 2), cx = (width - 1) / 2, cy = (height - 1) / 2 (Epstein & Feldman, Eq. 5).

        Parameters
        ----------
        width, height : int
            Size of the picture, px.
        fov : float
            Horizontal field of view, rad.

        Raises
        ------
        ValueError
            If the size is not positive or the field of view is outside 0 ... pi.
        """
        if width < 1 or height < 1:
            raise ValueError(f"a picture's size must be positive, got {width} x {height}")
        if not 0.0 < fov < math.pi:
            raise ValueError(f"a field of view must lie between 0 and pi rad, got {fov}")
        focal = (width / 2.0) / math.tan(fov / 2.0)
        return cls(width=width, height=height, fx=focal, fy=focal, cx=(width - 1) / 2.0, cy=(height - 1) / 2.0)
