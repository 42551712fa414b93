"""What the camera of a clip does in time: fields, sub-exposures for motion blur, gain."""

import math
from collections.abc import Sequence

import msgspec
import numpy as np
import numpy.typing as npt

Picture = npt.NDArray[np.float32]


class ShutterParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How a clip's brightness changes, and how finely motion blur is sampled.

    Parameters
    ----------
    swing_period, drift_period : float
        Periods of the swing of brightness and of the drift of white balance, s. Chosen by hand: no multiples of each
        other, and slow against a frame, as automatic exposure is.
    step_px : float
        Motion between two sub-exposures, px. Less: smoother blur, slower. Chosen by hand: less than two pixels, so that
        no sub-exposure shows as an edge of its own.
    most : int
        Most sub-exposures of an exposure.
    band_px : float
        Largest motion while a rolling shutter exposes the rows that are drawn together, px. Less: finer, slower. Chosen
        by hand: half of it is as far as an edge can be from its place, to one side as often as to the other.
    band_rows : int
        Most rows that are drawn together; even, for fields.
    """

    swing_period: float = 4.0
    drift_period: float = 9.0
    step_px: float = 1.5
    most: int = 16
    band_px: float = 0.1
    band_rows: int = 16


PARAMETERS = ShutterParameters()


class ShutterRows(msgspec.Struct, frozen=True):
    """The rows of a picture that are exposed together: start, start + step, ...

    Parameters
    ----------
    start, step : int
        (0, 1): all rows. (0, 2) and (1, 2): the two fields of an interlaced picture.
    """

    start: int = 0
    step: int = 1


ALL_ROWS = ShutterRows()


def fields(index: int, interlaced: bool) -> list[tuple[ShutterRows, float]]:
    """Rows that are exposed together, and the middle of their exposure.

    Parameters
    ----------
    index : int
        The frame's index.
    interlaced : bool
        Even rows a quarter of a frame before the frame's time, odd rows a quarter after it: at 30 frames per
        second the fields are 1/60 s apart.

    Returns
    -------
    list of (Rows, float)
        The time is in frames.
    """
    if not interlaced:
        return [(ShutterRows(), float(index))]
    return [(ShutterRows(0, 2), index - 0.25), (ShutterRows(1, 2), index + 0.25)]


def woven(pictures: Sequence[Picture]) -> Picture:
    """Weave the pictures of the times of `fields` into one; the first is written."""
    whole, count = pictures[0], len(pictures)
    for field in range(1, count):
        whole[field::count] = pictures[field][field::count]
    return whole


def read_out(y: float, height: int, readout: float) -> float:
    """Time at which a rolling shutter exposes a row, after the middle of the frame: readout ((y + 1/2) / height - 1/2).

    Parameters
    ----------
    y : float
        The row, px.
    height : int
        Of the picture, px.
    readout : float
        Time from the first row of the picture to the last, frames.

    Returns
    -------
    float
        Frames.
    """
    return readout * ((y + 0.5) / height - 0.5)


def bands(height: int, readout: float, pace: float) -> list[tuple[int, int, float]]:
    """Divide a picture into rows that a rolling shutter exposes nearly together.

    Parameters
    ----------
    height : int
        Of the picture, px.
    readout : float
        Time from the first row of the picture to the last, frames, more than 0.
    pace : float
        Fastest motion, px per frame.

    Returns
    -------
    list of (int, int, float)
        First row, the one after the last, and when the middle of the band is exposed, frames after that of the picture.
    """
    fit = PARAMETERS.band_px * height / max(readout * pace, 1e-9)
    rows = 2 * max(int(min(fit, PARAMETERS.band_rows) / 2.0), 1)
    ends = [(top, min(top + rows, height)) for top in range(0, height, rows)]
    return [(top, bottom, read_out(0.5 * (top + bottom - 1), height, readout)) for top, bottom in ends]


def sub_exposures(time: float, exposure: float, smear: float, most: int | None = None) -> list[float]:
    """Choose times whose pictures, averaged, are one exposure; their mean is its middle.

    Parameters
    ----------
    time : float
        Middle of the exposure, frames.
    exposure : float
        Its length, frames.
    smear : float
        Motion of the ball in it, px: one sub-exposure per 1.5 px, at most 16.
    most : int, optional
        At most this many instead.

    Returns
    -------
    list of float
        Frames.
    """
    count = min(max(math.ceil(smear / PARAMETERS.step_px), 1), PARAMETERS.most if most is None else most)
    return [time + exposure * ((i + 0.5) / count - 0.5) for i in range(count)]


def channel_gain(seconds: float, swing: float, drift: float) -> tuple[float, float, float]:
    """Gain of B, G and R at some time.

    Parameters
    ----------
    seconds : float
        Time in the clip, s.
    swing : float
        Largest over smallest brightness, in a sine wave (of its logarithm) of 4 s.
    drift : float
        Share by which blue rises and red falls, in a sine wave of 9 s.

    Returns
    -------
    tuple of 3 floats
        1 is unchanged.
    """
    level = swing ** (0.5 * math.sin(2.0 * math.pi * seconds / PARAMETERS.swing_period))
    tint = drift * math.sin(2.0 * math.pi * seconds / PARAMETERS.drift_period)
    return level * (1.0 + tint), level, level * (1.0 - tint)
