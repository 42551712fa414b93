"""The camera: from pixels to directions and back, `CameraModel`."""

import math
from functools import cached_property
from pathlib import Path

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.camera import camera_toml as camera_file
from matchset.camera import lens
from matchset.camera.changed_picture import ChangedPicture, in_orientation, resampled
from matchset.image.frame import Frame, check_image
from matchset.media.upright.orientation import Orientation, check_turn
from matchset.numeric.words import one_line, short

Floats = npt.NDArray[np.float64]


class CameraModel(msgspec.Struct, frozen=True, kw_only=True, dict=True):
    """A pinhole camera with OpenCV's five-coefficient lens: x = fx x' + cx, y = fy y' + cy, in px.

    x' and y' are X / Z and Y / Z as the lens moves them; without distortion they are the same (`lens.py` has the
    equations). Camera frame: x right, y down, z forward (m). Pixel centers lie at integer coordinates.

    Parameters
    ----------
    width, height : int
        Size of the picture, px.
    fx, fy : float
        Focal lengths, px.
    cx, cy : float
        Principal point, px.
    distortion : tuple of 5 float, optional
        k1, k2, p1, p2, k3, in OpenCV's order. All zero by default: no distortion.
    intrinsics_covariance : tuple of 9 tuples of 9 float, optional
        How uncertain fx, fy, cx, cy, k1, k2, p1, p2, k3 are, in this order (px and products of it). None by default:
        not known, taken as exact.

    Raises
    ------
    ValueError
        If a number is missing, not finite or impossible; the text begins with its name.
    """

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float
    distortion: tuple[float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0)
    intrinsics_covariance: tuple[tuple[float, ...], ...] | None = None

    def __post_init__(self) -> None:
        _check_size(self.width, self.height)
        for name in ("fx", "fy"):
            if not 0.0 < _number(name, getattr(self, name)) < math.inf:
                raise ValueError(f"{name} must be a positive number of px, got {getattr(self, name)!r}")
        for name, size in (("cx", self.width), ("cy", self.height)):
            if not -size <= _number(name, getattr(self, name)) <= 2 * size:
                raise ValueError(f"{name} must lie in or near the picture of {size} px, got {getattr(self, name)!r}")
        _check_distortion(self.distortion)
        if self.intrinsics_covariance is not None:
            _check_covariance(self.intrinsics_covariance)

    @one_line
    def __repr__(self) -> str:
        wide = 2.0 * math.degrees(math.atan2(0.5 * self.width, self.fx))
        focal, center = f"fx {short(self.fx)}, fy {short(self.fy)}", f"cx {short(self.cx)}, cy {short(self.cy)} px"
        bent = f"distortion {', '.join(map(short, self.distortion))}" if any(self.distortion) else "no distortion"
        known = "" if self.intrinsics_covariance is None else ", with covariance"
        return f"CameraModel({self.width} x {self.height}, {focal}, {center}, {wide:.1f}° wide, {bent}{known})"

    @classmethod
    def from_fov(cls, width: int, height: int, fov: float, focal_sigma: float = 0.0) -> "CameraModel":
        """Camera with square pixels and its principal point in the middle, from the horizontal field of view.

        fx = fy = (width / 2) / tan(fov / 2), cx = (width - 1) / 2, cy = (height - 1) / 2 (Epstein & Feldman, Eq. 5).

        Parameters
        ----------
        width, height : int
            Size of the picture, px.
        fov : float
            Horizontal field of view, rad.
        focal_sigma : float
            Standard deviation of the focal length that follows from it, as a share of it: 0.05 where a field of view is
            known to 5 %. It is part of the covariance of every pose. 0 by default: taken as exact.

        Raises
        ------
        ValueError
            If the size is not positive, the field of view is outside 0 ... pi, the share outside 0 ... 1, or one of
            them is no number.
        """
        if _number("width", width) < 1 or _number("height", height) < 1:
            raise ValueError(f"a picture's size must be positive, got {width} x {height}")
        if not 0.0 < _number("fov", fov) < math.pi:
            hint = f" ({fov:g} degrees are math.radians({fov:g}))" if math.pi <= fov < 180.0 else ""
            raise ValueError(f"a field of view must lie between 0 and pi rad, got {fov}{hint}")
        focal = (width / 2.0) / math.tan(fov / 2.0)
        camera = cls(width=width, height=height, fx=focal, fy=focal, cx=(width - 1) / 2.0, cy=(height - 1) / 2.0)
        return camera.with_focal_sigma(focal_sigma) if focal_sigma else camera

    def with_focal_sigma(self, share: float) -> "CameraModel":
        """Return this camera with another standard deviation of its focal length; what else is uncertain stays.

        Parameters
        ----------
        share : float
            Of both focal lengths together, as a share of them; their ratio is taken as exact.

        Raises
        ------
        ValueError
            If it is outside 0 ... 1, or no number.
        """
        if not 0.0 <= _number("focal_sigma", share) < 1.0:
            raise ValueError(f"focal_sigma is a share of the focal length, at least 0 and less than 1, got {share!r}")
        covariance = np.zeros((9, 9)) if self.covariance is None else np.array(self.covariance)
        covariance[:2], covariance[:, :2] = 0.0, 0.0
        covariance[:2, :2] = share**2 * np.outer((self.fx, self.fy), (self.fx, self.fy))
        rows = tuple(tuple(row) for row in covariance.tolist()) if covariance.any() else None
        return msgspec.structs.replace(self, intrinsics_covariance=rows)

    @classmethod
    def load(cls, path: str | Path) -> "CameraModel":
        """Read a camera from a file.

        Parameters
        ----------
        path : str or Path
            TOML that `save` wrote; or YAML (.yaml, .yml): ROS ``camera_info`` or OpenCV's.

        Raises
        ------
        ValueError
            If there is no such file, it is none of these, or a number is missing or impossible; with the file's name
            and the key.
        """
        fields, keys = camera_file.read_camera(Path(path))
        try:
            return cls(**fields)
        except ValueError as error:
            name = str(error).split(" ", 1)[0]
            key = keys.get(name, name)
            raise ValueError(f"{path}: {error}" if key == name else f"{path}: {key}: {error}") from None

    def save(self, path: str | Path) -> None:
        """Write the camera as TOML, with a unit on every line; whole or not at all.

        Parameters
        ----------
        path : str or Path
            Where; the name must end in ``.toml``. A file of this name is replaced.

        Raises
        ------
        ValueError
            If the name has another ending.
        """
        camera_file.write_camera(Path(path), (self.width, self.height), self.intrinsics, self.covariance)

    def turned(self, turn: int = 0, mirror: bool = False) -> "CameraModel":
        """Return the camera of pictures that are turned and mirrored, as `matchset.Video` does it.

        Its frame is that of the turned picture: x right, y down in it. Mirrored pictures show a mirrored world.

        Parameters
        ----------
        turn : int
            Degrees, clockwise: 0, 90, 180 or 270.
        mirror : bool
            Whether left and right are swapped after that.

        Raises
        ------
        ValueError
            If the turn is something else.
        """
        check_turn(turn)
        return self._changed(in_orientation((self.width, self.height), Orientation.of_turn(turn, mirror)))

    def resized(self, width: int, height: int) -> "CameraModel":
        """Return the camera of the same pictures, whole, at another size.

        f' = s f and c' = s (c + 1/2) - 1/2 with the ratio s of the sizes, of each axis; the distortion stays. Many
        cameras cut pictures of other proportions out of larger ones, and small ones too: that is no change of size.

        Parameters
        ----------
        width, height : int
            Size of the pictures, px.

        Raises
        ------
        ValueError
            If it is not positive and whole.
        """
        _check_size(width, height)
        return self._changed(resampled((self.width, self.height), (int(width), int(height))))

    def _changed(self, change: ChangedPicture) -> "CameraModel":
        fx, fy, cx, cy, k1, k2, p1, p2, k3 = change.intrinsics(self.intrinsics)
        covariance = None if self.covariance is None else change.covariance(self.covariance)
        (width, height), lens = change.size, (k1, k2, p1, p2, k3)
        return CameraModel(
            width=width, height=height, fx=fx, fy=fy, cx=cx, cy=cy, distortion=lens, intrinsics_covariance=covariance
        )

    @property
    def focal_sigma(self) -> float:
        """Standard deviation of the focal length as a share of it, the larger of both; 0 where it is not known."""
        variances = np.zeros(2) if self.covariance is None else self.covariance.diagonal()[:2].clip(0.0)
        return float((np.sqrt(variances) / (self.fx, self.fy)).max())

    @cached_property
    def intrinsics(self) -> Floats:
        """What the kernels of `lens.py` take: fx, fy, cx, cy, k1, k2, p1, p2, k3, (9,) float64, read-only."""
        numbers = np.array([self.fx, self.fy, self.cx, self.cy, *self.distortion], np.float64)
        numbers.flags.writeable = False
        return numbers

    @cached_property
    def covariance(self) -> Floats | None:
        """Covariance of `intrinsics`, (9, 9) float64, read-only; None if it is not known."""
        if self.intrinsics_covariance is None:
            return None
        matrix = np.array(self.intrinsics_covariance, np.float64)
        matrix.flags.writeable = False
        return matrix

    def rays(self, points: npt.ArrayLike) -> Floats:
        """Turn pixels into unit vectors along their rays; only these points are undistorted, never the image.

        Parameters
        ----------
        points : array_like of shape (n, 2)
            px; they may lie outside the picture.

        Returns
        -------
        ndarray of shape (n, 3), float64
            Unit vectors of the camera frame. Where the lens polynomial has no direction (far out, beyond its fold)
            the row is 0, 0, 0.

        Raises
        ------
        ValueError
            If the shape is another one or a number is not finite.
        """
        pixels = _rows(points, 2)
        rays = np.empty((len(pixels), 3))
        if lens.unproject(self.intrinsics, pixels, rays):
            _check_finite(pixels)
        return rays

    def project(self, points: npt.ArrayLike) -> Floats:
        """Project points of the camera frame into the image.

        Parameters
        ----------
        points : array_like of shape (n, 3)
            In the camera frame, m. Ask `visible` first if they may lie behind the camera.

        Returns
        -------
        ndarray of shape (n, 2), float64
            px; it may lie outside the picture.

        Raises
        ------
        ValueError
            If the shape is another one, a number is not finite, or a point has no image: it is not before the
            camera, or so far off the axis that the lens polynomial has folded.
        """
        given = _rows(points, 3)
        pixels, seen = self._project(given)
        if not seen.all():
            _check_finite(given)
            x, y, z = given[int(np.argmin(seen))]
            raise ValueError(f"this camera cannot see the point ({x:.6g}, {y:.6g}, {z:.6g}) m")
        return pixels

    def visible(self, points: npt.ArrayLike) -> npt.NDArray[np.bool_]:
        """Whether points lie before the camera and inside its picture.

        Parameters
        ----------
        points : array_like of shape (n, 3)
            In the camera frame, m.

        Returns
        -------
        ndarray of shape (n,), bool

        Raises
        ------
        ValueError
            If the shape is another one or a number is not finite.
        """
        given = _rows(points, 3)
        _check_finite(given)
        pixels, seen = self._project(given)
        inside = (pixels >= -0.5) & (pixels <= np.array([self.width, self.height]) - 0.5)
        visible: npt.NDArray[np.bool_] = seen & inside.all(axis=1)
        return visible

    def _project(self, points: Floats) -> tuple[Floats, npt.NDArray[np.bool_]]:
        pixels, seen = np.empty((len(points), 2)), np.empty(len(points), np.bool_)
        lens.project(self.intrinsics, points, pixels, seen)
        return pixels, seen

    def check(self, picture: Frame | npt.NDArray[np.uint8] | tuple[int, int]) -> None:
        """Refuse a picture that is not of this camera's size.

        Parameters
        ----------
        picture : Frame, ndarray of shape (h, w, 3) or (h, w), or tuple of int
            A picture, or its width and height, px.

        Raises
        ------
        ValueError
            With both sizes, if they differ.
        """
        if isinstance(picture, tuple):
            width, height = picture
        else:
            image = picture.image if isinstance(picture, Frame) else picture
            check_image(image)
            height, width = image.shape[:2]
        if (width, height) != (self.width, self.height):
            sizes = f"{width} x {height} px, the camera's are {self.width} x {self.height} px"
            raise ValueError(
                f"the picture is {sizes}: calibrate at the size that is used, or, if only the size of the same picture "
                f"has changed, use camera.resized({width}, {height})"
            )


