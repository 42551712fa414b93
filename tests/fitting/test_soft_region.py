"""Regions of blurred discs: center and size whatever blurs them, and no worth where the rim is sharp or cut."""

from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from matchset.fitting.soft_region import SoftRegionParameters, find_soft_region
from matchset.fitting.soft_region_kernel import IN_REGION, REGION_MEMORY, _measure_swept
from matchset.numeric.jit import interpreted

Image = npt.NDArray[np.uint8]
LIMITS = SoftRegionParameters()
X, Y, RADIUS = 151.0, 118.0, 30.0


def streak(length: float, defocus: float = 0.0, radius: float = RADIUS) -> Image:
    """Disc that moved along x while it was seen, before a wall of stripes."""
    rows, columns = np.mgrid[0:240, 0:300].astype(np.float64)
    wall = np.where((columns // 9 + rows // 14) % 2 > 0, 150.0, 90.0)[:, :, np.newaxis] * np.ones(3)
    places = np.linspace(-0.5, 0.5, 41) * length
    covers = [np.clip(radius - np.hypot(columns - X - place, rows - Y) + 0.5, 0.0, 1.0) for place in places]
    cover = np.mean(covers, axis=0)
    if defocus:
        cover = cv2.GaussianBlur(cover, (0, 0), defocus)
    picture = wall + cover[:, :, np.newaxis] * (np.array([40.0, 190.0, 210.0]) - wall)
    noise = np.random.default_rng(0).normal(0.0, 3.0, picture.shape)
    return np.asarray(np.clip(picture + noise, 0, 255), np.uint8)


@pytest.mark.parametrize(("length", "defocus"), [(20.0, 3.0), (30.0, 4.0), (0.0, 6.0)])
def test_blurred_disc_is_found_from_beside_it(length: float, defocus: float) -> None:
    found = find_soft_region(streak(length, defocus), (X + 6.0, Y - 5.0, 1.1 * RADIUS), LIMITS)
    assert found is not None
    assert abs(found.x - X) < 1.0
    assert abs(found.y - Y) < 1.0
    assert found.half_width == pytest.approx(RADIUS, abs=2.5)
    assert found.worth(LIMITS) > 0.0


def test_sharp_disc_needs_no_region() -> None:
    found = find_soft_region(streak(0.0, 1.0), (X + 3.0, Y, RADIUS), LIMITS)
    assert found is not None
    assert found.rim < LIMITS.soft
    assert found.worth(LIMITS) == 0.0


def test_half_a_disc_is_worth_nothing() -> None:
    """A sheet of paper hides the half of a blurred disc: its center and area are those of the part that is seen."""
    picture = streak(20.0, 3.0)
    picture[:, 152:] = 235
    found = find_soft_region(picture, (X, Y, RADIUS), LIMITS)
    assert found is None or found.worth(LIMITS) == 0.0


def test_disc_cut_by_the_border_and_plain_wall_have_none() -> None:
    picture = streak(20.0, 3.0)
    assert find_soft_region(np.ascontiguousarray(picture[:, 140:]), (X - 140.0, Y, RADIUS), LIMITS) is None
    assert find_soft_region(np.full((240, 300, 3), 120, np.uint8), (X, Y, RADIUS), LIMITS) is None
    assert find_soft_region(picture, (X, Y, 3.0), LIMITS) is None


def test_gray_pictures_have_regions_too() -> None:
    plain = np.full((240, 300), 60.0)
    rows, columns = np.mgrid[0:240, 0:300]
    plain[np.hypot(columns - X, rows - Y) < RADIUS] = 200.0
    gray = cv2.GaussianBlur(plain, (0, 0), 6.0).astype(np.uint8)[:, :, np.newaxis]
    found = find_soft_region(gray, (X + 4.0, Y, RADIUS), LIMITS)
    assert found is not None
    assert found.half_width == pytest.approx(RADIUS, abs=2.5)
    assert found.worth(LIMITS) > 0.0


@pytest.mark.parametrize(("blur", "other"), [(1.0, True), (6.0, False)])
def test_square_is_another_shape_where_its_rim_is_sharp(blur: float, other: bool) -> None:
    plain = np.full((240, 300, 3), 120, np.uint8)
    plain[90:146, 123:179] = (150, 60, 20)
    found = find_soft_region(np.asarray(cv2.GaussianBlur(plain, (0, 0), blur), np.uint8), (X, Y, 31.0), LIMITS)
    assert found is not None
    assert found.is_other(LIMITS) == other


def test_sharp_disc_is_no_other_shape() -> None:
    found = find_soft_region(streak(0.0, 1.0), (X + 3.0, Y, RADIUS), LIMITS)
    assert found is not None
    assert not found.is_other(LIMITS)


@pytest.mark.parametrize("length", [30.0, 45.0, 60.0])
def test_a_streak_agrees_with_a_swept_disc(length: float) -> None:
    found = find_soft_region(streak(length, 4.0), (X + 3.0, Y, 1.2 * RADIUS), LIMITS)
    assert found is not None
    assert found.swept > 0.94
    assert abs(found.x - X) < 1.0
    assert found.worth(LIMITS) == LIMITS.worth


def test_half_a_disc_agrees_with_none() -> None:
    plain = np.full((240, 300, 3), 120, np.uint8)
    rows, columns = np.mgrid[0:240, 0:300]
    plain[(np.hypot(columns - X, rows - Y) < RADIUS) & (rows > Y)] = (40, 190, 210)
    found = find_soft_region(plain, (X, Y, RADIUS), LIMITS)
    assert found is None or found.worth(LIMITS) == 0.0


REGIONS = {
    "a cell": np.ones((1, 1), bool),
    "a row": np.ones((1, 20), bool),
    "a column": np.ones((20, 1), bool),
    "a diagonal": np.eye(17, dtype=bool),
    "the other diagonal": np.eye(23, dtype=bool)[::-1],
}


def swept_agreement(region: npt.NDArray[np.bool_]) -> float:
    """Agreement of a region of square shape with the swept disc of its moments."""
    memory = np.zeros(1, REGION_MEMORY).view(np.recarray)[0]
    memory.count = len(region)
    memory.labels[: region.size] = np.where(region.ravel(), IN_REGION, 0)
    interpreted(_measure_swept)(memory)
    return float(memory.swept)


@pytest.mark.parametrize("cells", REGIONS.values(), ids=REGIONS)
def test_a_region_of_one_row_of_cells_is_half_a_cell_wide_to_each_side(cells: npt.NDArray[np.bool_]) -> None:
    region = np.zeros((40, 40), bool)
    region[5 : 5 + cells.shape[0], 7 : 7 + cells.shape[1]] = cells
    assert 0.7 < swept_agreement(region) <= 1.0  # a diagonal of as many cells is longer than a row


def test_two_rows_are_a_swept_disc_as_before() -> None:
    region = np.zeros((40, 40), bool)
    region[5:7, 7:30] = True
    assert 0.8 < swept_agreement(region) <= 1.0


@settings(max_examples=150)
@given(st.integers(0, 2**32 - 1), st.floats(0.02, 0.98), st.integers(1, 12), st.integers(1, 12))
def test_any_region_has_an_agreement(seed: int, share: float, rows: int, columns: int) -> None:
    region = np.zeros((16, 16), bool)
    region[:rows, :columns] = np.random.default_rng(seed).random((rows, columns)) < share
    region[rows // 2, columns // 2] = True
    assert 0.0 <= swept_agreement(region) <= 1.0


def test_a_line_across_the_disc_is_no_blurred_target() -> None:
    """A bright hair over the place where a blurred ball was expected: one row of cells differs from the rest."""
    rng = np.random.default_rng(1)
    for width in (1, 2, 3, 5, 9):
        for angle in np.linspace(0.0, np.pi, 7):
            picture = np.asarray(rng.integers(90, 96, (240, 300, 3)), np.uint8)
            away = 60.0 * np.array((np.cos(angle), np.sin(angle)))
            begin, end = ((round(X + sign * away[0]), round(Y + sign * away[1])) for sign in (-1, 1))
            cv2.line(picture, begin, end, (40, 190, 210), width)
            for size in (5.0, 8.0, RADIUS):
                found = find_soft_region(picture, (X, Y, size), LIMITS)
                assert found is None or np.isfinite(found).all()


@settings(max_examples=60)
@given(st.integers(0, 2**32 - 1), st.sampled_from([1, 3]), st.integers(1, 40), st.floats(5.0, 30.0))
def test_noise_and_speckles_never_raise(seed: int, channels: int, speckle: int, size: float) -> None:
    rng = np.random.default_rng(seed)
    few = np.asarray(rng.integers(0, 256, (max(96 // speckle, 1), max(128 // speckle, 1), channels)), np.uint8)
    picture = np.asarray(cv2.resize(few, (128, 96), interpolation=cv2.INTER_NEAREST), np.uint8)
    picture = picture.reshape(96, 128, channels)
    found = find_soft_region(picture if channels == 3 else picture[:, :, 0], (64.0, 48.0, size), LIMITS)
    assert found is None or np.isfinite(found).all()


@pytest.mark.parametrize(
    "wrong", [{"softer": 0.18}, {"agrees": 0.8}, {"agreement": 0.9}, {"cells": 0}, {"lines": 0}, {"pixel_noise": 0.0}]
)
def test_limits_that_divide_by_zero_are_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=f"{next(iter(wrong.values()))}"):
        SoftRegionParameters(**wrong)
