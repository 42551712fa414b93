"""Where discs stand out: the kernels beside slow twins, parts of a large window by turns, and places in vain."""

import itertools
import math

import cv2
import msgspec
import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import matchset as ms
from matchset.tracking.ball.disc_search import (
    DiscSearch,
    DiscSearchParameters,
    pick_maxima,
    write_merits,
    write_sums,
)
from matchset.tracking.ball.judge import NetworkParameters
from matchset.tracking.motion import Gate
from matchset.tracking.parameters import TrackerParameters

Picture = npt.NDArray[np.uint8]
Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]
SIZE = (240, 360)
GREEN = (70.0, 150.0, 60.0)
SEARCH = DiscSearchParameters()
UNUSED = TrackerParameters(network=NetworkParameters(used=False))
BY_PARTS = msgspec.structs.replace(SEARCH, cells=3000)  # the picture, in cells of a ball of 9 px, has 6 parts


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


def lab(image: Picture, at: tuple[float, float]) -> Floats:
    x, y = round(at[0]), round(at[1])
    middle = image[y - 4 : y + 5, x - 4 : x + 5].astype(np.float32) / np.float32(255.0)
    return np.asarray(np.median(cv2.cvtColor(middle, cv2.COLOR_BGR2Lab).reshape(-1, 3), axis=0), np.float64)


def naive_cells(image: Picture, left: float, top: float, step: float, size: tuple[int, int]) -> Floats:
    """Mean color of four pixels of each cell, CIE Lab by OpenCV."""
    means = np.zeros((*size, 3), np.float32)
    for row, column in np.ndindex(*size):
        four = []
        for down, across in itertools.product((0.25, 0.75), repeat=2):
            y = min(max(int(top + (row + down) * step), 0), image.shape[0] - 1)
            x = min(max(int(left + (column + across) * step), 0), image.shape[1] - 1)
            four.append(image[y, x].astype(np.float64))
        means[row, column] = np.floor(np.mean(four, axis=0) + 0.5)
    return np.asarray(cv2.cvtColor(means / np.float32(255.0), cv2.COLOR_BGR2Lab), np.float64)


def sums_of(cells: Floats) -> Floats:
    """Sums of all cells above and left of each corner."""
    sums = np.zeros((cells.shape[0] + 1, cells.shape[1] + 1, 3))
    sums[1:, 1:] = cells.cumsum(axis=0).cumsum(axis=1)
    return sums


@settings(max_examples=30)
@given(
    left=st.floats(-3.0, 30.0), top=st.floats(-3.0, 30.0), step=st.floats(1.0, 5.0),
    rows=st.integers(1, 7), columns=st.integers(1, 7), channels=st.sampled_from((1, 3)), seed=st.integers(0, 99),
)  # fmt: skip
def test_sums_are_those_of_cells_read_one_by_one(
    left: float, top: float, step: float, rows: int, columns: int, channels: int, seed: int
) -> None:
    image = np.random.default_rng(seed).integers(0, 256, (30, 34, channels), np.uint8)
    sums = np.full((rows + 1, columns + 1, 3), np.nan)
    write_sums(image, np.array((left, top)), step, np.empty(3, np.float32), sums)
    colors = np.ascontiguousarray(np.broadcast_to(image, (30, 34, 3)))
    cells = np.diff(np.diff(sums, axis=0), axis=1)
    assert np.abs(cells - naive_cells(colors, left, top, step, (rows, columns))).max() < 0.8
    assert not sums[0].any()
    assert not sums[:, 0].any()


