"""Whatever the pictures show, the tracker answers with finite numbers or with a `Lost`, and never raises."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scenes import Answer, Picture, at, blue, run, scene

import matchset as ms

SHAPES = [(1, 1), (1, 7), (3, 3), (5, 1000), (1000, 5), (17, 23), (64, 64), (96, 128)]
MODELS = {
    1: ms.ColorModel(np.linspace(-4.0, 4.0, 256, dtype=np.float32)),
    3: blue(),
}


def assert_sound(answer: Answer) -> None:
    if isinstance(answer, ms.Track):
        circle = answer.shape
        assert all(map(math.isfinite, (circle.x, circle.y, circle.radius, answer.support)))
        assert circle.radius > 0.0
        assert 0.0 <= answer.support <= 1.0
        assert np.isfinite(answer.covariance).all()
        assert (np.linalg.eigvalsh(answer.covariance) > 0.0).all()
        assert np.isfinite(answer.match_set).all()
    else:
        assert not answer
        assert answer.reason


@pytest.mark.parametrize("channels", [1, 3])
@pytest.mark.parametrize("shape", SHAPES, ids=str)
@pytest.mark.parametrize("value", [0, 255])
def test_flat_pictures_hold_nothing(shape: tuple[int, int], channels: int, value: int) -> None:
    image = np.full(shape if channels == 1 else (*shape, 3), value, np.uint8)
    answers = run(ms.Tracker(ms.Circle, MODELS[channels]), [image] * 3)
    assert not any(answers)
    assert ms.detect(at(image, 0), ms.Circle, MODELS[channels]) == []


@pytest.mark.parametrize("channels", [1, 3])
@pytest.mark.parametrize("shape", SHAPES, ids=str)
def test_noise_holds_nothing(shape: tuple[int, int], channels: int) -> None:
    rng = np.random.default_rng(5)
    images = [rng.integers(0, 256, shape if channels == 1 else (*shape, 3), np.uint8) for _ in range(3)]
    tracker = ms.Tracker(ms.Circle, MODELS[channels])
    assert not any(run(tracker, images))
    tracker.start(ms.Circle(shape[1] / 2, shape[0] / 2, 10.0))
    for answer in run(tracker, images, begin=3):
        assert_sound(answer)
    assert not any(ms.detect(at(image, 0), ms.Circle, MODELS[channels]) for image in images)


@pytest.mark.parametrize(
    "circle",
    [(1e5, 0.0, 5.0), (-1e9, 1e9, 3.0), (50.0, 40.0, 1e-6), (50.0, 40.0, 1e6), (1e300, 1e300, 1e300), (0.0, 0.0, 2.0)],
)
def test_an_absurd_start_is_only_lost(circle: tuple[float, float, float]) -> None:
    tracker = ms.Tracker(ms.Circle, MODELS[3])
    tracker.start(ms.Circle(*circle))
    image = scene((200.0, 100.0, 30.0))
    for answer in run(tracker, [image] * 30):
        assert_sound(answer)
    assert answer


def picture(kind: str, seed: int, shape: tuple[int, ...]) -> Picture:
    rng = np.random.default_rng(seed)
    if kind == "noise":
        return rng.integers(0, 256, shape, np.uint8)
    if kind == "flat":
        return np.full(shape, rng.integers(0, 256), np.uint8)
    tile = rng.integers(0, 2, (2, 2, *shape[2:])) * 255
    steps = rng.integers(1, 12, 2)
    blocks = tile.repeat(steps[0], axis=0).repeat(steps[1], axis=1)
    counts = [-(-size // side) for size, side in zip(shape[:2], blocks.shape[:2], strict=True)]
    tiled = np.tile(blocks, (*counts, *(1 for _ in shape[2:])))
    return tiled[: shape[0], : shape[1]].astype(np.uint8)


@given(
    st.lists(st.tuples(st.sampled_from(("noise", "flat", "checks")), st.integers(0, 999)), min_size=1, max_size=5),
    st.tuples(st.integers(1, 70), st.integers(1, 70)),
    st.sampled_from((1, 3)),
    st.tuples(st.floats(-20, 90), st.floats(-20, 90), st.floats(0.1, 80)),
    st.booleans(),
)
@settings(max_examples=80, derandomize=True)
def test_any_pictures_from_any_start(
    kinds: list[tuple[str, int]],
    shape: tuple[int, int],
    channels: int,
    start: tuple[float, float, float],
    given_start: bool,
) -> None:
    tracker = ms.Tracker(ms.Circle, MODELS[channels], points=16)
    if given_start:
        tracker.start(ms.Circle(*start))
    full = shape if channels == 1 else (*shape, 3)
    for answer in run(tracker, (picture(kind, seed, full) for kind, seed in kinds)):
        assert_sound(answer)


def test_noise_is_no_target_even_where_half_of_it_has_the_targets_color() -> None:
    """As on an analog link that broke off: edge points lie everywhere, some of them on any circle."""
    blue_side = np.where(np.indices((32, 32, 32))[0] >= 16, 4.0, -4.0).astype(np.float32)
    answers = []
    for seed in range(12):
        rng = np.random.default_rng(seed)
        tracker = ms.Tracker(ms.Circle, ms.ColorModel(blue_side.ravel()))
        tracker.start(ms.Circle(80.0, 60.0, 25.0))
        for k in range(20):
            image = rng.integers(0, 256, (120, 160, 3), np.uint8)
            if k < 6:
                x, y = np.array([80.0, 60.0]) + rng.normal(0.0, 6.0, 2)
                rows, columns = np.indices((120, 160))
                image = np.where(np.hypot(columns - x, rows - y)[..., None] < 25.0, image // 8 + 160, image // 8 + 60)
            answers.append((k, tracker.update(ms.Frame(image.astype(np.uint8), k / 30, k))))
    assert all(isinstance(answer, ms.Track) for k, answer in answers if k < 6)
    assert sum(isinstance(answer, ms.Track) for k, answer in answers if k >= 6) <= 2  # of 168; 27 before
