"""Where discs stand out, and balls that are found there: after a leap, and with the color of another picture."""

import math

import cv2
import msgspec
import numpy as np
import numpy.typing as npt
import pytest

import matchset as ms
from matchset.tracking.motion import Gate
from matchset.tracking.outlines.network_outlines import NetworkParameters
from matchset.tracking.parameters import TrackerParameters
from matchset.tracking.search.disc_search import DiscSearchParameters, contrasting_discs

Picture = npt.NDArray[np.uint8]
SIZE = (240, 360)
GREEN = (70.0, 150.0, 60.0)
SEARCH = DiscSearchParameters()
UNUSED = TrackerParameters(network=NetworkParameters(used=False))


def picture(
    at: tuple[float, float] | None, radius: float = 9.0, color: tuple[float, ...] = GREEN, seed: int = 0
) -> Picture:
    """A ball before a wall with dark boards and pale spots, in any light."""
    rows, columns = np.indices(SIZE)
    image = np.full((*SIZE, 3), (150.0, 145.0, 140.0)) + columns[:, :, np.newaxis] * 0.1
    image[:, 40:70] = (60.0, 70.0, 80.0)
    image[np.hypot(columns - 300, rows - 40) < 8.0] = (210.0, 210.0, 215.0)
    if at is not None:
        away = np.hypot(columns - at[0], rows - at[1])
        share = np.clip(radius + 0.5 - away, 0.0, 1.0)[..., np.newaxis]
        shade = (1.0 - 0.4 * np.clip((rows - at[1]) / radius, -1.0, 1.0))[..., np.newaxis]
        image = image * (1.0 - share) + np.array(color) * shade * share
    soft = cv2.GaussianBlur(image, (0, 0), 0.8)
    return np.asarray(np.clip(soft + np.random.default_rng(seed).normal(0.0, 3.0, soft.shape), 0, 255), np.uint8)


def lab(image: Picture, at: tuple[float, float]) -> npt.NDArray[np.float64]:
    x, y = round(at[0]), round(at[1])
    middle = image[y - 4 : y + 5, x - 4 : x + 5].astype(np.float32) / np.float32(255.0)
    return np.asarray(np.median(cv2.cvtColor(middle, cv2.COLOR_BGR2Lab).reshape(-1, 3), axis=0), np.float64)


@pytest.mark.parametrize(("radius", "at"), [(5.0, (100.0, 60.0)), (9.0, (250.5, 180.0)), (30.0, (200.0, 120.0))])
def test_a_disc_stands_out_wherever_it_is(radius: float, at: tuple[float, float]) -> None:
    image = picture(at, radius)
    found = contrasting_discs(image, lab(image, at), Gate(50.0, 200.0, radius), 1000.0, SEARCH)
    assert 1 <= len(found) <= SEARCH.most
    assert math.dist(found[0][:2], at) < 0.5 * radius
    assert found[0].half_width == radius


def test_a_window_is_looked_at_alone_and_may_lie_outside() -> None:
    at = (250.0, 180.0)
    image = picture(at)
    color = lab(image, at)
    near = contrasting_discs(image, color, Gate(240.0, 170.0, 9.0), 30.0, SEARCH)
    assert math.dist(near[0][:2], at) < 4.0
    assert not contrasting_discs(image, color, Gate(120.0, 60.0, 9.0), 30.0, SEARCH)
    for place in (Gate(-500.0, 100.0, 9.0), Gate(100.0, 2000.0, 9.0), Gate(100.0, 100.0, 500.0)):
        assert contrasting_discs(image, color, place, 30.0, SEARCH) == []


