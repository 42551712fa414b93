"""Camera files: our own TOML, a unit on every line; ROS and OpenCV YAML are read by `camera_yaml.py`."""

import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from matchset.camera.lens import INTRINSICS
from matchset.image.errors import MissingFileError
from matchset.image.files.limits import LIMITS
from matchset.image.files.reading import read_limited
from matchset.image.files.whole_file import write_whole

Floats = npt.NDArray[np.float64]
Keys = dict[str, str]

_SIZES = "width", "height"
_MODEL = "distortion_model"
_PLUMB_BOB = "plumb_bob"
_MEANING = {
    "width": "px",
    "height": "px",
    "fx": "px, focal length along x",
    "fy": "px, focal length along y",
    "cx": "px, principal point; pixel centers lie at integers",
    "cy": "px",
    "k1": "no unit, radial",
    "k2": "no unit, radial",
    "p1": "no unit, tangential",
    "p2": "no unit, tangential",
    "k3": "no unit, radial",
}


def read_camera(path: Path) -> tuple[dict[str, Any], Keys]:
    """Read the numbers of a camera.

    Parameters
    ----------
    path : Path
        Our TOML (.toml), or ROS camera_info or OpenCV YAML (.yaml, .yml).

    Returns
    -------
    tuple of dict and dict
        The fields of `CameraModel`, and the key of the file that each came from.

    Raises
    ------
    ValueError
        If there is no such file (also a FileNotFoundError), it is none of these, or a number is missing; with the file
        and the key.
    """
    readers: dict[str, Callable[[str], tuple[dict[str, Any], Keys]]]
    readers = {".toml": _read_toml, ".yaml": _read_yaml, ".yml": _read_yaml}
    if path.suffix.lower() not in readers:
        raise ValueError(f"{path}: a camera file is .toml (matchset), .yaml or .yml (ROS, OpenCV)")
    try:
        text = read_limited(path, LIMITS.text, text=True).decode("utf-8-sig")
        return readers[path.suffix.lower()](text)
    except FileNotFoundError:
        raise MissingFileError(f"no such camera file: {path}") from None
    except OSError as error:
        raise ValueError(f"cannot read the camera file {path}: {error.strerror}") from error
    except UnicodeDecodeError:
        raise ValueError(f"{path}: not a text file") from None
    except ValueError as error:
        raise ValueError(f"{path}: {' '.join(str(error).split())}") from error


def _read_yaml(text: str) -> tuple[dict[str, Any], Keys]:
    """Read a YAML camera; its library is loaded only where there is one."""
    from matchset.camera.camera_yaml import read_yaml

    return read_yaml(text)


def _read_toml(text: str) -> tuple[dict[str, Any], Keys]:
    try:
        table = tomllib.loads(text)
    except RecursionError:
        raise ValueError("not a camera file, nested too deeply") from None
    model = table.pop(_MODEL, None)
    if model != _PLUMB_BOB:
        raise ValueError(f'{_MODEL} must be "{_PLUMB_BOB}" (k1, k2, p1, p2, k3), got {model!r}')
    deviations, correlations = table.pop("standard_deviation", None), table.pop("correlation", None)
    for name in (*_SIZES, *INTRINSICS):
        if name not in table:
            raise ValueError(f"{name} is missing")
    if foreign := set(table) - {*_SIZES, *INTRINSICS}:
        raise ValueError(f"{sorted(foreign)[0]} is not a key of a camera file")
    fields: dict[str, Any] = {name: table[name] for name in (*_SIZES, *INTRINSICS[:4])}
    fields["distortion"] = tuple(table[name] for name in INTRINSICS[4:])
    if deviations is not None:
        fields["intrinsics_covariance"] = _covariance(deviations, correlations)
    elif correlations is not None:
        raise ValueError("standard_deviation is missing, correlation needs it")
    return fields, {"intrinsics_covariance": "standard_deviation and correlation"}


