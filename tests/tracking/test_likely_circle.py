"""`detect` compares all fits where none is sure: balls too small, blurred and compressed for their outline alone."""

import math
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt
import pytest

import matchset as ms
from matchset.image.circle_score import KEPT, CircleTuple, sample_of
from matchset.tracking.search.likely_circle import LikelyCircle, LikelyParameters, look_of

Picture = npt.NDArray[np.uint8]
GREEN, LEAF = (70.0, 170.0, 90.0), (85.0, 150.0, 105.0)


def picture(ball: CircleTuple | None, blur: float = 0.8, quality: int = 95, leaves: bool = True) -> Picture:
    """A shaded ball before a mottled wall, a bush of a similar color at the right."""
    rng = np.random.default_rng(3)
    rows, columns = np.indices((240, 320))
    wall = cv2.GaussianBlur(rng.normal(0.0, 30.0, (240, 320)), (0, 0), 3.0)
    image = np.full((240, 320, 3), (140.0, 135.0, 130.0)) + wall[..., np.newaxis]
    if leaves:
        for x, y, size in rng.integers((230, 10, 3), (310, 230, 9), (250, 3)).tolist():
            image[y : y + size // 2, x : x + size] = np.array(LEAF) * rng.uniform(0.3, 1.2)
    if ball is not None:
        x, y, radius = ball
        away = np.hypot(columns - x, rows - y)
        light = 1.0 - 0.35 * (rows - y) / radius
        image = np.where((away < radius)[..., np.newaxis], np.array(GREEN) * light[..., np.newaxis], image)
    soft = cv2.GaussianBlur(np.clip(image + rng.normal(0.0, 3.0, image.shape), 0, 255).astype(np.uint8), (0, 0), blur)
    coded = cv2.imencode(".jpg", soft, [cv2.IMWRITE_JPEG_QUALITY, quality])[1]
    return np.asarray(cv2.imdecode(coded, cv2.IMREAD_COLOR), np.uint8)


@pytest.fixture(scope="module")
def color() -> ms.ColorModel:
    return ms.ColorModel.pick(picture((100.0, 120.0, 12.0), quality=50), 98.0, 118.0)


def test_a_color_of_a_file_finds_the_same_as_that_of_the_click(color: ms.ColorModel, tmp_path: Path) -> None:
    color.save(tmp_path / "ball.npz")
    image = picture((150.0, 180.0, 8.0), 2.0, 35)
    picked, loaded = (ms.detect(image, ms.Circle, each) for each in (color, ms.ColorModel.load(tmp_path / "ball.npz")))
    assert picked
    assert [track.shape for track in picked] == [track.shape for track in loaded]


def test_of_a_large_ball_a_part_of_the_pixels_is_kept_and_looks_the_same() -> None:
    small = picture((150.0, 120.0, 40.0))
    large = np.asarray(cv2.resize(small, None, fx=3.0, fy=3.0), np.uint8)
    looks = []
    for image, circle in ((small, (150.0, 120.0, 40.0)), (large, (451.0, 361.0, 120.0))):
        sample = sample_of(image, circle)
        assert sample.radius == circle[2]
        assert max(sample.image.shape) <= 2 * KEPT
        color = ms.ColorModel.pick(image, *circle[:2])
        looks.append(look_of(sample.image, color, sample.circle))
    first, second = looks
    assert first is not None
    assert second is not None
    np.testing.assert_allclose(second.color, first.color, atol=0.02)
    np.testing.assert_allclose(second.step, first.step, atol=0.02)


def test_a_click_keeps_how_the_ball_looked(color: ms.ColorModel) -> None:
    assert color.sample is not None
    assert color.circle is not None
    assert color.sample.circle[2] == color.circle[2]
    look = look_of(color.sample.image, color, color.sample.circle)
    assert look is not None
    assert look.core > 0.8 > 0.0 > look.around
    assert color.copy().sample is color.sample
    assert look_of(color.sample.image, color, (-500.0, 0.0, 10.0)) is None


@pytest.mark.parametrize(
    ("place", "blur"), [((60.0, 60.0, 6.0), 1.2), ((150.0, 180.0, 8.0), 2.0), ((120.0, 50.0, 20.0), 3.0)]
)
def test_small_and_blurred_balls_in_compressed_pictures_are_found(
    color: ms.ColorModel, place: CircleTuple, blur: float
) -> None:
    found = ms.detect(picture(place, blur, 35), ms.Circle, color)
    assert found
    circle = found[0].shape
    assert math.hypot(circle.x - place[0], circle.y - place[1]) < 0.4 * place[2]
    assert 1 / 1.4 < circle.radius / place[2] < 1.4


def test_leaves_of_its_color_are_no_ball(color: ms.ColorModel) -> None:
    assert ms.detect(picture(None, 1.2, 35), ms.Circle, color) == []
    assert ms.detect(picture(None, 1.2, 35, leaves=False), ms.Circle, color) == []


def test_a_ball_must_lead_all_other_places_or_be_clear(color: ms.ColorModel) -> None:
    likely = LikelyCircle(color, LikelyParameters(present=1.0, lead=0.5, most_lead=4.0))
    here, near, there = (50.0, 50.0, 10.0), (53.0, 50.0, 11.0), (90.0, 50.0, 10.0)
    assert likely.is_there([(0.5, here), (0.4, near), (-1.0, there)])
    assert not likely.is_there([(0.5, here), (0.4, near), (0.4, there)])
    assert likely.is_there([(1.1, here), (1.1, there)])
    assert not likely.is_there([(-1.5, here)])


def test_the_answer_is_the_mean_of_the_likely_fits_there(color: ms.ColorModel) -> None:
    likely = LikelyCircle(color, LikelyParameters())
    found = [
        (2.0, (50.0, 50.0, 10.0)),
        (2.0, (54.0, 50.0, 10.0)),
        (-40.0, (50.0, 55.0, 9.0)),
        (1.9, (90.0, 50.0, 10.0)),
    ]
    mean, covariance = likely.mean(found)
    assert mean == pytest.approx((52.0, 50.0, 10.0), abs=1e-6)
    assert covariance == pytest.approx(np.diag((4.0, 0.0, 0.0)), abs=1e-6)
    alone, none = likely.mean(found[:1])
    assert alone == pytest.approx((50.0, 50.0, 10.0))
    assert none == pytest.approx(np.zeros((3, 3)))
