"""What a lens that distorts makes of a pinhole camera's picture: `ExactLensWarp` and `FastLensWarp`.

The exact one averages nine samples of a finer picture for each pixel. The fast one works on a field of packed pixels:
the room is warped as OpenCV's ``remap`` does it, bilinear with places in 1/32 px, bit for bit. It first copies the four
pixels around each place of a line side by side, so that what is computed of them takes several places at a time.
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
Whole = npt.NDArray[np.int32]
Singles = npt.NDArray[np.float32]

# format: two bytes of a packed pixel at once, and 2 in each, to round quarters
_PAIR, _TWOS = np.uint32(0x00FF00FF), np.uint32(0x00020002)
_BYTE = np.uint32(0xFF)  # format: a byte of a packed pixel


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


class WarpPlaces(NamedTuple):
    """Where pixels of a row look into a window, to work in.

    Parameters
    ----------
    inside : (n,)
        Whether they do: 1 or 0.
    at : (n,)
        Pixel of the window, counted through; 0 where they do not.
    shares : (2, n)
        How far beyond its middle, along x and y, 0 ... 1.
    """

    inside: Whole
    at: PackedPixels
    shares: Singles


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
        counted = places[..., 1] * (self.width // 2) + places[..., 0]
        self._places = (counted << 10 | shares.astype(np.int64)).astype(np.uint32)
        self.columns = _columns(places, self.height, self.width // 2)
        rows_seen = np.column_stack((down.min(axis=1), down.max(axis=1)))
        self._maps = WindowMaps(across, down, rows_seen, np.column_stack((across.min(axis=0), across.max(axis=0))))

    def warp(self, room: PackedPixels, frame: PackedPixels) -> None:
        """Warp a picture with half the columns, and widen it, into the field's lines of a frame.

        Parameters
        ----------
        room : ndarray of shape (height, width // 2), uint32
        frame : ndarray of shape (h, w), uint32
            Written.
        """
        _warp(room, self._places, frame, (self._field, self._fields))

    def warp_window(self, window: PackedPixels, left: int, top: int, frame: PackedPixels) -> None:
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
def _warp(room: PackedPixels, places: PackedPixels, frame: PackedPixels, rows: tuple[int, int]) -> None:
    """Write some rows (first, step) of a frame: the room at places, px, counted through and in 1/32 down and across."""
    start, step = rows
    around = np.empty((4, places.shape[1]), np.uint32)
    for r in range(places.shape[0]):
        _look_around(room, places[r], np.uint32(10), around)
        _mix(around, places[r], frame[start + r * step])


@kernel
def _look_around(picture: PackedPixels, places: PackedPixels, parts: np.uint32, around: PackedPixels) -> None:
    """Copy the pixel at each place of a row, that to its right, that below, and that below to the right.

    Places have so many binary digits after the whole ones, `parts`.
    """
    flat, below, one = picture.reshape(picture.size), np.uint64(picture.shape[1]), np.uint64(1)
    here, right, under, across = around[0], around[1], around[2], around[3]
    for x in range(places.shape[0]):
        at = np.uint64(places[x] >> parts)
        here[x], right[x] = flat[at], flat[at + one]
        under[x], across[x] = flat[at + below], flat[at + below + one]


@kernel
def _mix(around: PackedPixels, places: PackedPixels, line: PackedPixels) -> None:
    """Write a row: of four pixels each their mean with weights in 1/32, rounded; B and R at once along the rows."""
    here, right, under, across = around[0], around[1], around[2], around[3]
    one, five, eight, sixteen = np.uint32(32), np.uint32(5), np.uint32(8), np.uint32(16)
    for x in range(line.shape[0]):
        p, q = places[x] & np.uint32(31), (places[x] >> five) & np.uint32(31)
        a, b, c, d = here[x], right[x], under[x], across[x]
        above = np.uint32((one - p) * (a & _PAIR)) + np.uint32(p * (b & _PAIR))
        below = np.uint32((one - p) * (c & _PAIR)) + np.uint32(p * (d & _PAIR))
        above_green = np.uint32((one - p) * ((a >> eight) & _BYTE)) + np.uint32(p * ((b >> eight) & _BYTE))
        below_green = np.uint32((one - p) * ((c >> eight) & _BYTE)) + np.uint32(p * ((d >> eight) & _BYTE))
        blue = _byte_of(above & np.uint32(0xFFFF), below & np.uint32(0xFFFF), q)
        red = _byte_of(above >> sixteen, below >> sixteen, q)
        line[x] = blue | (_byte_of(above_green, below_green, q) << eight) | (red << sixteen)


@kernel
def _byte_of(above: np.uint32, below: np.uint32, share: np.uint32) -> np.uint32:
    """Mean of two numbers of 32 times a byte's size, weighed in 1/32: a byte."""
    total = np.uint32(np.uint32((np.uint32(32) - share) * above) + np.uint32(share * below))
    return np.uint32(np.uint32(total + np.uint32(512)) >> np.uint32(10))


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
    window: PackedPixels, corner: tuple[int, int], maps: WindowMaps, frame: PackedPixels, rows: tuple[int, int]
) -> None:
    """Write what a part of the full picture shows into some rows (first, step) of a frame."""
    (left, top), (start, step) = corner, rows
    right, bottom = left + window.shape[1] - 1, top + window.shape[0] - 1
    first, last = maps.column_range.shape[0], -1
    for x in range(maps.column_range.shape[0]):
        if maps.column_range[x, 1] >= left and maps.column_range[x, 0] < right:
            first, last = min(first, x), x
    count = max(last + 1 - first, 0)
    around = np.empty((4, count), np.uint32)
    places = WarpPlaces(np.empty(count, np.int32), np.empty(count, np.uint32), np.empty((2, count), np.float32))
    for r in range(maps.row_range.shape[0]):
        if maps.row_range[r, 1] < top or maps.row_range[r, 0] >= bottom:
            continue
        across, down = maps.across[r, first : last + 1], maps.down[r, first : last + 1]
        _find_places(across, down, corner, window.shape, places)
        _look_around(window, places.at, np.uint32(0), around)
        _mix_inside(around, places, frame[start + r * step, first : last + 1])


