"""Balls that are small, blurred or compressed: found from one click, tracked, and found again."""

import cv2
import numpy as np
import pytest
from scenes import Picture, at, off, run, with_ball

import matchset as ms
from matchset.fitting.validation import Prior
from matchset.tracking.compiled_step import tracking_fitter
from matchset.tracking.detector import Detector, track_of
from matchset.tracking.search.voting import Searcher, SearchParameters, stride_for

SIZE = 480, 848, 3
ORANGE = 30.0, 120.0, 230.0
SMALL = 401.3, 222.8, 5.0


def room(seed: int) -> Picture:
    """A room with shapes of its own, and noise."""
    rng = np.random.default_rng(seed)
    image = np.empty(SIZE, np.uint8)
    image[:] = (150, 145, 140)
    cv2.rectangle(image, (60, 280), (330, 470), (90, 100, 110), cv2.FILLED)
    cv2.rectangle(image, (600, 40), (800, 300), (190, 190, 180), cv2.FILLED)
    cv2.circle(image, (700, 400), 40, (80, 90, 70), cv2.FILLED)
    noisy: Picture = np.rint(image + rng.normal(0.0, 3.0, SIZE)).clip(0, 255).astype(np.uint8)
    return noisy


def shot(ball: tuple[float, float, float] | None, seed: int, blur: float = 0.7, quality: int = 0) -> Picture:
    """The room with a ball, or none, blurred, and coded as JPEG where a quality is given."""
    image = room(seed) if ball is None else with_ball(room(seed), *ball, ORANGE)
    image = np.asarray(cv2.GaussianBlur(image, (0, 0), blur), np.uint8)
    if not quality:
        return image
    coded, data = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, quality])
    assert coded
    return np.asarray(cv2.imdecode(data, cv2.IMREAD_COLOR), np.uint8)


def picked(image: Picture, ball: tuple[float, float, float]) -> ms.ColorModel:
    return ms.ColorModel.pick(image, round(ball[0]), round(ball[1]))


def test_a_small_ball_is_tracked_from_one_click() -> None:
    balls = [(SMALL[0] + 3.0 * k, SMALL[1] + k, SMALL[2]) for k in range(8)]
    images = [shot(ball, k) for k, ball in enumerate(balls)]
    tracker = ms.Tracker(ms.Circle, picked(images[0], SMALL), start=SMALL[:2])
    for answer, ball in zip(run(tracker, images), balls, strict=True):
        assert off(answer, ball) < 1.5


def test_a_small_ball_is_detected_by_the_color_of_a_click() -> None:
    color = picked(shot(SMALL, 0), SMALL)
    there = 233.0, 101.0, 5.0
    found = ms.detect(at(shot(there, 1), 0), ms.Circle, color)
    assert found
    assert off(found[0], there) < 1.5


def test_nothing_is_detected_where_there_is_no_ball() -> None:
    assert not ms.detect(at(shot(None, 1), 0), ms.Circle, picked(shot(SMALL, 0), SMALL))


@pytest.mark.parametrize(("blur", "quality"), [(4.0, 0), (2.0, 15)])
def test_a_blurred_or_compressed_ball_is_tracked_and_found_again(blur: float, quality: int) -> None:
    balls = [(300.0 + 4.0 * k, 200.0 + k, 15.0) for k in range(30)]
    gone = range(12, 22)
    images = [shot(None if k in gone else ball, k, blur, quality) for k, ball in enumerate(balls)]
    tracker = ms.Tracker(ms.Circle, picked(images[0], balls[0]), start=balls[0][:2])
    for k, answer in enumerate(run(tracker, images)):
        if k in gone:
            assert isinstance(answer, ms.Lost), k
        elif k != gone.stop:  # it may take a frame to be sure of it
            assert off(answer, balls[k]) < 4.0, k


@pytest.mark.parametrize("prior", Prior)
@pytest.mark.parametrize(("blur", "quality"), [(0.7, 0), (0.7, 15), (2.0, 15), (4.0, 0)])
def test_the_match_set_is_that_of_the_fit_that_was_validated(blur: float, quality: int, prior: Prior) -> None:
    ball = 300.0, 200.0, 15.0
    image = shot(ball, 3, blur, quality)
    color = picked(image, ball)
    detector = Detector(tracking_fitter(ms.Circle, 64), Searcher(SIZE[1], SIZE[0], None, 7.5))
    found = 0
    for estimate, merit in detector.detections(image, color, prior):
        found += 1
        np.testing.assert_array_equal(detector.fitter.state, estimate.state)
        assert detector.fitter.statistics == estimate.fit
        assert 0.0 < merit <= 1.0
        assert off(track_of(detector.fitter, None, 0.0), ball) < 3.0
    assert found == 1 or prior is Prior.NONE  # which asks for more than a coded picture may show


def test_a_search_for_a_small_ball_has_small_cells() -> None:
    limits = SearchParameters()
    strides = [stride_for(848, limits, radius) for radius in (0.0, 2.5, 5.0, 7.5, 40.0, np.inf)]
    assert strides == sorted(strides)
    assert strides[0] == 1
    assert strides[-1] == stride_for(848, limits) == Searcher(848, 480).stride
    for radius in (2.5, 5.0, 7.5):
        assert radius / stride_for(848, limits, radius) >= limits.radius_cells
        assert Searcher(848, 480, limits, radius).stride == stride_for(848, limits, radius)