def naive_merits(cells: Floats, color: Floats, limits: DiscSearchParameters) -> Floats:
    """Contrast of a square and the ring around it, times the likeness in color, cell by cell."""
    merits = np.zeros(cells.shape[:2])
    for row, column in np.ndindex(*merits.shape):

        def of_square(half: int, row: int = row, column: int = column) -> Floats:
            rows, columns = (slice(max(at - half, 0), at + half + 1) for at in (row, column))
            return cells[rows, columns].reshape(-1, 3)

        disc, within, around = (of_square(half) for half in (limits.middle, limits.inner, limits.outer))
        off = (disc.mean(axis=0) - color) / (limits.lightness, limits.chroma, limits.chroma)
        if len(around) == len(within) or off @ off > 6.0:
            continue
        ring = (around.sum(axis=0) - within.sum(axis=0)) / (len(around) - len(within))
        contrast = float(np.linalg.norm(disc.mean(axis=0) - ring))
        merits[row, column] = math.exp(-0.5 * float(off @ off)) * contrast / (contrast + limits.contrast)
    return merits


def merits_of(cells: Floats, color: Floats, limits: DiscSearchParameters) -> Singles:
    """Merits by the kernel."""
    bounds = (limits.middle, limits.inner, limits.outer, limits.contrast, limits.lightness, limits.chroma)
    merits = np.full(cells.shape[:2], np.nan, np.float32)
    write_merits(sums_of(cells), color, np.array(bounds, np.float64), np.empty((3, 3)), merits)
    return merits


