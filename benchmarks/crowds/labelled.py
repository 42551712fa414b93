"""Real crowds, labelled by hand: `LabelledClip`; `labels/README.md` says what they show and how they were labelled."""

import csv
import os
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np

import matchset as ms
from benchmarks.crowds.composed.footage import VARIABLE as REAL_DATA
from benchmarks.crowds.composed.footage import folder as real_data
from benchmarks.crowds.crowd import Seen

LABELS = Path(__file__).with_name("labels")
FOLDER = Path("/usr/share/visp-images-data/ViSP-images")  # where Debian's `visp-images-data` puts them
VARIABLE = "MATCHSET_VISP_IMAGES"  # names another folder
SEQUENCE = "mire-2"
COLLOIDS = "colloids"
LARGE = 4  # the disc of a mire that is no circle in the picture, and does not count
FPS = 25.0  # taken for it: the sequences do not say


class Source(NamedTuple):
    """Where the pictures of a clip are.

    Parameters
    ----------
    pattern : str
        Name of a picture, from its number.
    balls : int
        Of one size.
    left_out : tuple of int
        Identities that count neither for nor against.
    """

    pattern: str
    balls: int
    left_out: tuple[int, ...] = ()


MIRE = Source("image.{:04d}.pgm", 4, (LARGE,))
CLIPS = {"mire_lifted": MIRE, "mire_turned": MIRE, COLLOIDS: Source("bf_{:04d}.png", 5)}
NAMES = tuple(CLIPS)


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
        self.folder, self.source = folder(name), CLIPS[name]
        if not self.folder.is_dir():
            raise FileNotFoundError(f"no {self.folder}: {how_to_get(name)}")
        self._truth: dict[int, list[Seen]] = {}
        with (LABELS / f"{name}.csv").open(encoding="utf-8") as file:
            for row in csv.DictReader(file):
                identity, circle = int(row["identity"]), ms.Circle(float(row["x"]), float(row["y"]), float(row["r"]))
                seen = Seen(identity, circle, 0.0 if identity in self.source.left_out else 1.0)
                self._truth.setdefault(int(row["frame"]), []).append(seen)

    @property
    def seconds(self) -> float:
        """Its length, s."""
        return (max(self._truth) - min(self._truth) + 1) / FPS

    def __iter__(self) -> Iterator[tuple[ms.Frame, list[Seen] | None]]:
        first = min(self._truth)
        for number in range(first, max(self._truth) + 1):
            path = self.folder / self.source.pattern.format(number)
            image = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
            if image is None:
                raise FileNotFoundError(f"no picture {path}")
            yield ms.Frame(image.astype(np.uint8), (number - first) / FPS, number - first), self._truth.get(number)


def folder(name: str) -> Path:
    """Return where the pictures of a clip should be."""
    if name == COLLOIDS:
        return real_data() / "colloids_brightfield"
    return Path(os.environ.get(VARIABLE, str(FOLDER))) / SEQUENCE


def how_to_get(name: str) -> str:
    """Say how the pictures of a clip are had."""
    if name == COLLOIDS:
        return f"set {REAL_DATA} to the folder with real clips"
    return f"install Debian's visp-images-data, or set {VARIABLE}"
