"""What a lens that distorts makes of a pinhole camera's picture: `ExactLensWarp` and `FastLensWarp`.

The exact one averages nine samples of a finer picture for each pixel. The fast one works on a field of packed pixels:
the room is warped as OpenCV's ``remap`` does it, bilinear with places in 1/32 px, bit for bit, but three colors at
once: B, G and R of a pixel lie 20 bits apart in one word of 64 bits, so that one product weighs all of them.
"""

import math
from typing import NamedTuple

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.camera.camera_model import CameraModel
from matchset.numeric.jit import kernel
from matchset.sim.rendering.coverage import PackedPixels, Pinhole
from matchset.sim.rendering.renderer import Picture

Bytes = npt.NDArray[np.uint8]
Ints = npt.NDArray[np.int64]
Longs = npt.NDArray[np.uint64]
Singles = npt.NDArray[np.float32]

# format: fixed-point numbers of `FastLensWarp`: a byte, the lower 5 bits of a share; 1 and 1/2 of 32 * 32 = 1024
_BYTE, _FRACTION = np.uint64(0xFF), np.uint64(31)
# format: as above
_ONE, _HALF = np.uint64(32), np.uint64(512 | 512 << 20 | 512 << 40)
# format: two bytes of a packed pixel at once, and 2 in each, to round quarters
_PAIR, _TWOS = np.uint32(0x00FF00FF), np.uint32(0x00020002)


class ExactWarpParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How finely a picture is rendered before it is warped.

    Parameters
    ----------
    finer : float
        Pixels of the pinhole's picture for one of the camera's, along x and along y. More: sharper, slower.
    samples : int
        Samples for each pixel, along x and along y. Chosen by hand with `finer`: an outline through a lens is that of
        the camera model to less than 2 px, `test_ball_flight_clip`.
    widest : float
        Largest slope |X / Z| of a ray that is rendered. More: wider lenses, larger pictures.
    """

    finer: float = 2.0
    samples: int = 3
    widest: float = 1.5


class ExactLensWarp:
    """Warp a picture as a lens does, exactly: it is rendered by a finer and wider pinhole camera, then averaged.

    Every pixel is the mean of 3 x 3 bilinear samples of the pinhole picture. Where the lens has no direction the
    picture is black. Without distortion the pinhole camera is the camera, and nothing is warped.

    Parameters
    ----------
    camera : CameraModel
        Whose lens it is.
    parameters : ExactWarpParameters, optional

    Attributes
    ----------
    pinhole : CameraModel
        The camera to render with.
    """

    def __init__(self, camera: CameraModel, parameters: ExactWarpParameters | None = None) -> None:
        self.camera, self.pinhole, self._parameters = camera, camera, parameters or ExactWarpParameters()
        self._maps: list[tuple[npt.NDArray[np.float32], npt.NDArray[np.float32]]] = []
        if any(camera.distortion):
            self._make_maps()

    def _make_maps(self) -> None:
        """Choose the pinhole camera, and compute where each sample of each pixel lies in its picture."""
        samples = self._parameters.samples
        shape = self.camera.height, self.camera.width
        rows, columns = np.indices(shape).reshape(2, -1).astype(np.float64)
        rays = self.camera.rays(np.column_stack((columns, rows)))
        with np.errstate(invalid="ignore"):
            slopes = [(rays[:, k] / rays[:, 2]).reshape(shape) for k in range(2)]
        right, below = (min(float(np.nanmax(np.abs(slope))), self._parameters.widest) for slope in slopes)
        focal = self._parameters.finer * self.camera.fx
        width, height = 2 * math.ceil(focal * right) + 8, 2 * math.ceil(focal * below) + 8
        self.pinhole = CameraModel(
            width=width, height=height, fx=focal, fy=focal, cx=(width - 1) / 2.0, cy=(height - 1) / 2.0
        )
        shifts = (np.arange(samples) + 0.5) / samples - 0.5
        bends = [np.gradient(slope) for slope in slopes]
        for down in shifts:
            for across in shifts:
                places = [
                    focal * (slope + down * bend[0] + across * bend[1]) + center
                    for slope, bend, center in zip(slopes, bends, (self.pinhole.cx, self.pinhole.cy), strict=True)
                ]
                maps = [np.nan_to_num(place, nan=-1e4).astype(np.float32) for place in places]
                self._maps.append((maps[0], maps[1]))

    def warp(self, picture: Picture) -> Picture:
        """Warp a picture of the pinhole camera.

        Parameters
        ----------
        picture : ndarray of shape (h, w, 3), float32
            Of the size of `pinhole`; unchanged.

        Returns
        -------
        ndarray of shape (h, w, 3), float32
            Of the size of the camera.
        """
        if not self._maps:
            return picture
        total = np.zeros((self.camera.height, self.camera.width, 3), np.float32)
        for x, y in self._maps:
            total += cv2.remap(picture, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT)
        return np.asarray(total / np.float32(len(self._maps)), np.float32)


class WindowMaps(NamedTuple):
    """Where each pixel of a field looks in the full picture of its pinhole, px.

    Parameters
    ----------
    across, down : (h, w)
        Column and row.
    row_range, column_range : (h, 2), (w, 2)
        Least and largest row of each line, and column of each column.
    """

    across: Singles
    down: Singles
    row_range: Singles
    column_range: Singles


class FastLensWarp:
    """Warp a field as a lens does, fast: a pinhole camera draws it, in full and with half the columns.

    Line r of the field is line ``fields r + field`` of the frame.

    Parameters
    ----------
    camera : CameraModel
        With its lens.
    fields, field : int
        How many there are, and which this is.

    Attributes
    ----------
    width, height : int
        Of the pinhole's picture in full, px; a field's lines.
    full, half : Pinhole
        Where its pixels look, with all columns and with half of them.
    columns : ndarray of shape (height, 2), int64
        First and last column of the half picture that the lens shows in each line.
    """

    def __init__(self, camera: CameraModel, fields: int, field: int) -> None:
        self._field, self._fields = field, fields
        height = (camera.height - field + fields - 1) // fields
        rows, columns = np.indices((height, camera.width)).reshape(2, -1).astype(np.float64)
        rays = camera.rays(np.column_stack((columns, fields * rows + field)))
        slopes = [(rays[:, k] / rays[:, 2]).reshape(height, camera.width) for k in range(2)]
        fx, fy = camera.fx, camera.fy / fields
        cx = float(math.ceil(fx * np.abs(slopes[0]).max())) + 4.0
        cy = float(math.ceil(fy * np.abs(slopes[1]).max())) + 4.0
        self.width, self.height = 2 * int(cx) + 2, 2 * int(cy) + 1
        self.full = Pinhole(fx, fy, cx, cy)
        self.half = Pinhole(0.5 * fx, fy, 0.5 * (cx - 0.5), cy)
        x, y = fx * slopes[0] + cx, fy * slopes[1] + cy
        across, down = x.astype(np.float32), y.astype(np.float32)
        whole, shares = cv2.convertMaps(((x - 0.5) / 2.0).astype(np.float32), down, cv2.CV_16SC2)
        places = whole.astype(np.int64)
        self._places = (places[..., 1] * (self.width // 2) + places[..., 0]).astype(np.uint32)
        self._shares = shares.astype(np.uint32)
        self.columns = _columns(places, self.height, self.width // 2)
        rows_seen = np.column_stack((down.min(axis=1), down.max(axis=1)))
        self._maps = WindowMaps(across, down, rows_seen, np.column_stack((across.min(axis=0), across.max(axis=0))))

    def warp(self, room: PackedPixels, spread: Longs, frame: Bytes) -> None:
        """Warp a picture with half the columns, and widen it, into the field's lines of a frame.

        Parameters
        ----------
        room : ndarray of shape (height, width // 2), uint32
        spread : the same, uint64
            To work in.
        frame : ndarray of shape (h, w, 3), uint8
            BGR; written.
        """
        _warp(room, spread, self._places, self._shares, frame, (self._field, self._fields))

    def warp_window(self, window: PackedPixels, left: int, top: int, frame: Bytes) -> None:
        """Warp a part of the full picture, whose upper left pixel is (left, top), into the field's lines of a frame."""
        _warp_window(window, (left, top), self._maps, frame, (self._field, self._fields))


def _columns(places: Ints, height: int, width: int) -> Ints:
    """First and last column that each line of a picture lends to places and their neighbors, and 2 px more."""
    columns = np.empty((height, 2), np.int64)
    columns[:, 0], columns[:, 1] = width, -1
    for down in (0, 1):
        np.minimum.at(columns[:, 0], places[..., 1] + down, np.maximum(places[..., 0] - 2, 0))
        np.maximum.at(columns[:, 1], places[..., 1] + down, np.minimum(places[..., 0] + 3, width - 1))
    return columns


@kernel
def _spread_word(word: np.uint64) -> np.uint64:
    """Move B, G and R of a pixel 20 bits apart."""
    green, red = (word & np.uint64(0xFF00)) << np.uint64(12), (word & np.uint64(0xFF0000)) << np.uint64(24)
    return (word & _BYTE) | green | red


@kernel
def _warp(
    room: PackedPixels, spread: Longs, places: PackedPixels, shares: PackedPixels, frame: Bytes, rows: tuple[int, int]
) -> None:
    """Write some rows (first, step) of a frame: the room at places (px, counted through) and shares."""
    start, step = rows
    height, width = room.shape
    for y in range(height):
        line, out = room[y], spread[y]
        for x in range(width):
            out[x] = _spread_word(np.uint64(line[x]))
    flat, next_line = spread.reshape(height * width), np.uint64(width)
    one = np.uint64(1)
    for r in range(places.shape[0]):
        line, where, share = frame[start + r * step], places[r], shares[r]
        for x in range(where.shape[0]):
            at, p, q = np.uint64(where[x]), np.uint64(share[x]) & _FRACTION, np.uint64(share[x]) >> np.uint64(5)
            above = (_ONE - p) * flat[at] + p * flat[at + one]
            below = (_ONE - p) * flat[at + next_line] + p * flat[at + next_line + one]
            total = (_ONE - q) * above + q * below + _HALF
            line[x, 0] = (total >> np.uint64(10)) & _BYTE
            line[x, 1] = (total >> np.uint64(30)) & _BYTE
            line[x, 2] = (total >> np.uint64(50)) & _BYTE


@kernel
def widen(room: PackedPixels, left: int, top: int, window: PackedPixels) -> None:
    """Write a part of the full picture, from an even column on, that shows the room's: 3/4 and 1/4 of neighbors."""
    for y in range(window.shape[0]):
        line, out = room[top + y, left // 2 : (left + window.shape[1]) // 2], window[y]
        last = line.shape[0] - 1
        for m in range(line.shape[0]):
            here, before, after = line[m], line[max(m - 1, 0)], line[min(m + 1, last)]
            out[2 * m], out[2 * m + 1] = _quarter(before, here), _quarter(after, here)


@kernel
def _quarter(other: np.uint32, here: np.uint32) -> np.uint32:
    """Mean of two pixels with weights 1/4 and 3/4, in two pairs of bytes."""
    three = np.uint32(3)
    low = ((other & _PAIR) + three * (here & _PAIR) + _TWOS) >> np.uint32(2)
    other, here = np.uint32(other >> np.uint32(8)), np.uint32(here >> np.uint32(8))
    high = ((other & _PAIR) + three * (here & _PAIR) + _TWOS) >> np.uint32(2)
    return np.uint32((low & _PAIR) | ((high & _PAIR) << np.uint32(8)))


@kernel
def _warp_window(
    window: PackedPixels, corner: tuple[int, int], maps: WindowMaps, frame: Bytes, rows: tuple[int, int]
) -> None:
    """Write what a part of the full picture shows into some rows (first, step) of a frame."""
    (left, top), (start, step) = corner, rows
    right, bottom = left + window.shape[1] - 1, top + window.shape[0] - 1
    first, last = maps.column_range.shape[0], -1
    for x in range(maps.column_range.shape[0]):
        if maps.column_range[x, 1] >= left and maps.column_range[x, 0] < right:
            first, last = min(first, x), x
    for r in range(maps.row_range.shape[0]):
        if maps.row_range[r, 1] < top or maps.row_range[r, 0] >= bottom:
            continue
        for x in range(first, last + 1):
            at_x, at_y = maps.across[r, x], maps.down[r, x]
            if at_x < left or at_x >= right or at_y < top or at_y >= bottom:
                continue
            j, i = int(at_x), int(at_y)
            p, q = at_x - np.float32(j), at_y - np.float32(i)
            j, i = j - left, i - top
            above, below, line = window[i], window[i + 1], frame[start + r * step, x]
            for k in range(3):
                shift = np.uint32(8 * k)
                one = _level(above[j], shift) + p * (_level(above[j + 1], shift) - _level(above[j], shift))
                two = _level(below[j], shift) + p * (_level(below[j + 1], shift) - _level(below[j], shift))
                line[k] = np.uint8(np.int32(one + q * (two - one) + np.float32(0.5)))


@kernel
def _level(word: np.uint32, shift: np.uint32) -> np.float32:
    return np.float32((word >> shift) & np.uint32(255))
