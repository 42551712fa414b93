"""Real crowds, labelled by hand: `LabelledClip`; `labels/README.md` says what they show and how they were labelled."""

import csv
import os
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np

import matchset as ms
from benchmarks.crowds.crowd import Seen

LABELS = Path(__file__).with_name("labels")
NAMES = tuple(sorted(path.stem for path in LABELS.glob("mire_*.csv")))
FOLDER = Path("/usr/share/visp-images-data/ViSP-images")  # where Debian's `visp-images-data` puts them
VARIABLE = "MATCHSET_VISP_IMAGES"  # names another folder
SEQUENCE = "mire-2"
LARGE = 4  # the disc that is no circle in the picture, and does not count
FPS = 25.0  # taken for it: the sequence does not say
EQUAL = 4  # discs of one size


class LabelledClip:
    """A real crowd: every frame, and what is in those that are labelled, None of others.

    Parameters
    ----------
    name : str
        One of `NAMES`.

    Raises
    ------
    FileNotFoundError
        If the pictures are not here.
    """

    def __init__(self, name: str) -> None:
        self.folder = folder()
        if not self.folder.is_dir():
            raise FileNotFoundError(f"no {self.folder}: install Debian's visp-images-data, or set {VARIABLE}")
        self._truth: dict[int, list[Seen]] = {}
        with (LABELS / f"{name}.csv").open(encoding="utf-8") as file:
            for row in csv.DictReader(file):
                identity, circle = int(row["identity"]), ms.Circle(float(row["x"]), float(row["y"]), float(row["r"]))
                seen = Seen(identity, circle, 0.0 if identity == LARGE else 1.0)
                self._truth.setdefault(int(row["frame"]), []).append(seen)

    @property
    def seconds(self) -> float:
        """Its length, s."""
        return (max(self._truth) - min(self._truth) + 1) / FPS

    def __iter__(self) -> Iterator[tuple[ms.Frame, list[Seen] | None]]:
        first = min(self._truth)
        for number in range(first, max(self._truth) + 1):
            path = self.folder / f"image.{number:04d}.pgm"
            image = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
            if image is None:
                raise FileNotFoundError(f"no picture {path}")
            yield ms.Frame(image.astype(np.uint8), (number - first) / FPS, number - first), self._truth.get(number)


def folder() -> Path:
    """Return where the pictures should be."""
    return Path(os.environ.get(VARIABLE, str(FOLDER))) / SEQUENCE
