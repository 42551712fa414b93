"""What the camera of a clip does in time: fields, sub-exposures for motion blur, gain."""

import math

import msgspec


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
    """

    swing_period: float = 4.0
    drift_period: float = 9.0
    step_px: float = 1.5
    most: int = 16


PARAMETERS = ShutterParameters()


class Rows(msgspec.Struct, frozen=True):
    """The rows of a picture that are exposed together: start, start + step, ...

    Parameters
    ----------
    start, step : int
        (0, 1): all rows. (0, 2) and (1, 2): the two fields of an interlaced picture.
    """

    start: int = 0
    step: int = 1


ALL_ROWS = Rows()


def fields(index: int, interlaced: bool) -> list[tuple[Rows, float]]:
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
        return [(Rows(), float(index))]
    return [(Rows(0, 2), index - 0.25), (Rows(1, 2), index + 0.25)]


def read_out(top: int, rows: int, height: int, readout: float) -> float:
    """Time at which a rolling shutter exposes some rows, after the middle of the frame.

    Row y is exposed ``readout ((y + 1/2) / height - 1/2)`` after it.

    Parameters
    ----------
    top, rows : int
        The first of the rows, and how many.
    height : int
        Of the picture, px.
    readout : float
        Time from the first row of the picture to the last, frames.

    Returns
    -------
    float
        Frames: that of the middle of the rows.
    """
    return readout * ((top + 0.5 * rows) / height - 0.5)


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
