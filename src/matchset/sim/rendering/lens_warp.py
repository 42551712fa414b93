"""What a lens that distorts makes of a picture: `ExactLensWarp`."""

import math

import cv2
import numpy as np
import numpy.typing as npt

from matchset.camera.camera_model import CameraModel
from matchset.numeric.jit import kernel
from matchset.sim.rendering.background import PackedPixels, Pinhole
from matchset.sim.rendering.renderer import Picture

_FINER = 2.0  # the pinhole picture has so many pixels for one of the camera's, along x and along y
_SAMPLES = 3  # places per pixel, along x and along y
_WIDEST = 1.5  # largest |X / Z| that is rendered


class ExactLensWarp:
    """Sees a scene through a camera's lens: rendered by a finer and wider pinhole camera, then bent.

    Every pixel is the mean of 3 x 3 bilinear samples of the pinhole picture. Where the lens has no direction the
    picture is black. Without distortion the pinhole camera is the camera, and nothing is bent.

    Parameters
    ----------
    camera : CameraModel
        Whose lens it is.

    Attributes
    ----------
    pinhole : CameraModel
        The camera to render with.
    """

    def __init__(self, camera: CameraModel) -> None:
        self.camera, self.pinhole = camera, camera
        self._maps: list[tuple[npt.NDArray[np.float32], npt.NDArray[np.float32]]] = []
        if any(camera.distortion):
            self._plan()

    def _plan(self) -> None:
        shape = self.camera.height, self.camera.width
        rows, columns = np.indices(shape).reshape(2, -1).astype(np.float64)
        rays = self.camera.rays(np.column_stack((columns, rows)))
        with np.errstate(invalid="ignore"):
            slopes = [(rays[:, k] / rays[:, 2]).reshape(shape) for k in range(2)]
        right, below = (min(float(np.nanmax(np.abs(slope))), _WIDEST) for slope in slopes)
        focal = _FINER * self.camera.fx
        width, height = 2 * math.ceil(focal * right) + 8, 2 * math.ceil(focal * below) + 8
        self.pinhole = CameraModel(
            width=width, height=height, fx=focal, fy=focal, cx=(width - 1) / 2.0, cy=(height - 1) / 2.0
        )
        shifts = (np.arange(_SAMPLES) + 0.5) / _SAMPLES - 0.5
        bends = [np.gradient(slope) for slope in slopes]
        for down in shifts:
            for across in shifts:
                places = [
                    focal * (slope + down * bend[0] + across * bend[1]) + center
                    for slope, bend, center in zip(slopes, bends, (self.pinhole.cx, self.pinhole.cy), strict=True)
                ]
                maps = [np.nan_to_num(place, nan=-1e4).astype(np.float32) for place in places]
                self._maps.append((maps[0], maps[1]))

    def bend(self, picture: Picture) -> Picture:
        """Bend a picture of the pinhole camera.

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


Bytes = npt.NDArray[np.uint8]
Ints = npt.NDArray[np.int64]
Longs = npt.NDArray[np.uint64]
Singles = npt.NDArray[np.float32]

_BYTE, _FRACTION = np.uint64(0xFF), np.uint64(31)
_ONE, _HALF = np.uint64(32), np.uint64(512 | 512 << 20 | 512 << 40)  # of 32 * 32 = 1024
_PAIR, _TWOS = np.uint32(0x00FF00FF), np.uint32(0x00020002)


class FastLensWarp:
    """The pinhole that draws a field, in full and with half the columns, and how its picture is bent.

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
        self._x, self._y = x.astype(np.float32), y.astype(np.float32)
        whole, shares = cv2.convertMaps(((x - 0.5) / 2.0).astype(np.float32), self._y, cv2.CV_16SC2)
        places = whole.astype(np.int64)
        self._places = (places[..., 1] * (self.width // 2) + places[..., 0]).astype(np.uint32)
        self._shares = shares.astype(np.uint32)
        self.columns = _columns(places, self.height, self.width // 2)
        self._row_reach = np.column_stack((self._y.min(axis=1), self._y.max(axis=1)))
        self._column_reach = np.column_stack((self._x.min(axis=0), self._x.max(axis=0)))

    def bend(self, room: PackedPixels, spread: Longs, frame: Bytes) -> None:
        """Bend a picture with half the columns, and widen it, into the field's lines of a frame.

        Parameters
        ----------
        room : ndarray of shape (height, width // 2), uint32
        spread : the same, uint64
            To work in.
        frame : ndarray of shape (h, w, 3), uint8
            BGR; written.
        """
        bend(room, spread, self._places, self._shares, frame, self._field, self._fields)

    def bend_patch(self, patch: PackedPixels, left: int, top: int, frame: Bytes) -> None:
        """Bend a part of the full picture, whose upper left pixel is (left, top), into the field's lines of a frame."""
        maps = self._x, self._y, self._row_reach, self._column_reach
        bend_patch(patch, left, top, *maps, frame, self._field, self._fields)


def _columns(places: Ints, height: int, width: int) -> Ints:
    """First and last column that each line of a picture lends to places and their neighbors, and 2 px more."""
    columns = np.empty((height, 2), np.int64)
    columns[:, 0], columns[:, 1] = width, -1
    for down in (0, 1):
        np.minimum.at(columns[:, 0], places[..., 1] + down, np.maximum(places[..., 0] - 2, 0))
        np.maximum.at(columns[:, 1], places[..., 1] + down, np.minimum(places[..., 0] + 3, width - 1))
    return columns


@kernel
def spread_word(word: np.uint64) -> np.uint64:
    """Move B, G and R of a pixel 20 bits apart."""
    green, red = (word & np.uint64(0xFF00)) << np.uint64(12), (word & np.uint64(0xFF0000)) << np.uint64(24)
    return (word & _BYTE) | green | red


@kernel
def bend(
    room: PackedPixels,
    spread: Longs,
    places: PackedPixels,
    shares: PackedPixels,
    frame: Bytes,
    start: int,
    step: int,
) -> None:
    """Write lines start, start + step, ... of a frame: the room at places (px, counted through) and shares."""
    height, width = room.shape
    for y in range(height):
        line, out = room[y], spread[y]
        for x in range(width):
            out[x] = spread_word(np.uint64(line[x]))
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
def widen(room: PackedPixels, left: int, top: int, patch: PackedPixels) -> None:
    """Write a part of the full picture, from an even column on, that shows the room's: 3/4 and 1/4 of neighbors."""
    for y in range(patch.shape[0]):
        line, out = room[top + y, left // 2 : (left + patch.shape[1]) // 2], patch[y]
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
def bend_patch(
    patch: PackedPixels,
    left: int,
    top: int,
    across: Singles,
    down: Singles,
    row_reach: Singles,
    column_reach: Singles,
    frame: Bytes,
    start: int,
    step: int,
) -> None:
    """Write what a part of the full picture shows into lines start, start + step, ... of a frame.

    `across` and `down` tell where each pixel looks in the full picture, `row_reach` and `column_reach` the least and
    the most of them in each line and column.
    """
    right, bottom = left + patch.shape[1] - 1, top + patch.shape[0] - 1
    first, last = column_reach.shape[0], -1
    for x in range(column_reach.shape[0]):
        if column_reach[x, 1] >= left and column_reach[x, 0] < right:
            first, last = min(first, x), x
    for r in range(row_reach.shape[0]):
        if row_reach[r, 1] < top or row_reach[r, 0] >= bottom:
            continue
        for x in range(first, last + 1):
            at_x, at_y = across[r, x], down[r, x]
            if at_x < left or at_x >= right or at_y < top or at_y >= bottom:
                continue
            j, i = int(at_x), int(at_y)
            p, q = at_x - np.float32(j), at_y - np.float32(i)
            j, i = j - left, i - top
            above, below, line = patch[i], patch[i + 1], frame[start + r * step, x]
            for k in range(3):
                shift = np.uint32(8 * k)
                one = _level(above[j], shift) + p * (_level(above[j + 1], shift) - _level(above[j], shift))
                two = _level(below[j], shift) + p * (_level(below[j + 1], shift) - _level(below[j], shift))
                line[k] = np.uint8(np.int32(one + q * (two - one) + np.float32(0.5)))


@kernel
def _level(word: np.uint32, shift: np.uint32) -> np.float32:
    return np.float32((word >> shift) & np.uint32(255))
