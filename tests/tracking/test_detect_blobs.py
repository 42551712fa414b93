"""`detect` looks at places where the color prevails, if no candidate of the search is right: balls among specks."""

import math

import cv2
import numpy as np
import numpy.typing as npt
import pytest

import matchset as ms
from matchset.fitting.validation import Prior
from matchset.tracking.compiled_step import tracking_fitter
from matchset.tracking.detector import Detector
from matchset.tracking.search.blobs import color_steps
from matchset.tracking.search.voting import Searcher, SearchParameters

Picture = npt.NDArray[np.uint8]
GREEN = (110.0, 170.0, 70.0)


def picture(ball: tuple[float, float] | None, specks: int, radius: float = 8.0, seed: int = 1) -> Picture:
    """A small ball with a red seam, and specks of its color of 2 to 4 px on one half of the picture."""
    rng = np.random.default_rng(seed)
    rows, columns = np.indices((360, 640))
    image = rng.normal(150.0, 2.0, (360, 640, 3))
    for x, y, size in rng.integers((330, 0, 2), (630, 350, 5), (specks, 3)).tolist():
        image[y : y + size, x : x + size] = GREEN
    if ball is not None:
        inside = np.hypot(columns - ball[0], rows - ball[1]) < radius
        image[inside] = GREEN
        image[inside & (np.abs(rows - columns * 0.6 - ball[1] + 0.6 * ball[0]) < 1.2)] = (90.0, 80.0, 150.0)
    return cv2.GaussianBlur(np.clip(image, 0, 255).astype(np.uint8), (0, 0), 0.8).astype(np.uint8)


@pytest.fixture(scope="module")
def color() -> ms.ColorModel:
    """Learned where the ball is alone."""
    return ms.ColorModel.pick(picture((150.0, 120.0), 0), 148.0, 116.0)


def found_by_blobs(
    image: Picture, color: ms.ColorModel, prior: Prior = Prior.ASKED, radius: float = 4.0
) -> list[tuple[float, float, float]]:
    """Circles that are found where no outline has votes enough to be a candidate."""
    searcher = Searcher(640, 360, SearchParameters(votes=1e9), radius)
    detector = Detector(tracking_fitter(ms.Circle, 64), searcher)
    return [tuple(estimate.state[:3].tolist()) for estimate, _ in detector.detections(image, color, prior)]


@pytest.mark.parametrize("place", [(120.0, 200.0), (240.5, 80.25)])
def test_a_small_ball_is_found_beside_many_specks_of_its_color(
    color: ms.ColorModel, place: tuple[float, float]
) -> None:
    image = picture(place, 1500)
    (ball,) = found_by_blobs(image, color)
    assert ball == pytest.approx((*place, 8.0), abs=0.7)
    assert found_by_blobs(image, color, Prior.PRESENT) == []  # only where a single picture is asked for
    assert found_by_blobs(image, color, radius=math.inf) == []  # and a size is known


def test_specks_and_much_smaller_balls_are_not_found(color: ms.ColorModel) -> None:
    assert not any(found_by_blobs(picture(None, 1500, seed=seed), color) for seed in range(5))
    assert found_by_blobs(picture((120.0, 200.0), 0, radius=6.0), color) == []


def test_a_ball_that_leaves_the_picture_is_not_sure_enough(color: ms.ColorModel) -> None:
    assert found_by_blobs(picture((1.0, 200.0), 0), color) == []


def test_the_size_at_the_click_is_that_of_the_color_asked_for(color: ms.ColorModel) -> None:
    """One working memory serves colors that were clicked at balls of other sizes."""
    image, large = picture((120.0, 200.0), 1500), color.copy()
    first = ms.detect(image, ms.Circle, color)
    large.circle = (150.0, 120.0, 9.0)
    ms.detect(image, ms.Circle, large)
    assert [each.shape for each in ms.detect(image, ms.Circle, color)] == [each.shape for each in first]


def test_color_steps_are_those_of_sums_over_squares() -> None:
    grid = np.random.default_rng(2).integers(-254, 255, (24, 30)).astype(np.int16)
    ((radius, steps),) = color_steps(grid, [3.0, 20.0])  # the second does not fit
    assert radius == 3.0
    white, (row, column), inner, outer = grid / 254.0, (12, 14), 2, 5
    within = white[row - inner : row + inner + 1, column - inner : column + inner + 1]
    all_of_it = white[row - outer : row + outer + 1, column - outer : column + outer + 1]
    around = (all_of_it.sum() - within.sum()) / (all_of_it.size - within.size)
    assert steps[row, column] == pytest.approx(within.mean() - around, abs=1e-5)


PICTURES = {
    "black": np.zeros((60, 80, 3), np.uint8),
    "saturated": np.full((60, 80, 3), 255, np.uint8),
    "one color": np.full((60, 80, 3), (200, 60, 20), np.uint8),
    "noise": np.random.default_rng(0).integers(0, 256, (60, 80, 3), np.uint8),
    "large": np.random.default_rng(1).integers(0, 256, (480, 1280, 3), np.uint8),
    "tiny": np.full((3, 4, 3), (200, 60, 20), np.uint8),
    "a pixel": np.full((1, 1, 3), (200, 60, 20), np.uint8),
}


@pytest.mark.parametrize("radius", [0.5, 0.8, 1.0, 1.2, 2.0, 4.0])
@pytest.mark.parametrize("name", PICTURES)
def test_a_target_of_a_pixel_in_any_picture(name: str, radius: float) -> None:
    """Discs of less than a cell once had no cells around them: the means of nothing were compared."""
    image = PICTURES[name]
    table = np.full((32, 32, 32), -4.0, np.float32)
    table[16:, :16, :16] = 4.0
    blobs = Searcher(image.shape[1], image.shape[0], radius=radius).blobs(image, ms.ColorModel(table.ravel()))
    assert all(np.isfinite(each).all() for each in blobs)
