"""A click on a ring, as of a printed marker: its outer outline is found, and dark discs are all found."""

import cv2
import numpy as np
import numpy.typing as npt
import pytest

import matchset as ms

PLACES = ((110, 120, 40), (320, 100, 28), (520, 140, 34), (200, 330, 30), (440, 340, 45))
DARK, BRIGHT = 40, 200


def printed(*shares: float) -> npt.NDArray[np.uint8]:
    """Gray picture of circles in circles, dark and bright by turns, in uneven light, oblique, blurred and noisy."""
    large = np.full((4 * 480, 4 * 640), BRIGHT, np.uint8)
    for x, y, radius in PLACES:
        for number, share in enumerate(shares):
            axes = (round(4 * share * radius), round(3.84 * share * radius))
            cv2.ellipse(large, (4 * x, 4 * y), axes, 30.0, 0.0, 360.0, DARK if number % 2 == 0 else BRIGHT, cv2.FILLED)
    picture = cv2.resize(large, (640, 480), interpolation=cv2.INTER_AREA) * np.linspace(0.75, 1.0, 640)
    noise = np.random.default_rng(5).normal(0.0, 2.5, picture.shape)
    return (cv2.GaussianBlur(picture, (0, 0), 1.0) + noise).clip(0, 255).astype(np.uint8)


def assert_all_are_found(found: list[ms.Circle]) -> None:
    assert len(found) == len(PLACES)
    for x, y, radius in PLACES:
        nearest = min(found, key=lambda each: np.hypot(each.x - x, each.y - y))
        assert np.hypot(nearest.x - x, nearest.y - y) < 1.5
        assert nearest.radius == pytest.approx(0.98 * radius, rel=0.03)


@pytest.mark.parametrize("shares", [(1.0, 0.6), (1.0, 0.6, 0.25), (1.0,)], ids=["ring", "ring and dot", "disc"])
def test_a_click_on_the_dark_rim_finds_the_outer_outlines_of_all(shares: tuple[float, ...]) -> None:
    picture = printed(*shares)
    x, y, radius = PLACES[0]
    color = ms.ColorModel.pick(picture, x + 0.8 * radius, y)
    assert color.is_hollow == (len(shares) > 1)
    assert_all_are_found([each.shape for each in ms.detect(picture, ms.Circle, color)])
    tracker = ms.MultiTracker(ms.Circle, color)
    for _ in range(8):
        targets = tracker.update(picture)
    assert_all_are_found([each.track.shape for each in targets if isinstance(each.track, ms.Track)])


def test_a_click_on_the_white_inside_of_a_ring_finds_that() -> None:
    picture = printed(1.0, 0.6)
    x, y, radius = PLACES[0]
    color = ms.ColorModel.pick(picture, x, y)
    tracker = ms.Tracker(ms.Circle, color)
    track = [tracker.update(picture) for _ in range(3)][-1]
    assert isinstance(track, ms.Track)
    assert track.shape.radius == pytest.approx(0.6 * 0.98 * radius, rel=0.04)


def test_a_tracker_follows_the_outer_outline_of_the_ring_that_was_clicked() -> None:
    picture = printed(1.0, 0.6, 0.25)
    x, y, radius = PLACES[0]
    tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(picture, x + 0.8 * radius, y))
    for shift in range(0, 60, 6):
        track = tracker.update(np.roll(picture, shift, axis=1))
        assert isinstance(track, ms.Track)
        assert min(abs(track.shape.radius / (0.98 * each[2]) - 1.0) for each in PLACES) < 0.03


def test_a_ring_stays_one_in_a_file_and_a_copy(tmp_path: object) -> None:
    x, y, radius = PLACES[0]
    color = ms.ColorModel.pick(printed(1.0, 0.6), x + 0.8 * radius, y)
    color.save(f"{tmp_path}/ring.npz")
    assert ms.ColorModel.load(f"{tmp_path}/ring.npz").is_hollow
    assert color.copy().is_hollow
