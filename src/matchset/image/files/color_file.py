"""Color models in files: the table of log-odds and the kind of the model, as a NumPy archive."""

import io
import zipfile
from pathlib import Path
from typing import cast

import numpy as np
import numpy.typing as npt

from matchset.image.brightness import Gray
from matchset.image.errors import MissingFileError
from matchset.image.files.limits import LIMITS
from matchset.image.files.reading import read_limited
from matchset.image.files.whole_file import write_whole

VERSION = 1  # format: of a color file


def write_color(path: Path, log_odds: npt.NDArray[np.float32], gray: Gray) -> None:
    """Write a color model, whole or not at all.

    Parameters
    ----------
    path : Path
    log_odds : ndarray of shape (32768,) or (256,), float32
    gray : str
        See `ColorModel`.
    """
    archive = io.BytesIO()
    np.savez_compressed(archive, matchset_color=np.int64(VERSION), log_odds=log_odds, gray=gray)
    write_whole(path, archive.getvalue())


def read_color(path: Path) -> tuple[npt.NDArray[np.float32], Gray]:
    """Read what `write_color` wrote.

    Parameters
    ----------
    path : Path

    Returns
    -------
    log_odds : ndarray
        Of any shape: `ColorModel` says whether it is a table.
    gray : str

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
        if version == VERSION and gray in ("", "dark", "light", "edges"):
            return log_odds, cast(Gray, gray)
    except FileNotFoundError:
        raise MissingFileError(f"no such color file: {path}") from None
    except Exception as error:  # whatever NumPy and zipfile make of a foreign file
        words = " ".join(str(error).split())
        raise ValueError(f"not a color file: {path} ({words or type(error).__name__})") from error
    raise ValueError(f"color file {path} has version {version}, this matchset reads version {VERSION}")
