"""Camera files of others: ROS `camera_info` (file or message) and OpenCV's YAML. Only what is certain is taken.

Both name the size, a 3 x 3 camera matrix (fx 0 cx, 0 fy cy, 0 0 1) and distortion coefficients in OpenCV's order; both
have pixel centers at integers. A lens that five coefficients do not describe, and a picture that is a part of the
sensor's, are refused.
"""

import math
from typing import Any

import yaml

from matchset.image.files.limits import LIMITS

Keys = dict[str, str]


class TooManyValuesError(Exception):
    """A document of more values than are allowed."""


_WIDTH = "image_width", "width", "image_Width"
_HEIGHT = "image_height", "height", "image_Height"
_MATRIX = "camera_matrix", "K", "k", "cameraMatrix", "Camera_Matrix"
_COEFFICIENTS = "distortion_coefficients", "D", "d", "distCoeffs", "dist_coeffs", "Distortion_Coefficients"
_MODEL = "distortion_model", "camera_model"
_FIVE = {"plumb_bob", "radtan", "rational_polynomial", "pinhole", ""}
_FISHEYE = "fisheye_model", "fisheye"
_BINNING = "binning_x", "binning_y"


def read_yaml(text: str) -> tuple[dict[str, Any], Keys]:
    """Read a camera of ROS or OpenCV from a text, as `camera_toml.read_camera` returns it; its first document counts.

    Raises
    ------
    ValueError
        If it is not YAML, something is missing or cannot be, or the camera is of another kind; with the key.
    """
    table = _mapping(text)
    _check_kind(table)
    fields: dict[str, Any] = {}
    keys: Keys = {}
    for name, names in (("width", _WIDTH), ("height", _HEIGHT)):
        keys[name] = _key(table, names)
        fields[name] = _whole(keys[name], table[keys[name]])
    key = _key(table, _MATRIX)
    matrix = _numbers(key, table[key], (9,))
    if matrix[1] != 0.0 or matrix[3] != 0.0 or matrix[6:] != [0.0, 0.0, 1.0]:
        raise ValueError(f"{key} must be fx 0 cx, 0 fy cy, 0 0 1, got {matrix}")
    for name, place in (("fx", 0), ("cx", 2), ("fy", 4), ("cy", 5)):
        fields[name], keys[name] = matrix[place], key
    key = _key(table, _COEFFICIENTS)
    values = _numbers(key, table[key], (0, 4, 5, 8, 12, 14))
    if any(values[5:]):
        raise ValueError(f"{key} has more than k1, k2, p1, p2, k3: calibrate with five coefficients, got {values}")
    fields["distortion"] = tuple([*values, 0.0, 0.0, 0.0, 0.0, 0.0][:5])
    keys.update(dict.fromkeys(("distortion", "k1", "k2", "p1", "p2", "k3"), key))
    return fields, keys


def _mapping(text: str) -> dict[str, Any]:
    """Read the first document; every value stays a string, so nothing is guessed (1e-05 is no number in YAML)."""
    if text.startswith("%YAML"):  # OpenCV's "%YAML:1.0" is no directive of YAML
        text = text.partition("\n")[2]
    try:
        # Of several documents (`rostopic echo` ends each message with ---) only the first is read.
        table = _first_document(text)
    except TooManyValuesError:
        raise ValueError(f"not a camera file, it holds more than {LIMITS.nodes} values") from None
    except RecursionError:
        raise ValueError("not a camera file, nested too deeply") from None
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        place = "" if mark is None else f" in line {mark.line + 1}"
        raise ValueError(f"not YAML{place}: {getattr(error, 'problem', None) or error}") from error
    except (OverflowError, ValueError):  # PyYAML does not look at the number of a character before it makes it
        raise ValueError("not YAML: an escape names no character") from None
    if not isinstance(table, dict):
        raise ValueError("not a camera file, it holds no keys")
    return table


def _first_document(text: str) -> object:
    """Compose the first document, count its values with all aliases written out, and only then make them."""
    loader = yaml.BaseLoader(text)
    try:
        node = loader.get_node() if loader.check_node() else None
        if node is None:
            return None
        if _values(node, {}) > LIMITS.nodes:
            raise TooManyValuesError
        return loader.construct_document(node)
    finally:
        loader.dispose()


def _values(node: yaml.Node, known: dict[int, float]) -> float:
    """Count the values of a node, infinite for one that holds itself."""
    if id(node) in known:
        return known[id(node)]
    known[id(node)] = math.inf  # until it is counted: what refers to it meanwhile is inside of it
    inside = node.value if isinstance(node, yaml.CollectionNode) else []
    parts = [part for each in inside for part in (each if isinstance(each, tuple) else (each,))]
    known[id(node)] = 1.0 + sum(_values(part, known) for part in parts)
    return known[id(node)]


def _check_kind(table: dict[str, Any]) -> None:
    """Refuse other lens models, and pictures that are binned or cut out of the sensor's."""
    for key in _MODEL:
        if str(table.get(key, "")) not in _FIVE:
            raise ValueError(f"{key} must be plumb_bob (k1, k2, p1, p2, k3), got {table[key]!r}")
    for key in _FISHEYE:
        if str(table.get(key, "0")).lower() not in ("0", "false"):
            raise ValueError(f"{key} must be 0, a fisheye lens has other coefficients, got {table[key]!r}")
    for key in _BINNING:
        if str(table.get(key, "0")) not in ("0", "1"):
            raise ValueError(f"{key} must be 0 or 1, the numbers are those of the whole picture, got {table[key]!r}")
    roi = table.get("roi")
    for key in ("x_offset", "y_offset"):
        if isinstance(roi, dict) and str(roi.get(key, "0")) != "0":
            raise ValueError(f"roi.{key} must be 0, the numbers are those of the whole picture, got {roi[key]!r}")


def _key(table: dict[str, Any], names: tuple[str, ...]) -> str:
    for name in names:
        if name in table:
            return name
    raise ValueError(f"{names[0]} is missing")


def _whole(key: str, value: object) -> int:
    number = _number(key, value)
    if number != math.floor(number):
        raise ValueError(f"{key} must be a whole number of px, got {value!r}")
    return int(number)


def _numbers(key: str, value: object, counts: tuple[int, ...]) -> list[float]:
    """Numbers of a plain list, a list of rows, or a matrix with `data`."""
    if isinstance(value, dict):
        if "data" not in value:
            raise ValueError(f"{key}.data is missing")
        key, value = f"{key}.data", value["data"]
    if not isinstance(value, list):
        raise ValueError(f"{key} must be a list of numbers, got {value!r}")
    flat = [item for row in value for item in (row if isinstance(row, list) else [row])]
    if len(flat) not in counts:
        raise ValueError(f"{key} must have {' or '.join(map(str, counts))} numbers, got {len(flat)}")
    return [_number(key, item) for item in flat]


def _number(key: str, value: object) -> float:
    try:
        number = float(str(value))
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise ValueError(f"{key} must hold finite numbers, got {value!r}")
    return number
