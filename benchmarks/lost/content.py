"""How much of a file can be read: `content_of`."""

import json
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np

from matchset.app.locate.rows import read_poses
from matchset.app.track.rows import read_tracks
from matchset.flight.recording.reader import RecordingReader
from matchset.image.color import ColorModel

FILMS = ".webm", ".mp4", ".avi"


class Content(NamedTuple):
    """What can be read of a file.

    Attributes
    ----------
    number : int
        Rows, pictures or steps; 1 for a file of one piece.
    rate : float
        Pictures per second of a film; 0 for other files, and for a film of fewer than two pictures.
    """

    number: int
    rate: float = 0.0


def content_of(path: Path) -> Content:
    """Read a file to its end.

    Raises
    ------
    ValueError
        If something in it cannot be read.
    """
    if path.suffix in FILMS:
        return _film(path)
    if path.name == "latency.csv":
        return Content(len(path.read_text(encoding="utf-8").splitlines()) - 1)
    if path.suffix == ".csv":
        return Content(len((read_tracks if path.name == "tracks.csv" else read_poses)(path)))
    if path.suffix == ".jsonl":
        return Content(len([json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]))
    if path.suffix == ".mcap":
        return Content(sum(1 for _ in RecordingReader(path)))
    if path.suffix == ".npz":
        ColorModel.load(path)
    elif path.suffix == ".png":
        if cv2.imread(str(path)) is None:
            raise ValueError(f"{path} does not decode")
    elif not path.read_text(encoding="utf-8").endswith("</html>\n"):
        raise ValueError(f"{path} is cut off")
    return Content(1)


def _film(path: Path) -> Content:
    video = cv2.VideoCapture(str(path))
    if not video.isOpened():
        raise ValueError(f"{path} cannot be opened")
    stamps = []
    while video.grab():
        stamps.append(video.get(cv2.CAP_PROP_POS_MSEC))
    video.release()
    rate = 1000.0 / float(np.median(np.diff(stamps))) if len(stamps) > 1 else 0.0
    return Content(len(stamps), rate)
