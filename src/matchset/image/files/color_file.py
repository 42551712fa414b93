"""Color models in files: the table of log-odds, the kind of the model and how the ball looked, as a NumPy archive."""

import io
import math
import zipfile
from pathlib import Path
from typing import Any, NamedTuple, cast

import numpy as np
import numpy.typing as npt

from matchset.image.brightness import Gray
from matchset.image.circle_score import Sample
from matchset.image.errors import MissingFileError
from matchset.image.files.limits import LIMITS
from matchset.image.files.reading import read_limited
from matchset.image.files.whole_file import write_whole

VERSION = 1  # format: of a color file
GRAY_LEVELS = 256  # format: entries of a table for gray pixels


class ColorFile(NamedTuple):
    """What a file holds.

    Attributes
    ----------
    log_odds : ndarray of shape (32768,) or (256,), float32
    gray : str
        See `ColorModel`.
    sample : Sample or None
        None in files of several colors, and of versions before it.
    is_local, is_hollow : bool
        See `ColorModel`; not so in files of versions before them.
    """

    log_odds: npt.NDArray[np.float32]
    gray: Gray
    sample: Sample | None
    is_local: bool = False
    is_hollow: bool = False


def write_color(path: Path, color: ColorFile) -> None:
    """Write a color model, whole or not at all.

    Parameters
    ----------
    path : Path
    color : ColorFile
    """
    arrays: dict[str, Any] = {"log_odds": color.log_odds, "gray": np.array(color.gray)}
    if color.sample is not None:
        image, circle, radius = color.sample
        arrays |= {"sample": image, "circle": np.array((*circle, radius))}
    arrays |= {name: np.array(True) for name in ("is_local", "is_hollow") if getattr(color, name)}
    archive = io.BytesIO()
    np.savez_compressed(archive, matchset_color=np.int64(VERSION), **arrays)
    write_whole(path, archive.getvalue())


def read_color(path: Path) -> ColorFile:
    """Read what `write_color` wrote.

    Parameters
    ----------
    path : Path

    Returns
    -------
    ColorFile
        Its table may be of any shape: `ColorModel` says whether it is one.

    Raises
    ------
    ValueError
        If it is no color model, or of another version; if there is no such file, also a FileNotFoundError.
    """
    try:
        packed = io.BytesIO(read_limited(path, LIMITS.color))
        with zipfile.ZipFile(packed) as names:
            if sum(each.file_size for each in names.infolist()) > LIMITS.color:
                raise ValueError(f"it unpacks to more than {LIMITS.color / 1e6:g} MB")
        with np.load(packed, allow_pickle=False) as archive:
            version, log_odds = int(archive["matchset_color"]), np.asarray(archive["log_odds"])
            gray = str(archive["gray"]) if "gray" in archive else ""
            sample = _sample(archive["sample"], archive["circle"]) if "sample" in archive else None
            is_local, is_hollow = (name in archive and bool(archive[name]) for name in ("is_local", "is_hollow"))
            if sample is not None and sample.image.shape[2] == 1 and log_odds.size != GRAY_LEVELS:
                raise ValueError("its sample is gray, its table is not")
        if version == VERSION and gray in ("", "dark", "light", "edges"):
            return ColorFile(log_odds, cast(Gray, gray), sample, is_local, is_hollow)
    except FileNotFoundError:
        raise MissingFileError(f"no such color file: {path}") from None
    except Exception as error:  # whatever NumPy and zipfile make of a foreign file
        words = " ".join(str(error).split())
        raise ValueError(f"not a color file: {path} ({words or type(error).__name__})") from error
    raise ValueError(f"color file {path} has version {version}, this matchset reads version {VERSION}")


def _sample(image: npt.NDArray[Any], circle: npt.NDArray[Any]) -> Sample:
    """Check what is said to be a picture around a circle (ValueError)."""
    x, y, inner, radius = np.asarray(circle, np.float64).tolist()
    if image.dtype != np.uint8 or image.ndim != 3 or image.shape[2] not in (1, 3) or not image.size:  # theorem: h, w, 3
        raise ValueError(f"its sample is no picture but {image.dtype} of shape {image.shape}")
    largest = min(2.0 * max(image.shape), radius)  # geometry: the sample holds the middle of its circle
    if not (-inner < x < image.shape[1] + inner and -inner < y < image.shape[0] + inner and 0.0 < inner <= largest):
        raise ValueError(f"its circle {(x, y, inner, radius)} is not in its sample")
    if not math.isfinite(radius):
        raise ValueError(f"its circle has a radius of {radius}")
    return Sample(image, (x, y, inner), radius)
