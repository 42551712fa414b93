"""Outlines by consensus of edge points: against truth, a slow twin of their score, and hostile pictures."""

import math

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import matchset as ms
from matchset.fitting.consensus import Consensus, ConsensusParameters

Picture = npt.NDArray[np.uint8]
Floats = npt.NDArray[np.float64]
WIDTH, HEIGHT, LINES = 240, 200, 64
X, Y, RADIUS = 118.3, 95.7, 40.0
YELLOW, WALL, TUBE = (30, 200, 220), (140, 140, 140), (60, 40, 160)
NONE_GIVEN = np.zeros((1, 3))


def picture(cut: float = math.inf, wall: tuple[int, int, int] = WALL) -> Picture:
    """A yellow disc before a wall; what is more than `cut` below its center lies behind a tube."""
    rows, columns = np.indices((HEIGHT, WIDTH))
    image = np.full((HEIGHT, WIDTH, 3), wall, np.uint8)
    image[np.hypot(columns - X, rows - Y) <= RADIUS] = YELLOW
    image[rows > Y + cut] = TUBE
    return image


def model() -> ms.ColorModel:
    """Yellow is the target's color, all else is not."""
    table = np.full((32, 32, 32), -4.0, np.float32)
    table[:16, 16:, 16:] = 4.0
    return ms.ColorModel(table.ravel())


def outline(x: float, y: float, radius: float) -> Floats:
    """Points, normals and moves of a circle."""
    turns = np.arange(LINES) * 2.0 * np.pi / LINES
    normals = np.column_stack((np.cos(turns), np.sin(turns)))
    return np.column_stack((np.array((x, y)) + radius * normals, normals, normals, np.ones(LINES)))


def propose(image: Picture, x: float, y: float, radius: float) -> tuple[Floats, Floats]:
    """Circles near one, and their scores."""
    found = Consensus(3).propose(image, model(), outline(x, y, radius), radius, NONE_GIVEN)
    return np.array((x, y, radius)) + found.steps, found.scores


@given(
    across=st.floats(-0.15, 0.15), down=st.floats(-0.15, 0.15), growth=st.floats(-0.15, 0.15), cut=st.floats(0.35, 1.2)
)
@settings(max_examples=40, deadline=None)
def test_the_best_outline_is_that_of_the_disc_although_a_tube_hides_a_part_of_it(
    across: float, down: float, growth: float, cut: float
) -> None:
    start = X + across * RADIUS, Y + down * RADIUS, RADIUS * (1.0 + growth)
    circles, scores = propose(picture(cut * RADIUS), *start)
    assert np.abs(circles[scores.argmax()] - (X, Y, RADIUS)).max() < 0.8


def test_a_robust_fit_to_the_cut_disc_is_a_compromise() -> None:
    """What consensus is for: the plain fit is between the outline and the cut."""
    image, color = picture(0.45 * RADIUS), model()
    from matchset.fitting.workspace import SearchWindow
    from matchset.tracking.compiled_step import tracking_fitter

    fitter = tracking_fitter(ms.Circle, LINES)
    state = np.zeros(len(fitter.state))
    state[:3] = X, Y - 4.0, RADIUS * 0.85
    fitted = fitter.fit(image, color, state, SearchWindow(16.0)).state[:3]
    circles, scores = propose(image, *fitted)
    best = circles[scores.argmax()]
    assert np.abs(best - (X, Y, RADIUS)).sum() < 0.5 + np.abs(fitted - (X, Y, RADIUS)).sum()
    assert np.abs(best - (X, Y, RADIUS)).max() < 0.8


def test_target_color_beyond_an_outline_speaks_against_it() -> None:
    inner = np.array([[0.0, 0.0, -0.3 * RADIUS]])
    found = Consensus(3).propose(picture(), model(), outline(X, Y, RADIUS), RADIUS, np.vstack((NONE_GIVEN, inner)))
    assert found.scores[0] > 0.9 > 0.0 > found.scores[1]


def test_half_widths_and_given_steps_come_back() -> None:
    steps = np.array([[0.0, 0.0, 2.0], [1.0, -1.0, 0.0]])
    found = Consensus(3).propose(picture(), model(), outline(X, Y, RADIUS), RADIUS, steps)
    np.testing.assert_array_equal(found.steps[:2], steps)
    assert found.half_widths[0] == pytest.approx(RADIUS + 2.0)
    assert found.half_widths[1] == pytest.approx(RADIUS, abs=0.1)
    assert len(found.steps) == len(found.half_widths) == len(found.scores)


def test_the_same_picture_gives_the_same_outlines() -> None:
    first, again = (propose(picture(20.0), X + 3.0, Y, RADIUS) for _ in range(2))
    np.testing.assert_array_equal(first[0], again[0])
    np.testing.assert_array_equal(first[1], again[1])


def test_kept_outlines_differ_and_are_about_as_large() -> None:
    limits = ConsensusParameters()
    circles, _ = propose(picture(15.0), X, Y, 0.9 * RADIUS)
    assert len(circles) <= 1 + limits.kept
    sizes = circles[1:, 2] / (0.9 * RADIUS)
    assert ((sizes > limits.smallest - 0.02) & (sizes < limits.largest + 0.02)).all()
    apart = np.abs(circles[1:, np.newaxis] - circles[np.newaxis, 1:]).sum(axis=2) + 9.0 * np.eye(len(circles) - 1)
    assert apart.min() > 0.2


@pytest.mark.parametrize("image", [np.zeros((60, 80, 3), np.uint8), np.full((4, 4, 3), 255, np.uint8)])
@pytest.mark.parametrize("place", [(40.0, 30.0, 20.0), (-500.0, 9000.0, 7.0), (2.0, 2.0, 3e4)])
def test_where_there_is_nothing_the_given_outline_comes_back(image: Picture, place: tuple[float, float, float]) -> None:
    circles, scores = propose(image, *place)
    assert len(circles) == 1
    assert np.isfinite(scores).all()


@given(seed=st.integers(0, 2**32 - 1), radius=st.floats(2.0, 300.0))
@settings(max_examples=30, deadline=None)
def test_noise_gives_finite_numbers(seed: int, radius: float) -> None:
    image = np.random.default_rng(seed).integers(0, 256, (90, 120, 3), dtype=np.uint8)
    circles, scores = propose(image, 60.0, 45.0, radius)
    assert np.isfinite(circles).all()
    assert np.isfinite(scores).all()
    assert (scores <= 1.0 + ConsensusParameters().inside).all()
