"""What is promised of every family: found in a whole frame, several at once, best first; without color; no jumps."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from families import SHAPES, page_example

import matchset as ms
from matchset.shapes.shape import outline
from matchset.sim.rendering.coverage import draw_polygon

Image = npt.NDArray[np.uint8]
BLUE, ROOM, SKIN = (200, 70, 30), (120, 140, 150), (120, 150, 196)
NAMES = [
    *("circle", "ellipse", "rectangle", "square", "quadrilateral", "triangle", "stop sign", "affine hexagon"),
    *("egg", "affine half disc", "of the page"),
]
FIRST, SECOND = (170.0, 130.0), (450.0, 330.0)

every_family = pytest.mark.parametrize("name", NAMES)


def placed(name: str, center: tuple[float, float]) -> Any:
    """A shape of a family at a place."""
    shape = page_example().Pick(301.3, 208.8, 57.7) if name == "of the page" else SHAPES[name]
    state = shape.state
    state[:2] = center
    return type(shape).from_state(state, shape)


def drawn(image: Image, points: npt.NDArray[np.float64], color: tuple[int, int, int]) -> Image:
    picture = image.astype(np.float32)
    draw_polygon(picture, [points], color)
    return np.rint(picture).astype(np.uint8)


def overlap(one: Any, other: Any) -> float:
    """Area in common over joint area, from what is drawn of both."""
    masks = [
        drawn(np.zeros((480, 640, 3), np.uint8), outline(each, 360), (255, 255, 255)) > 127 for each in (one, other)
    ]
    return float((masks[0] & masks[1]).sum() / (masks[0] | masks[1]).sum())


@every_family
def test_several_are_found_the_best_first(name: str) -> None:
    whole, covered = placed(name, FIRST), placed(name, SECOND)
    image = np.full((480, 640, 3), ROOM, np.uint8)
    for shape in (covered, whole):
        image = drawn(image, outline(shape, 360), BLUE)
    x, y = SECOND
    image = drawn(image, np.array([(x - 9, y + 10), (x + 9, y + 10), (x + 9, y + 140), (x - 9, y + 140)]), SKIN)
    found = ms.detect(ms.Frame(image), type(whole), ms.ColorModel.pick(image, *FIRST))
    assert len(found) == 2
    assert overlap(found[0].shape, whole) > 0.97
    assert overlap(found[1].shape, covered) > 0.93
    assert found[0].support > found[1].support


@every_family
@pytest.mark.parametrize("mode", ["dark", "light"])
def test_things_without_color_are_found_and_followed(name: str, mode: str) -> None:
    ground, thing = (60, 190) if mode == "light" else (200, 50)
    shape = placed(name, FIRST)
    family, color = type(shape), getattr(ms.ColorModel, mode)()

    def picture(step: float) -> Image:
        image = np.full((480, 640, 3), ground, np.uint8)
        return drawn(image, outline(placed(name, (FIRST[0] + step, FIRST[1])), 360), (thing,) * 3)[:, :, 0].copy()

    (found,) = ms.detect(ms.Frame(picture(0.0)), family, color)
    assert overlap(found.shape, shape) > 0.97
    tracker: ms.Tracker[Any] = ms.Tracker(family, color)
    tracker.start(placed(name, (FIRST[0] - 4.0, FIRST[1] + 3.0)))  # roughly
    for index in range(4):
        track = tracker.update(ms.Frame(picture(3.0 * index), index / 30.0, index))
        assert isinstance(track, ms.Track)
        assert overlap(track.shape, placed(name, (FIRST[0] + 3.0 * index, FIRST[1]))) > 0.97


def followed(shapes: list[Any]) -> Iterator[Any]:
    """What a tracker answers, frame by frame, to shapes drawn on a wall."""
    tracker: ms.Tracker[Any] | None = None
    for index, shape in enumerate(shapes):
        image = drawn(np.full((240, 320, 3), ROOM, np.uint8), outline(shape, 360), BLUE)
        center = shape.state[:2].tolist()
        tracker = tracker or ms.Tracker(type(shape), ms.ColorModel.pick(image, *center), start=tuple(center))
        track = tracker.update(ms.Frame(image, index / 30.0, index))
        assert isinstance(track, ms.Track), index
        yield track.shape


def test_the_angle_of_an_octagon_goes_on_without_jumps() -> None:
    sign = type(SHAPES["stop sign"])
    angles = [each.angle for each in followed([sign(160, 120, 60, 0.04 * k) for k in range(45)])]
    assert np.abs(np.diff(angles) - 0.04).max() < 0.02


def test_a_rectangle_that_turns_through_a_square_keeps_its_sides() -> None:
    widths = np.linspace(120.0, 60.0, 30)
    found = list(followed([ms.Rectangle(160, 120, w, 180.0 - w, 0.3 + 0.02 * k) for k, w in enumerate(widths)]))
    assert np.abs([each.width for each in found] - widths).max() < 1.0 or (
        np.abs([each.height for each in found] - widths).max() < 1.0
    )
    assert np.abs(np.diff([each.angle for each in found]) - 0.02).max() < 0.02


def test_an_ellipse_that_goes_through_a_circle_keeps_its_axes() -> None:
    longer = np.linspace(70.0, 40.0, 30)
    found = list(followed([ms.Ellipse(160, 120, a, 110.0 - a, 0.4) for a in longer]))
    assert np.abs([each.a for each in found] - longer).max() < 1.0
    assert np.abs(np.diff([each.angle for each in found])).max() < 0.2


def test_the_corners_of_a_quadrilateral_keep_their_order() -> None:
    first = np.array([(110.0, 80.0), (215.0, 90.0), (205.0, 165.0), (100.0, 160.0)])
    shapes = []
    for k in range(40):
        c, s = np.cos(0.06 * k), np.sin(0.06 * k)
        shapes.append(ms.Quadrilateral((first - (158, 124)) @ np.array([(c, s), (-s, c)]) + (158, 124)))
    found = [each.corners for each in followed(shapes)]
    assert np.abs(np.diff(found, axis=0)).max() < 8.0  # px per frame; a change of names would be 70


@pytest.mark.parametrize("length", [2.0, 4.0])
def test_hardly_more_than_a_line(length: float) -> None:
    """A sliver is answered by finite numbers or not at all."""
    thin = ms.Rectangle(160, 120, 150, length, 0.4)
    image = drawn(np.full((240, 320, 3), ROOM, np.uint8), thin.corners, BLUE)
    for family in (ms.Rectangle, ms.Ellipse, ms.Quadrilateral):
        tracker: ms.Tracker[Any] = ms.Tracker(family, ms.ColorModel.hsv((100, 90, 40), (130, 255, 255)))
        tracker.start(next(iter(family.from_hull(thin.corners))))
        answer = tracker.update(ms.Frame(image))
        if isinstance(answer, ms.Track):
            assert np.isfinite(outline(answer.shape)).all()
            assert np.isfinite(answer.covariance).all()
            assert np.isfinite([getattr(answer.shape, each) for each in family.parameters]).all()
