"""Targets drawn into frames, each identity in a color of its own: `TargetsPainter`, `TargetsSummary`."""

from collections.abc import Callable, Sequence
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from matchset.app.drawing.annotate import as_color, draw_shape
from matchset.app.drawing.status_strip import StatusStrip
from matchset.app.drawing.text import draw_text, text_width
from matchset.app.drawing.trail import Trail
from matchset.app.pictures.summary import Summary
from matchset.image.frame import Frame
from matchset.shapes.described import box_of
from matchset.tracking.many.target import Target
from matchset.tracking.track import Track

Picture = npt.NDArray[np.uint8]
Color = tuple[int, int, int]

# format: BGR; the colors of Okabe and Ito, which people who confuse red and green tell apart, without black; those that
# follow each other far apart
PALETTE: tuple[Color, ...] = (
    (0, 159, 230),
    (233, 180, 86),
    (115, 158, 0),
    (66, 228, 240),
    (167, 121, 204),
    (0, 94, 213),
    (178, 114, 0),
)
# geometry: colors, BGR: around outlines and of letters; of the strip's bar
_DARK, _WHITE, _BAR = (20, 20, 20), (255, 255, 255), (200, 200, 200)
_PER_PX, _LEAST_PX, _MOST_PX = 30, 12, 28  # geometry: height of a picture in sizes of the text, and its limits, px
_SMALL_PX = 13  # geometry: size of the text in the summary's small pictures, px


TargetWords = Callable[[Target[Any]], str]


def numbered(target: Target[Any]) -> str:
    """Write a target's identity; "3?" where it may be another one as well."""
    return f"{target.identity}{'?' if target.alternatives else ''}"


def target_words(labels: bool, number: TargetWords = numbered) -> TargetWords:
    """Return what writes a target's identity, and the label of its color where there are several."""
    return lambda target: f"{number(target)} {target.label}" if labels else number(target)


def color_of(identity: int) -> Color:
    """Return the color of an identity, BGR; every seventh has the same."""
    return PALETTE[identity % len(PALETTE)]


class DrawnTargets(Protocol):
    """What is needed of the rows of a frame."""

    @property
    def frame(self) -> int:
        """Its index."""
        ...

    @property
    def time(self) -> float:
        """When it was taken, s."""
        ...

    @property
    def targets(self) -> Sequence[Any]:
        """A row for each target, with `found`."""
        ...

    @property
    def doubtful(self) -> Sequence[Track[Any]]:
        """What may be one of them."""
        ...


class TargetsPainter:
    """Draws the answers of a run, with the way that each target has come, above a strip of text.

    Parameters
    ----------
    size : tuple of two ints
        Width and height of the frames, px.
    words : callable
        From a target to what is written at its outline.

    Attributes
    ----------
    size : tuple of two ints
        Width and height of the pictures, px.
    """

    def __init__(self, size: tuple[int, int], words: TargetWords) -> None:
        self._words = words
        self._strip = StatusStrip(*size, [("100 of 100 targets seen", "frame 88888   8888.88 s")])
        self._letters = min(max(round(min(size[1], 0.75 * size[0]) / _PER_PX), _LEAST_PX), _MOST_PX)
        self._trails: dict[int, Trail] = {}
        self.size = size[0], size[1] + self._strip.height

    def paint(self, frame: Frame, targets: Sequence[Target[Any]], row: DrawnTargets) -> Picture:
        """Draw the next answers into a copy of their frame; (h + strip, w, 3), BGR."""
        image = as_color(frame.image)
        draw_doubtful(image, row.doubtful, letters=self._letters)
        self._trails = {each.identity: self._trails.get(each.identity) or Trail() for each in targets}
        for each in targets:
            trail = self._trails[each.identity]
            trail.append(each.track.shape.center if isinstance(each.track, Track) else None)
            trail.draw(image, color_of(each.identity))
        draw_targets(image, targets, words=self._words, letters=self._letters)
        seen = sum(each.found for each in row.targets)
        words = f"{seen} of {len(targets)} targets seen" if targets else "no target yet"
        words += f", {len(row.doubtful)} doubtful" if row.doubtful else ""
        return self._strip.below(image, [(words, f"frame {row.frame}   {row.time:.2f} s")], _BAR)


