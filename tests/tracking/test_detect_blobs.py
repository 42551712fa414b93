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
