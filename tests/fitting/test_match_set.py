"""The match-set against Eq. 1 to the letter, and against a slow twin."""

import math

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import naive_tracking as naive
from kernels import Limits, edges_across
from matchset import reference
from matchset.reference import Direction, Mask

SIDES: dict[Direction, tuple[int, int]] = {"right": (1, 0), "left": (-1, 0), "upper": (0, -1), "lower": (0, 1)}
Scores = npt.NDArray[np.int8]


def black_and_white(score: int) -> Scores:
    """A table that scores 0 for black and `score` for white."""
    table = np.zeros(256, np.int8)
    table[255] = score
    return table


def split(
    image: Mask, point: tuple[float, float], side: Direction, score: int, limits: Limits
) -> tuple[list[float], bool]:
    """Offsets of the edge points on one line, strongest first, and whether the line was looked at."""
    picture = np.where(image, 255, 0).astype(np.uint8)
    scaled = limits._replace(threshold=score * limits.threshold, full_step=score * limits.full_step)
    points, normals = np.array([point], float), np.array([SIDES[side]], float)
    found = edges_across(picture, black_and_white(score), points, normals, scaled)
    return found.offset[0][found.strength[0] > 0.0].tolist(), bool(found.looked[0])


def searched(image: Mask, point: tuple[float, float], side: Direction, limits: Limits) -> list[tuple[int, int]]:
    """Pixels (x, y) that are asked: as far as reach goes, with `margin` pixels of the picture on both sides."""
    x, y = (math.floor(value + 0.5) for value in point)
    dx, dy = (abs(value) for value in SIDES[side])
    far = int(limits.range_px) + 1
    size = image.shape[1] if dx else image.shape[0]
    pixels = [(x + k * dx, y + k * dy) for k in range(-far, far + 1)]
    return [p for p in pixels if limits.margin <= p[0] * dx + p[1] * dy < size - limits.margin]