_LARGEST = 1_000_000  # format: px; a larger width or height is a typing error


def _check_size(width: int, height: int) -> None:
    for name, size in (("width", width), ("height", height)):
        if isinstance(size, bool) or not isinstance(size, int | np.integer) or not 1 <= size <= _LARGEST:
            raise ValueError(f"{name} must be a whole number of px from 1 to {_LARGEST}, got {size!r}")


_STRONGEST = 1.0e9  # format: largest distortion coefficient


def _number(name: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float | np.number):
        raise ValueError(f"{name} must be a number, got {value!r}")
    if not -1e300 < value < 1e300:
        raise ValueError(f"{name} must be finite, got {value!r}")
    return float(value)


def _check_distortion(values: object) -> None:
    if not isinstance(values, tuple) or len(values) != 5:
        raise ValueError(f"distortion must be the five numbers k1, k2, p1, p2, k3, got {values!r}")
    for name, value in zip(lens.INTRINSICS[4:], values, strict=True):
        if abs(_number(name, value)) > _STRONGEST:
            raise ValueError(f"{name} must lie between -1e9 and 1e9, got {value!r}")


def _check_covariance(rows: object) -> None:
    """Refuse what is not symmetric with eigenvalues of zero and above."""
    try:
        matrix = np.array(rows, np.float64)
    except (TypeError, ValueError):
        matrix = np.empty(0)
    if matrix.shape != (9, 9) or not isinstance(rows, tuple):
        raise ValueError(f"intrinsics_covariance must be 9 rows of 9 numbers, got {rows!r}")
    scale = np.sqrt(np.abs(np.diag(matrix)))
    scale[scale == 0.0] = 1.0
    with np.errstate(all="ignore"):
        matrix = matrix / np.outer(scale, scale)
    if not np.isfinite(matrix).all() or np.abs(matrix - matrix.T).max() > 1e-6:
        raise ValueError("intrinsics_covariance must be finite and symmetric")
    if np.linalg.eigvalsh(matrix).min() < -1e-6:
        raise ValueError("intrinsics_covariance must not be negative in any direction")


def _rows(points: npt.ArrayLike, columns: int) -> Floats:
    rows = np.ascontiguousarray(points, np.float64)
    if rows.ndim != 2 or rows.shape[1] != columns:
        raise ValueError(f"points must have shape (n, {columns}), got {rows.shape}")
    return rows


def _check_finite(points: Floats) -> None:
    finite = np.isfinite(points).all(axis=1)
    if not finite.all():
        raise ValueError(f"points must be finite, got {points[int(np.argmin(finite))]}")
