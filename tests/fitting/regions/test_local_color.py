"""Colors inside a disc and around it: a slow twin, what a click does not teach, and pictures without an answer."""

import math

import cv2
import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from matchset.fitting.regions.local_color import BINS, KERNEL, LocalColorParameters, learn_local_color

Image = npt.NDArray[np.uint8]
LIMITS = LocalColorParameters()
X, Y, RADIUS = 60.0, 50.0, 15.0


def scene(seed: int = 0) -> Image:
    """A green ball with a pale cap and a dark rim, before a wall that is as pale on its left half."""
    rows, columns = np.indices((100, 120))
    away = np.hypot(columns - X, rows - Y)
    image = np.full((100, 120, 3), (150, 150, 160), np.uint8)
    image[:, : int(X - RADIUS)] = (40, 60, 120)
    image[away <= RADIUS] = (60, 170, 70)
    image[(away <= RADIUS) & (rows < Y - 0.5 * RADIUS)] = (190, 235, 200)
    image[(away > 0.7 * RADIUS) & (away <= RADIUS) & (rows > Y)] = (20, 70, 25)
    noise = np.random.default_rng(seed).normal(0.0, 2.0, image.shape)
    return np.asarray(np.clip(image + noise, 0, 255), np.uint8)


def slow_shares(pixels: list[tuple[int, ...]]) -> dict[tuple[int, ...], float]:
    """Smoothed histogram of pixels in CIE Lab, by plain loops."""
    shares: dict[tuple[int, ...], float] = {}
    for pixel in pixels:
        for i, wi in enumerate(KERNEL):
            for j, wj in enumerate(KERNEL):
                for k, wk in enumerate(KERNEL):
                    bin_ = tuple(int(v) // 8 + d - 2 for v, d in zip(pixel, (i, j, k), strict=True))
                    if all(0 <= v < BINS for v in bin_):
                        shares[bin_] = shares.get(bin_, 0.0) + wi * wj * wk / len(pixels)
    return shares


@settings(max_examples=10, deadline=None)
@given(seed=st.integers(0, 1000), dx=st.floats(-4.0, 4.0), dy=st.floats(-4.0, 4.0))
def test_scores_are_those_of_plain_loops(seed: int, dx: float, dy: float) -> None:
    image, x, y = scene(seed), X + dx, Y + dy
    lab = cv2.cvtColor(image, cv2.COLOR_BGR2Lab)
    inside, around = [], []
    for row in range(100):
        for column in range(120):
            away = math.hypot(column - x, row - y) / RADIUS
            if away < LIMITS.inner:
                inside.append(tuple(lab[row, column].tolist()))
            elif LIMITS.nearest < away < LIMITS.farthest:
                around.append(tuple(lab[row, column].tolist()))
    here, there = slow_shares(inside), slow_shares(around)
    learned = learn_local_color(image, (x, y), RADIUS, LIMITS)
    assert learned is not None
    found, floor = learned.scores(image), LIMITS.floor / min(len(inside), len(around))
    for row in range(20, 80, 7):
        for column in range(30, 90, 7):
            bin_ = tuple(int(v) // 8 for v in lab[row, column])
            odds = math.log((here.get(bin_, 0.0) + floor) / (there.get(bin_, 0.0) + floor))
            assert found[row, column] == pytest.approx(min(max(odds / LIMITS.most, -1.0), 1.0), abs=1e-3)


def test_cap_and_shaded_rim_are_of_the_ball_and_both_walls_are_not() -> None:
    learned = learn_local_color(scene(), (X + 1.0, Y - 1.0), 1.05 * RADIUS, LIMITS)
    assert learned is not None
    colors = np.array([(190, 235, 200), (20, 70, 25), (60, 170, 70), (150, 150, 160), (40, 60, 120)], np.uint8)
    assert (np.sign(learned.scores(colors)) == (1, 1, 1, -1, -1)).all()


def test_a_color_that_is_nowhere_decides_nothing() -> None:
    learned = learn_local_color(scene(), (X, Y), RADIUS, LIMITS)
    assert learned is not None
    assert learned.scores(np.array([[255, 0, 255]], np.uint8)).tolist() == [0.0]


@pytest.mark.parametrize("radius", [70.0, 200.0])
def test_a_large_ball_is_read_in_cells(radius: float) -> None:
    image = np.full((500, 500, 3), (150, 150, 160), np.uint8)
    cv2.circle(image, (250, 250), round(radius), (60, 170, 70), -1)
    learned = learn_local_color(image, (250.0, 250.0), radius, LIMITS)
    assert learned is not None
    assert (learned.scores(image[250:252, 250:252]) == 1.0).all()
    assert (learned.scores(image[:2, :2]) == -1.0).all()


@pytest.mark.parametrize(("x", "y", "radius"), [(-50.0, 50.0, 15.0), (60.0, 300.0, 15.0), (60.0, 50.0, 1.0)])
def test_beside_the_picture_and_too_small_there_is_none(x: float, y: float, radius: float) -> None:
    assert learn_local_color(scene(), (x, y), radius, LIMITS) is None


def test_gray_pictures_and_no_weight_have_none() -> None:
    assert learn_local_color(scene()[:, :, :1], (X, Y), RADIUS, LIMITS) is None
    assert learn_local_color(scene(), (X, Y), RADIUS, LocalColorParameters(weight=0.0)) is None
