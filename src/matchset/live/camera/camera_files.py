"""Camera files of a folder, and those that a page uploads: `find_camera_files`, `read_camera_file`."""

import re
import tempfile
from pathlib import Path
from typing import NamedTuple

import msgspec

from matchset.camera.camera_model import CameraModel

NAMES = re.compile(r".*camera.*\.(toml|ya?ml)|ost\.ya?ml", re.IGNORECASE)
"""Names of camera files: ours, and what ROS and OpenCV call theirs."""


class CameraFileParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How far camera files are looked for.

    Parameters
    ----------
    files : int
        Files at most. Chosen by hand: what one scrolls through on a phone.
    runs : str
        Pattern of those that `matchset calibrate` wrote.
    """

    files: int = 20
    runs: str = "runs/*/*camera*.toml"


class CameraFile(NamedTuple):
    """A camera file that was read.

    Attributes
    ----------
    path : Path
    camera : CameraModel
    """

    path: Path
    camera: CameraModel


def find_camera_files(folder: Path, parameters: CameraFileParameters | None = None) -> list[CameraFile]:
    """Find the camera files of a folder and of its runs, newest first; what is none is left out.

    Parameters
    ----------
    folder : Path
    parameters : CameraFileParameters, optional
    """
    limits = parameters or CameraFileParameters()
    try:
        own = [path for path in folder.iterdir() if NAMES.fullmatch(path.name)]
        named = [(path.stat().st_mtime, path) for path in (*own, *folder.glob(limits.runs)) if path.is_file()]
    except OSError:
        return []
    found = []
    for _, path in sorted(named, reverse=True)[: limits.files]:
        try:
            found.append(CameraFile(path, CameraModel.load(path)))
        except ValueError:  # another program's file of a similar name
            continue
    return found


def read_camera_file(name: str, data: bytes) -> CameraModel:
    """Read a camera file that was uploaded.

    Parameters
    ----------
    name : str
        As the other computer calls it; its ending says what it is.
    data : bytes

    Raises
    ------
    ValueError
        If it is none; in words, with this name.
    """
    ending = Path(name).suffix.lower()
    if ending not in (".toml", ".yaml", ".yml"):
        raise ValueError(f"a camera file ends in .toml, .yaml or .yml, got {name[-60:]!r}")
    with tempfile.TemporaryDirectory(prefix="matchset-") as folder:
        path = Path(folder) / f"camera{ending}"
        path.write_bytes(data)
        try:
            return CameraModel.load(path)
        except ValueError as error:
            raise ValueError(str(error).replace(str(path), name[-60:])) from None