def random_image(seed: int, shape: tuple[int, int], share: float, block: int) -> Mask:
    """White in some of its blocks, and every twentieth pixel turned over."""
    rng = np.random.default_rng(seed)
    height, width = shape
    blocks = rng.random((height // block + 1, width // block + 1)) < share
    image = blocks.repeat(block, axis=0).repeat(block, axis=1)[:height, :width]
    specks: Mask = image ^ (rng.random(shape) < 0.05)
    return specks


images = st.builds(
    random_image,
    st.integers(0, 10_000),
    st.tuples(st.integers(3, 26), st.integers(3, 26)),
    st.floats(0.1, 0.9),
    st.integers(1, 5),
)
MARGINS = st.integers(1, 4)


@given(
    images, st.data(), st.sampled_from(list(SIDES)), MARGINS, st.floats(0.0, 12.0), st.integers(1, 127),
    st.floats(0.0, 0.99), st.floats(0.05, 5.0),
)  # fmt: skip
@settings(max_examples=400, derandomize=True)
def test_a_split_is_an_edge_point_of_the_print(
    image: Mask,
    data: st.DataObject,
    side: Direction,
    margin: int,
    reach: float,
    score: int,
    share: float,
    enough: float,
) -> None:
    x = data.draw(st.floats(-0.49, image.shape[1] - 0.51), label="x")
    y = data.draw(st.floats(-0.49, image.shape[0] - 0.51), label="y")
    threshold = math.floor(share * margin)
    limits = Limits(reach, margin, threshold, enough)
    offsets, looked = split(image, (x, y), side, score, limits)
    pixels = searched(image, (x, y), side, limits)
    edges = reference.edge_points(image, margin, threshold)[side]
    difference = reference.edge_difference(image, margin)[side]
    if not any(edges[q, p] for p, q in pixels):
        assert offsets == []
        return
    most = max(difference[q, p] for p, q in pixels)
    dx, dy = SIDES[side]
    for rank, offset in enumerate(offsets):
        along = dx * (x - math.floor(x + 0.5)) + dy * (y - math.floor(y + 0.5)) + offset
        assert abs(along) <= int(reach) + 1.5
        near = [(p, q) for p, q in pixels if abs(dx * (p - x) + dy * (q - y) - offset) <= 0.5 + 1e-9]
        assert any(edges[q, p] for p, q in near)
        if rank == 0:
            assert any(difference[q, p] == most for p, q in near)
    if looked and most > 1:
        assert offsets  # at 1 the next pixel may have -1: as much contrast, so no peak


def test_all_lines_around_a_disc_agree_with_the_print() -> None:
    rows, columns = np.indices((60, 70))
    image = (columns - 33) ** 2 + (rows - 28) ** 2 <= 20**2
    limits = Limits(6.0, 3, 2.0, 3.0)
    edges = reference.edge_points(image, 3, 2)
    for side, (dx, dy) in SIDES.items():
        for k in range(-13, 14):
            reach = math.sqrt(20**2 - k * k)
            point = 33 + dx * reach + (k if dy else 0), 28 + dy * reach + (k if dx else 0)
            (offset,), looked = split(image, point, side, 100, limits)
            assert looked
            assert abs(offset) <= 1.0
            x, y = point[0] + dx * offset, point[1] + dy * offset
            beside = [(math.floor(x), math.floor(y)), (math.ceil(x), math.ceil(y))]
            assert any(edges[side][q, p] for p, q in beside)


def test_where_two_opposite_edges_touch_there_is_no_peak() -> None:
    """The one case in which Eq. 1 has an edge and the fast path none: as much contrast the other way beside it."""
    image = np.zeros((5, 7), bool)
    image[:, 1] = image[:, 4] = True  # at x = 2 one white pixel on the left, at x = 3 one on the right
    limits = Limits(0.0, 1)
    difference = reference.edge_difference(image, 1)["right"][2]
    assert difference.tolist() == [-1, 0, 1, -1, 0, 1, 0]
    assert split(image, (2.0, 2.0), "right", 1, limits) == ([], True)


def edge_table(rng: np.random.Generator, color: bool) -> naive.Scores:
    return rng.integers(-127, 128, 32768 if color else 256).astype(np.int8)


@pytest.mark.parametrize("combed", [False, True])
@pytest.mark.parametrize("color", [False, True])
@pytest.mark.parametrize("seed", range(12))
def test_the_kernel_is_its_slow_twin(seed: int, color: bool, combed: bool) -> None:
    rng = np.random.default_rng(seed)
    shape = (int(rng.integers(5, 60)), int(rng.integers(5, 60)), 3 if color else 1)
    image = rng.integers(0, 256, shape, np.uint8)
    if seed % 2:
        image = image.repeat(3, axis=0).repeat(3, axis=1)  # edges that are not only noise, and equal neighbors
    table = edge_table(rng, color)
    angles = rng.uniform(0.0, 2.0 * np.pi, 60)
    angles[:8] = 0.25 * np.pi * np.arange(8)
    normals = np.column_stack((np.cos(angles), np.sin(angles)))
    points = rng.uniform(-4.0, np.array(image.shape[1::-1]) + 3.0, (60, 2))
    margin = int(rng.integers(1, 5))
    full = 254.0 * margin
    plain = float(rng.choice([0.0, 2e4, 1e9]))
    limits = Limits(float(rng.uniform(0.0, 30.0)), margin, -0.05 * full, 0.6 * full, plain, combed)
    found = edges_across(image, table, points, normals, limits)
    for i in range(60):
        seen = image, points[i], normals[i]
        if combed and abs(normals[i, 1]) > abs(normals[i, 0]):
            seen = naive.one_field(*seen, i % 2)
        picture, point, normal = seen
        expected = naive.edge_points(picture, table, point, normal, limits)
        assert found.looked[i] == (naive.line(picture.shape, point, normal, limits) is not None)
        there = np.column_stack((found.offset, found.strength, found.whiteness))[i].reshape(3, 3).T
        there = there[there[:, 1] > 0.0]
        np.testing.assert_allclose(there, np.array(expected).reshape(-1, 3), rtol=1e-5, atol=1e-9)


def test_a_line_is_long_at_most_and_far_points_are_left_alone() -> None:
    image = np.zeros((20, 400), np.uint8)
    image[:, :121] = 255
    points = np.array([[200.0, 10.0], [150.0, 10.0], [1e7, 10.0], [np.nan, 10.0], [10.0, np.inf], [-1e300, 0.0]])
    normals = np.tile([1.0, 0.0], (6, 1))
    found = edges_across(image, black_and_white(127), points, normals, Limits(1e5, 2))
    assert found.looked.tolist() == [True, True, False, False, False, False]
    assert found.strength[0].tolist() == [0.0, 0.0, 0.0]  # 80 px away
    assert found.offset[1, 0] == pytest.approx(-29.5)


@pytest.mark.parametrize("sigma", [0.0, 2.0, 8.0])
def test_the_noise_is_told(sigma: float) -> None:
    noise = np.random.default_rng(1).normal(120.0, sigma, (200, 200, 3))
    image = np.rint(noise).clip(0, 255).astype(np.uint8)
    points = np.random.default_rng(2).uniform(60.0, 140.0, (512, 2))
    angles = np.linspace(0.0, 6.28, 512)
    normals = np.column_stack((np.cos(angles), np.sin(angles)))
    found = edges_across(image, np.zeros(32768, np.int8), points, normals, Limits(4.0, 2))
    assert found.noise == pytest.approx(sigma, rel=0.15, abs=0.01)