@settings(max_examples=30)
@given(
    rows=st.integers(1, 20), columns=st.integers(1, 20), spread=st.floats(0.1, 20.0),
    middle=st.integers(0, 2), wide=st.integers(1, 3), ring=st.integers(1, 3), seed=st.integers(0, 999),
)  # fmt: skip
def test_merits_are_those_of_plain_means(
    rows: int, columns: int, spread: float, middle: int, wide: int, ring: int, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    cells, color = rng.normal((50.0, 5.0, -5.0), spread, (rows, columns, 3)), rng.normal((50.0, 5.0, -5.0), 5.0)
    limits = DiscSearchParameters(middle=middle, inner=middle + wide, outer=middle + wide + ring)
    assert merits_of(cells, color, limits) == pytest.approx(naive_merits(cells, color, limits), abs=1e-5)


@settings(max_examples=60)
@given(
    rows=st.integers(1, 9), columns=st.integers(1, 9), reach=st.integers(0, 4), most=st.integers(0, 5),
    seed=st.integers(0, 999),
)  # fmt: skip
def test_maxima_are_picked_best_first_and_apart(rows: int, columns: int, reach: int, most: int, seed: int) -> None:
    merits = np.random.default_rng(seed).uniform(0.0, 1.0, (rows, columns)).astype(np.float32)
    left, expected = merits.copy(), list[tuple[int, int]]()
    while len(expected) < most and left.max() > np.float32(0.3):
        row, column = divmod(int(left.argmax()), columns)
        expected.append((row, column))
        left[max(row - reach, 0) : row + reach + 1, max(column - reach, 0) : column + reach + 1] = 0.0
    places = np.full((most, 2), np.nan)
    count = pick_maxima(merits.copy(), reach, 0.3, places)
    assert count == len(expected)
    assert [*map(tuple, places[:count].tolist())] == expected
    assert np.isnan(places[count:]).all()


@pytest.mark.parametrize(("radius", "at"), [(5.0, (100.0, 60.0)), (9.0, (250.5, 180.0)), (30.0, (200.0, 120.0))])
def test_a_disc_stands_out_wherever_it_is(radius: float, at: tuple[float, float]) -> None:
    image, whole = picture(at, radius), msgspec.structs.replace(SEARCH, cells=100_000)
    found = DiscSearch(whole).about(image, lab(image, at), Gate(50.0, 200.0, radius), 1000.0)
    assert 1 <= len(found) <= SEARCH.most
    assert math.dist(found[0][:2], at) < 0.5 * radius
    assert found[0].half_width == radius


def test_a_window_is_looked_at_alone_and_may_lie_outside() -> None:
    at, search = (250.0, 180.0), DiscSearch(SEARCH)
    image = picture(at)
    color = lab(image, at)
    near = search.about(image, color, Gate(240.0, 170.0, 9.0), 30.0)
    assert math.dist(near[0][:2], at) < 4.0
    assert not search.about(image, color, Gate(120.0, 60.0, 9.0), 30.0)
    for place in (Gate(-500.0, 100.0, 9.0), Gate(100.0, 2000.0, 9.0), Gate(100.0, 100.0, 500.0)):
        assert search.about(image, color, place, 30.0) == []


def test_a_gray_picture_is_searched_too() -> None:
    at = (250.0, 180.0)
    gray = np.ascontiguousarray(picture(at)[..., 1:2])
    color = lab(np.repeat(gray, 3, axis=2), at)
    found = DiscSearch(SEARCH).about(gray, color, Gate(240.0, 170.0, 9.0), 30.0)
    assert math.dist(found[0][:2], at) < 6.5


@settings(max_examples=25)
@given(x=st.floats(75.0, 345.0), y=st.floats(12.0, 228.0), skipped=st.integers(0, 20))
def test_a_large_window_is_covered_part_after_part(x: float, y: float, skipped: int) -> None:
    image, search, cells = picture((x, y)), DiscSearch(BY_PARTS), SIZE[0] * SIZE[1] / (9.0 / 4.0) ** 2
    color, place, parts = lab(image, (x, y)), Gate(50.0, 200.0, 9.0), math.ceil(cells / BY_PARTS.cells)
    for _ in range(skipped):
        search.about(image, color, place, 1000.0)
    found = [search.about(image, color, place, 1000.0) for _ in range(parts)]
    near = [any(math.dist(each[:2], (x, y)) < 4.5 for each in places) for places in found]
    assert any(near)
    assert sum(near) <= 2  # strips overlap by a ring


def test_a_large_window_is_covered_beside_another_that_is_too() -> None:
    """A lost ball is looked for near where it was in each picture, and anywhere in every second one."""
    for k, y in itertools.product(range(3), (20.0, 60.0, 100.0, 140.0, 180.0, 220.0)):
        image, search = picture((200.0, y)), DiscSearch(BY_PARTS)
        color, seen = lab(image, (200.0, y)), False
        for number in range(2 * 6):
            search.about(image, color, Gate(100.0, 120.0, 9.0), 100.0 + 10.0 * k)
            if number % 2:
                places = search.about(image, color, Gate(100.0, 120.0, 9.0), 1000.0)
                seen = seen or any(math.dist(each[:2], (200.0, y)) < 4.5 for each in places)
        assert seen, (k, y)


def test_a_place_in_vain_is_not_returned_for_some_pictures() -> None:
    at, search = (250.0, 180.0), DiscSearch(SEARCH)
    image = picture(at)
    color, place = lab(image, at), Gate(240.0, 170.0, 9.0)
    search.begin_picture()
    (found,) = search.about(image, color, place, 40.0)
    search.in_vain(found)
    for number in range(SEARCH.again + 1):
        places = search.about(image, color, place, 40.0)
        assert all(math.dist(each[:2], found[:2]) > 0.25 * found.half_width for each in places), number
        search.begin_picture()
    assert search.about(image, color, place, 40.0) == [found]
    search.in_vain(found)
    search.forget()
    assert search.about(image, color, place, 40.0) == [found]


def test_a_place_in_vain_hides_nothing_that_is_elsewhere() -> None:
    at, search = (250.0, 180.0), DiscSearch(SEARCH)
    image = picture(at)
    color = lab(image, at)
    for place in (Gate(220.0, 180.0, 9.0), Gate(250.0, 210.0, 9.0), Gate(-50.0, -50.0, 9.0), Gate(900.0, 10.0, 9.0)):
        search.in_vain(place)
    assert math.dist(search.about(image, color, Gate(240.0, 170.0, 9.0), 40.0)[0][:2], at) < 4.0


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
