"""Composed crowds: exact truth, the same again, and other balls where they are reported."""

import numpy as np
import pytest
from benchmarks.crowds.cases import Case
from benchmarks.crowds.composed.coding import CODINGS, coded
from benchmarks.crowds.composed.footage import REPORTED, REPORTED_BACKGROUNDS, TUNED, TUNED_BACKGROUNDS, folder
from benchmarks.crowds.composed.picture import Laid, Look, Painter, noise_of, shares
from benchmarks.crowds.composed.scenes import COMPOSED, FIRST_REPORTED

pytest.importorskip("pymunk")
real = pytest.mark.skipif(not folder().is_dir(), reason=f"real footage is not here: {folder()}")


def test_shares_say_what_is_in_the_picture_and_behind_nothing() -> None:
    behind, before = (100.0, 100.0, 20.0), (120.0, 100.0, 20.0)
    half_out, away = (0.0, 300.0, 20.0), (-500.0, 300.0, 20.0)
    found = shares([behind, before, half_out, away])
    assert found == pytest.approx([0.609, 1.0, 0.5, 0.0], abs=0.03)


def test_a_ball_lies_where_it_was_laid() -> None:
    gray = np.full((480, 640, 3), 90, np.uint8)
    cut = np.full((104, 104, 3), 250.0, np.float32)
    painter = Painter([gray], softness=0.6, shade=0.0, floor=None)
    x, y, radius = 200.3, 150.7, 12.4
    ball = Laid(Look((cut, cut), 1.0), (x - 3.0, y), (x, y), (x + 3.0, y), radius, 0.4)
    picture = painter.paint(0, [ball], np.random.default_rng(0)).astype(float)
    bright = (picture.mean(axis=2) - 90.0)[120:180, 170:230]
    bright[bright < 8.0] = 0.0
    rows, columns = np.indices(bright.shape)
    assert float((bright * columns).sum() / bright.sum()) + 170.0 == pytest.approx(x, abs=0.1)
    assert float((bright * rows).sum() / bright.sum()) + 120.0 == pytest.approx(y, abs=0.1)
    assert float(bright.sum()) / 160.0 == pytest.approx(np.pi * radius**2, rel=0.03)


def test_noise_is_estimated() -> None:
    picture = np.random.default_rng(1).normal(100.0, 3.0, (200, 200)).astype(np.float32)
    assert noise_of(picture) == pytest.approx(3.0, rel=0.1)


@pytest.mark.parametrize("coding", CODINGS)
def test_coding_keeps_every_picture(coding: str) -> None:
    random = np.random.default_rng(0)
    pictures = [np.full((480, 640, 3), level, np.uint8) for level in random.integers(50, 200, 7)]
    got = list(coded(pictures, coding, 0.8))
    assert len(got) == 7
    assert all(abs(float(one.mean()) - float(other.mean())) < 4.0 for one, other in zip(pictures, got, strict=True))


@pytest.mark.parametrize("scene", COMPOSED)
def test_a_seed_makes_one_crowd_whose_balls_are_equal_and_seen(scene: str) -> None:
    crowd = Case(scene, 6, 3.0, 603).crowd()
    again, other = COMPOSED[scene](6, 3.0, 603), COMPOSED[scene](6, 3.0, 604)
    truth = [again.truth(k / 10.0) for k in range(30)]
    assert truth == [crowd.truth(k / 10.0) for k in range(30)]  # type: ignore[union-attr]
    assert truth != [other.truth(k / 10.0) for k in range(30)]
    clear = [ball for there in truth for ball in there if ball.visible > 0.9]
    assert len({ball.identity for ball in clear}) == 6
    radii = [ball.circle.radius for ball in clear]
    assert 6.0 < min(radii) <= max(radii) < 40.0
    assert max(radii) < 1.5 * min(radii)
    assert min(ball.visible for there in truth for ball in there) >= 0.0


def test_what_is_reported_was_not_tuned_on() -> None:
    assert not set(TUNED) & set(REPORTED)
    assert not {each.file for each in TUNED_BACKGROUNDS} & {each.file for each in REPORTED_BACKGROUNDS}
    for seed in range(FIRST_REPORTED - 5, FIRST_REPORTED + 5):
        crowd = COMPOSED["composed_swing"](3, 1.0, seed)
        assert (crowd.ball in REPORTED) == (crowd.background in REPORTED_BACKGROUNDS) == (seed >= FIRST_REPORTED)


@real
def test_pictures_are_the_same_again() -> None:
    first, again = (list(COMPOSED["composed_billiards"](4, 0.2, 605)) for _ in range(2))
    assert len(first) == len(again) >= 5
    for (one, seen), (other, same) in zip(first, again, strict=True):
        assert np.array_equal(one.image, other.image)
        assert seen == same
        assert one.image.shape == (480, 640, 3)