def _covariance(deviations: object, correlations: object) -> tuple[tuple[float, ...], ...]:
    """Covariance from the two tables; without the second, the numbers are taken as independent."""
    spread = np.array(_numbers("standard_deviation", deviations, 1))[:, 0]
    if (spread < 0.0).any():
        raise ValueError(f"standard_deviation.{INTRINSICS[int(np.argmin(spread))]} must not be negative")
    matrix = np.eye(9) if correlations is None else np.array(_numbers("correlation", correlations, 9))
    if np.abs(np.diag(matrix) - 1.0).max() > 1e-6 or np.abs(matrix).max() > 1.0 + 1e-6:
        raise ValueError("correlation must lie between -1 and 1, with 1 of each number with itself")
    matrix = 0.5 * (matrix + matrix.T) if np.abs(matrix - matrix.T).max() < 1e-6 else matrix
    return tuple(tuple(row) for row in (matrix * np.outer(spread, spread)).tolist())


def _numbers(table_name: str, table: object, count: int) -> list[list[float]]:
    """Nine rows of `count` finite numbers from a table with a line for each of the intrinsics."""
    if not isinstance(table, dict):
        raise ValueError(f"{table_name} must be a table, got {table!r}")
    if foreign := set(table) - set(INTRINSICS):
        raise ValueError(f"{table_name}.{sorted(foreign)[0]} is not a key of a camera file")
    rows = []
    for name in INTRINSICS:
        if name not in table:
            raise ValueError(f"{table_name}.{name} is missing")
        row = table[name] if count > 1 else [table[name]]
        if not isinstance(row, list) or len(row) != count or not all(map(_is_finite, row)):
            wanted = "a finite number" if count == 1 else f"a list of {count} finite numbers"
            raise ValueError(f"{table_name}.{name} must be {wanted}, got {table[name]!r}")
        rows.append([float(value) for value in row])
    return rows


def _is_finite(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e100


def write_camera(path: Path, size: tuple[int, int], intrinsics: Floats, covariance: Floats | None) -> None:
    """Write a camera as TOML, whole or not at all.

    Parameters
    ----------
    path : Path
        The name must end in ``.toml``.
    size : tuple of int
        Width and height, px.
    intrinsics : ndarray of shape (9,), float64
    covariance : ndarray of shape (9, 9), float64, or None
        Of the intrinsics.

    Raises
    ------
    ValueError
        If the name has another ending.
    """
    if path.suffix.lower() != ".toml":
        raise ValueError(f"a camera file's name must end in .toml, got {str(path)!r}")
    write_whole(path, _toml(size, intrinsics, covariance).encode())


def _toml(size: tuple[int, int], intrinsics: Floats, covariance: Floats | None) -> str:
    lines = ["# A camera: the picture's size, the pinhole and OpenCV's five distortion coefficients.", ""]
    lines += [f"{name} = {value}  # {_MEANING[name]}" for name, value in zip(_SIZES, size, strict=True)]
    named = list(zip(INTRINSICS, intrinsics.tolist(), strict=True))
    lines += [f"{name} = {value!r}  # {_MEANING[name]}" for name, value in named[:4]]
    lines += [f'{_MODEL} = "{_PLUMB_BOB}"  # no unit, the five coefficients that follow']
    lines += [f"{name} = {value!r}  # {_MEANING[name]}" for name, value in named[4:]]
    if covariance is None:
        return "\n".join(lines) + "\n"
    spread = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    lines += ["", "# How far the numbers above may be off, one sigma.", "[standard_deviation]"]
    for name, value in zip(INTRINSICS, spread.tolist(), strict=True):
        lines.append(f"{name} = {value!r}  # {_MEANING[name].split(',')[0]}")
    order = ", ".join(INTRINSICS)
    lines += ["", f"# How they are off together; columns: {order}.", "[correlation]"]
    divisor = np.where(spread > 0.0, spread, 1.0)
    matrix = covariance / np.outer(divisor, divisor)
    matrix[np.diag_indices(9)] = 1.0
    for name, row in zip(INTRINSICS, matrix.tolist(), strict=True):
        lines.append(f"{name} = [{', '.join(_correlation(value) for value in row)}]  # no unit")
    return "\n".join(lines) + "\n"


def _correlation(value: float) -> str:
    return repr(round(min(max(value, -1.0), 1.0), 9) + 0.0)
