"""A picture of a video in which little was found: what its run has drawn, or its first frame without a ball."""

import csv
import io
from pathlib import Path

import cv2
import msgspec
import numpy as np

from matchset.app.drawing.picture_file import write_picture
from matchset.batch.jobs.choice import FRAME
from matchset.batch.jobs.counts import kept_table
from matchset.batch.jobs.job import VideoOutcome
from matchset.batch.jobs.videos import real_name
from matchset.batch.results.store import Store
from matchset.media.video import Video

DRAWN = "why.png", "summary.png", FRAME


class PictureParameters(msgspec.Struct, frozen=True):
    """How much is done for a picture.

    Parameters
    ----------
    frames : int
        Frames that are read at most to come to one without a ball. More: longer, and the very frame.
    width : int
        Of the picture, px.
    """

    frames: int = 1000
    width: int = 640


PARAMETERS = PictureParameters()


def worst_picture(store: Store, outcome: VideoOutcome, path: Path) -> bool:
    """Write a picture of a video; returns whether there is one."""
    for name in DRAWN:
        data = store.read(f"{outcome.folder}/{name}")
        if data is not None:
            path.write_bytes(data)
            return True
    if outcome.state == "failed" or outcome.found == outcome.frames:
        return False
    wanted = _first_lost(store, outcome.folder)
    try:
        with Video(real_name(outcome.video)) as video:
            image = None
            for frame in video:
                image = frame.image
                if frame.index >= min(wanted, PARAMETERS.frames):
                    break
    except (ValueError, OSError):  # it was there when it was followed: no picture, but its row
        return False
    if image is None:
        return False
    scale = PARAMETERS.width / image.shape[1]
    write_picture(path, cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA).astype(np.uint8))
    return True


def _first_lost(store: Store, folder: str) -> int:
    table = kept_table(store, folder)
    rows = csv.DictReader(io.StringIO("" if table is None else table[1].decode(), newline=""))
    return next((int(row["frame"]) for row in rows if row["found"] == "0"), 0)