class TargetsSummary(Summary):
    """Collects some frames of a run with all targets, and counts these.

    Parameters
    ----------
    named : callable
        From a target to what is written at its outline.
    """

    def __init__(self, named: TargetWords) -> None:
        super().__init__()
        self._named, self._identities = named, set[int]()
        self._doubtful: Sequence[Track[Any]] = ()

    def append(self, frame: Frame | None, answer: Any, row: Any) -> None:
        """Note the next frame; None: it could not be decoded."""
        self._identities |= {each.identity for each in row.targets}
        self._doubtful = row.doubtful
        super().append(frame, answer, row)

    def draw(self, small: Picture, answer: Any, scale: float) -> None:
        """Draw the targets into a frame that was reduced by a scale."""
        draw_doubtful(small, self._doubtful, scale, _SMALL_PX)
        draw_targets(small, answer, self._named, scale, _SMALL_PX)

    @property
    def words(self) -> str:
        """How many targets there are."""
        count = len(self._identities)
        return f"{count} target{'' if count == 1 else 's'}; one or more " + super().words


def draw_targets(
    image: Picture,
    targets: Sequence[Target[Any]],
    words: TargetWords,
    scale: float = 1.0,
    letters: int = _LEAST_PX,
) -> None:
    """Draw the outline of each target with its identity; dashed, where it should be, of one that is not seen.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3), uint8
        Changed in place: a frame that was resized by a scale.
    targets : sequence of Target
    words : callable
        From a target to what is written at its outline.
    scale : float
    letters : int
        Size of the text, px.
    """
    width = 2 if min(image.shape[:2]) <= 900 else 3
    shown = [(each, shape) for each in targets if (shape := shape_of(each)) is not None]
    shown.sort(key=lambda pair: isinstance(pair[0].track, Track))  # what is seen lies above what is not
    for each, shape in shown:
        seen = isinstance(each.track, Track)
        if seen:
            draw_shape(image, shape, _DARK, scale=scale, thickness=width + 2)
        draw_shape(image, shape, color_of(each.identity), dashed=not seen, scale=scale, thickness=width if seen else 1)
    for each, shape in shown:
        _name(image, words(each), (np.array(box_of(shape)) + 0.5) * scale - 0.5, letters, each)


def draw_doubtful(image: Picture, doubtful: Sequence[Track[Any]], scale: float = 1.0, letters: int = _LEAST_PX) -> None:
    """Draw what may be one of the targets, thin, dashed and white, with a question mark; see `draw_targets`."""
    for each in doubtful:
        draw_shape(image, each.shape, _DARK, dashed=True, scale=scale, thickness=3)
        draw_shape(image, each.shape, _WHITE, dashed=True, scale=scale, thickness=1)
        left, top, right, _ = ((np.array(box_of(each.shape)) + 0.5) * scale - 0.5).tolist()
        draw_text(image, "?", (0.5 * (left + right - text_width("?", letters)), top - 0.7 * letters), letters, _WHITE)


def shape_of(target: Target[Any]) -> Any:
    """Return the outline of a target, or where it should be; None where that is not known."""
    return target.track.shape if isinstance(target.track, Track) else target.track.predicted


def _sign(color: Color, seen: bool) -> tuple[Color, Color]:
    """Return the colors of the letters and of the ground of a name; of what is not seen the ground is dark."""
    if not seen:
        return color, _DARK
    bright = 0.114 * color[0] + 0.587 * color[1] + 0.299 * color[2] > 105.0
    return (_DARK if bright else _WHITE), color


def _name(image: Picture, words: str, box: npt.NDArray[np.float64], letters: int, target: Target[Any]) -> None:
    """Write a name at the upper right of a box, or at the lower left of one that is not seen, inside of the picture."""
    height, width = image.shape[:2]
    wide, high = text_width(words, letters) + letters // 2, round(1.3 * letters)
    left, top, right, bottom = box.tolist()
    if right < 0 or bottom < 0 or left > width - 1 or top > height - 1:
        return
    seen = isinstance(target.track, Track)
    inward_x, inward_y = 0.15 * (right - left), 0.15 * (bottom - top)
    at = (right - inward_x, top + inward_y - high) if seen else (left + inward_x - wide, bottom - inward_y)
    at_x, at_y = round(min(max(at[0], 0), width - wide)), round(min(max(at[1], 0), height - high))
    color, ground = _sign(color_of(target.identity), seen)
    image[max(at_y, 0) : at_y + high, max(at_x, 0) : at_x + wide] = ground
    draw_text(image, words, (at_x + letters // 4, at_y + 0.5 * high), letters, color)