def test_the_merit_is_the_contrast_times_the_likeness_in_color() -> None:
    at, radius = (180.0, 120.0), 4.0
    image = picture(at, radius)
    color = lab(image, at) + np.array((3.0, 2.0, 0.0))
    rows, columns = np.indices(SIZE)
    colors = cv2.cvtColor(image.astype(np.float32) / np.float32(255.0), cv2.COLOR_BGR2Lab)

    def merit(x: int, y: int) -> float:
        away = np.hypot(columns - x, rows - y)
        disc = colors[away <= SEARCH.rim * radius].mean(axis=0)
        ring = colors[(away >= SEARCH.ring[0] * radius) & (away <= SEARCH.ring[1] * radius)].mean(axis=0)
        contrast = float(np.linalg.norm(disc - ring))
        off = (disc - color) / (SEARCH.lightness, SEARCH.chroma, SEARCH.chroma)
        return math.exp(-0.5 * float(off @ off)) * contrast / (contrast + SEARCH.contrast)

    best = max(((x, y) for x in range(172, 189) for y in range(112, 129)), key=lambda place: merit(*place))
    found = contrasting_discs(image, color, Gate(*at, radius), 30.0, SEARCH)
    assert found[0][:2] == pytest.approx(best)


def follow(shown: list[Picture], begin: tuple[float, float], limits: TrackerParameters | None) -> list[float | None]:
    """Where a ball is seen along x, picture by picture."""
    tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(shown[0], *begin), start=begin, parameters=limits)
    answers = [tracker.update(image) for image in shown]
    return [answer.shape.x if isinstance(answer, ms.Track) else None for answer in answers]


def test_a_ball_that_leaps_and_changes_its_light_is_found_again() -> None:
    shown = [picture((120.0, 120.0), seed=k) for k in range(6)]
    dark = (47.0, 92.0, 44.0)
    shown += [picture((160.0 + 30.0 * k, 120.0 - 12.0 * k), color=dark, seed=9 + k) for k in range(5)]
    found = follow(shown, (120.0, 120.0), None)
    assert [x for x in found[8:] if x is None] == []
    assert found[8:] == pytest.approx([160.0 + 30.0 * k for k in (2, 3, 4)], abs=3.0)


def test_nothing_is_found_where_no_ball_is() -> None:
    shown = [picture((120.0, 120.0) if k < 6 else None, seed=k) for k in range(30)]
    assert [x for x in follow(shown, (120.0, 120.0), None)[6:] if x is not None] == []


def test_a_network_that_is_not_used_finds_nothing() -> None:
    shown = [picture((120.0, 120.0), seed=k) for k in range(6)]
    shown.append(picture((290.0, 150.0), color=(200.0, 60.0, 60.0)))
    assert follow(shown, (120.0, 120.0), UNUSED)[6] is None


@pytest.mark.parametrize("at", [(90.0, 60.0), (250.0, 170.0)])
def test_a_ball_of_two_colors_is_detected_with_the_color_of_another_picture(at: tuple[float, float]) -> None:
    def half_white(place: tuple[float, float], seed: int) -> Picture:
        image = picture(place, 12.0, seed=seed).astype(np.float64)
        rows, columns = np.indices(SIZE)
        cap = (np.hypot(columns - place[0], rows - place[1]) < 11.0) & (rows < place[1] - 4.0)
        image[cap] = (200.0, 205.0, 200.0)
        return np.asarray(cv2.GaussianBlur(image, (0, 0), 0.8), np.uint8)

    color = ms.ColorModel.pick(half_white((180.0, 120.0), 1), 180.0, 124.0)
    found = ms.detect(half_white(at, 2), ms.Circle, color)
    assert math.dist((found[0].shape.x, found[0].shape.y), at) < 3.0
    assert found[0].shape.radius == pytest.approx(12.0, abs=3.0)
    assert np.linalg.eigvalsh(found[0].covariance).min() > 0.0
    assert ms.detect(picture(None, seed=3), ms.Circle, color) == []


def test_a_searched_place_without_a_ball_is_not_followed() -> None:
    limits = NetworkParameters()
    assert limits.search.hopeless < 0.0
    assert math.isinf(limits.follow.hopeless)
    assert msgspec.structs.replace(limits.search, hopeless=-math.inf) == limits.follow
