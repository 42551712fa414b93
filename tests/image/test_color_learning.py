import numpy as np
import numpy.typing as npt
import pytest

from matchset.image.click_region import background_mask, grow_region, uniform_seed
from matchset.image.color_learning import features

Mask = npt.NDArray[np.bool_]
ROWS, COLUMNS = np.indices((120, 160))


def disc(x: float, y: float, radius: float) -> Mask:
    inside: Mask = np.hypot(COLUMNS - x, ROWS - y) <= radius
    return inside


def picture(noise: float = 4.0, shaded: bool = False) -> npt.NDArray[np.uint8]:
    """A blue disc at (70, 60), another of the same color apart from it, on gray."""
    image = np.full((120, 160, 3), 140.0)
    light = 1.0 + 0.35 * (COLUMNS - 70) / 28 if shaded else np.ones((120, 160))
    for each in (disc(70, 60, 28), disc(135, 20, 14)):
        image[each] = (np.array([180.0, 70.0, 40.0]) * light[:, :, np.newaxis])[each]
    image += np.random.default_rng(0).normal(0.0, noise, image.shape)
    rounded: npt.NDArray[np.uint8] = np.rint(image).clip(0, 255).astype(np.uint8)
    return rounded


def overlap(a: Mask, b: Mask) -> float:
    return float((a & b).sum() / (a | b).sum())


@pytest.mark.parametrize("noise", [0.0, 4.0, 10.0])
@pytest.mark.parametrize(("shaded", "gray"), [(False, False), (True, False), (False, True)])
def test_a_region_grows_to_its_own_edge(noise: float, shaded: bool, gray: bool) -> None:
    image = picture(noise, shaded)
    region = grow_region(features(image[:, :, 2] if gray else image), disc(66, 58, 4))
    assert overlap(region, disc(70, 60, 28)) > 0.75  # the smoothed rim is left out
    assert not (region & disc(135, 20, 10)).any()


def test_the_seed_always_belongs() -> None:
    seed = disc(70, 60, 4) | disc(20, 20, 2)
    assert (grow_region(features(picture()), seed) & seed).sum() == seed.sum()
    flat = np.full((30, 40), 9, np.uint8)
    np.testing.assert_array_equal(grow_region(features(flat), seed[:30, :40]), seed[:30, :40])


@pytest.mark.parametrize(("x", "y"), [(70, 60), (50, 60), (96, 60), (70, 34)])
def test_the_uniform_seed_is_beside_the_click_and_not_on_the_rim(x: int, y: int) -> None:
    place = uniform_seed(features(picture()), x, y)
    rows, columns = np.nonzero(place)
    assert np.hypot(columns - x, rows - y).max() <= 10.0
    assert 20 <= place.sum() <= 29
    assert (place & disc(70, 60, 28)).sum() >= 0.9 * place.sum()


@pytest.mark.parametrize(("x", "y"), [(0, 0), (159, 119), (-0.5, 60)])
def test_a_uniform_seed_at_the_border_is_in_the_picture(x: float, y: float) -> None:
    assert uniform_seed(features(picture()), x, y).sum() >= 8


def test_the_background_keeps_their_distance() -> None:
    outside = background_mask(disc(70, 60, 20))
    assert outside[60, 70 + 33]
    assert not outside[60, 70 + 30]
    assert not (outside & disc(70, 60, 29)).any()
    assert not background_mask(np.ones((30, 30), bool)).any()