@kernel
def _find_places(
    across: Singles, down: Singles, corner: tuple[int, int], shape: tuple[int, int], places: WarpPlaces
) -> None:
    """Write where the pixels of a row look into a window, of which the upper left corner and the shape are given."""
    left, top = np.int32(corner[0]), np.int32(corner[1])
    wide = np.int32(shape[1])
    right, bottom = np.float32(left + wide - 1), np.float32(top + np.int32(shape[0]) - 1)
    least_x, least_y, inside, at = np.float32(left), np.float32(top), places.inside, places.at
    along, along_y = places.shares[0], places.shares[1]
    for x in range(across.shape[0]):
        at_x, at_y = across[x], down[x]
        seen = (at_x >= least_x) & (at_x < right) & (at_y >= least_y) & (at_y < bottom)
        j, i = np.int32(at_x), np.int32(at_y)
        along[x], along_y[x] = at_x - np.float32(j), at_y - np.float32(i)
        inside[x] = np.int32(seen)
        at[x] = np.uint32(np.int32(np.int32(i - top) * wide) + np.int32(j - left)) if seen else np.uint32(0)


@kernel
def _mix_inside(around: PackedPixels, places: WarpPlaces, line: PackedPixels) -> None:
    """Write those pixels of a row that look into a window: of four of its pixels each their mean, rounded."""
    here, right, under, across = around[0], around[1], around[2], around[3]
    inside, along, along_y = places.inside, places.shares[0], places.shares[1]
    for x in range(line.shape[0]):
        four, p, q = (here[x], right[x], under[x], across[x]), along[x], along_y[x]
        word = _mean(four, p, q, np.uint32(0))
        word |= _mean(four, p, q, np.uint32(8))
        word |= _mean(four, p, q, np.uint32(16))
        line[x] = word if inside[x] else line[x]


@kernel
def _mean(
    four: tuple[np.uint32, np.uint32, np.uint32, np.uint32], p: np.float32, q: np.float32, shift: np.uint32
) -> np.uint32:
    """Bilinear mean of one color of four packed pixels, in its place."""
    a, b, c, d = four
    one = _level(a, shift) + p * (_level(b, shift) - _level(a, shift))
    two = _level(c, shift) + p * (_level(d, shift) - _level(c, shift))
    return np.uint32(np.uint32(np.int32(one + q * (two - one) + np.float32(0.5))) << shift)


@kernel
def _level(word: np.uint32, shift: np.uint32) -> np.float32:
    return np.float32(np.int32((word >> shift) & _BYTE))
