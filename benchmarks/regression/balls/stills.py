"""Balls in single pictures, found with the color of a picture of the same day: `measure`.

The pictures lie in folders, one folder for each robot and day. One click teaches the color: the center of the largest
ball of a folder. `detect` searches all other pictures of the folder.
"""

import math
from collections.abc import Iterator, Sequence
from pathlib import Path

import cv2
import msgspec
import numpy as np

import matchset as ms
from benchmarks.common.start import Image
from benchmarks.regression.figures import INFORMATION, SOME, STILLS, Figure
from benchmarks.tracking.trial import circle
from matchset.app.track.score import Circle3

FOLDER = "robocup_msl"
SECTION, ALL = "stills", "all"
WITHIN_PX, WITHIN = 4.0, 0.5
"""An answer is right with a center so near to a label's, px or in sizes of its box, whichever is more."""
RATIO = 1.6
"""And with a radius that is larger or smaller by less than this factor."""


class Box(msgspec.Struct, frozen=True):
    """A label of a ball.

    Parameters
    ----------
    x, y : float
        Its center, px.
    width, height : float
        px.
    """

    x: float
    y: float
    width: float
    height: float

    @property
    def size(self) -> float:
        """Mean of width and height: an oval ball's diameter, px."""
        return 0.5 * (self.width + self.height)

    def holds(self, answer: Circle3) -> bool:
        """Say whether an answer is this ball."""
        x, y, radius = answer
        near = math.hypot(x - self.x, y - self.y) <= max(WITHIN * self.size, WITHIN_PX)
        ratio = 2.0 * radius / self.size
        return near and 1.0 / RATIO <= ratio <= RATIO


class Still(msgspec.Struct, frozen=True):
    """A picture and the balls in it.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3), uint8
    boxes : list of Box
        At least one.
    """

    image: Image
    boxes: list[Box]

    @property
    def largest(self) -> Box:
        """Its largest ball: the widest."""
        return max(self.boxes, key=lambda box: box.width)


class Found(msgspec.Struct, frozen=True):
    """What was found in the other pictures of a folder.

    Parameters
    ----------
    balls, found : int
        Labelled balls, and those of them that an answer is.
    stills, seen : int
        Pictures, and those of them with a ball that an answer is.
    false : int
        Answers that are no ball.
    """

    balls: int
    found: int
    stills: int
    seen: int
    false: int


def stills_in(folder: Path) -> list[Still]:
    """Read the pictures of a folder that have labels."""
    return [Still(*each) for each in _read(folder) if each[1]]


def _read(folder: Path) -> Iterator[tuple[Image, list[Box]]]:
    for path in sorted(folder.glob("*.jpg")):
        labels = path.with_suffix(".txt")
        image = cv2.imread(str(path))
        if image is not None and labels.exists():
            yield np.asarray(image, np.uint8), boxes_of(labels.read_text(encoding="utf-8"), image.shape)


def boxes_of(text: str, shape: Sequence[int]) -> list[Box]:
    """Read the labels of a picture, a line each: class, center and size, in shares of the picture.

    Parameters
    ----------
    text : str
    shape : sequence of int
        Height and width of the picture first, px.
    """
    height, width = shape[:2]
    boxes = []
    for line in text.splitlines():
        if line.strip():
            x, y, across, down = (float(word) for word in line.split()[1:5])
            boxes.append(Box(x * width - 0.5, y * height - 0.5, across * width, down * height))
    return boxes


def search(stills: Sequence[Still]) -> Found:
    """Learn the color of the largest ball, and search the other pictures for it."""
    first = max(stills, key=lambda still: still.largest.width)
    others = [still for still in stills if still is not first]
    color = _color(first)
    answers = [[] if color is None else _detect(each, color) for each in others]
    return judged(others, answers)


def _color(still: Still) -> ms.ColorModel | None:
    try:
        return ms.ColorModel.pick(still.image, still.largest.x, still.largest.y)
    except ValueError:
        return None


def _detect(still: Still, color: ms.ColorModel) -> list[Circle3]:
    return [circle(track.shape) for track in ms.detect(still.image, ms.Circle, color)]


def judged(stills: Sequence[Still], answers: Sequence[Sequence[Circle3]]) -> Found:
    """Hold the answers in some pictures against their labels."""
    balls = found = seen = false = 0
    for still, given in zip(stills, answers, strict=True):
        right = sum(any(box.holds(answer) for answer in given) for box in still.boxes)
        balls += len(still.boxes)
        found += right
        seen += right > 0
        false += sum(not any(box.holds(answer) for box in still.boxes) for answer in given)
    return Found(balls, found, len(stills), seen, false)


def measure(data: Path) -> list[Figure]:
    """Search the pictures of all folders; nothing where there are none.

    Parameters
    ----------
    data : Path
        Holds the folder of the folders.
    """
    folders = sorted(each for each in (data / FOLDER).glob("*") if each.is_dir())
    read = ((folder.name, stills_in(folder)) for folder in folders)
    found = {name: search(stills) for name, stills in read if len(stills) > 1}
    figures = [figure for name, each in found.items() for figure in figures_of(name, each, noise=1.0)]
    return [*figures, *figures_of(ALL, total(list(found.values())))] if found else []


def total(every: Sequence[Found]) -> Found:
    """Add up what was found in some folders."""
    columns = zip(*(msgspec.structs.astuple(each) for each in every), strict=True)
    return Found(*(sum(column) for column in columns))


def figures_of(name: str, found: Found, noise: float | None = None) -> list[Figure]:
    """Name the numbers of a folder, or of all of them.

    Parameters
    ----------
    name : str
    found : Found
    noise : float, optional
        How many more may be missed; otherwise the kind's.
    """
    where = SECTION, name
    return [
        Figure.of(where, "balls", found.balls, INFORMATION),
        Figure.of(where, "found", found.found, STILLS, noise),
        Figure.of(where, "pictures", found.stills, INFORMATION),
        Figure.of(where, "pictures with one found", found.seen, STILLS, noise),
        Figure.of(where, "false", found.false, SOME),
    ]
