"""From one click to the pixels of the target, on rendered things before textured backgrounds."""

import functools
import math
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt
import pytest
from benchmarks.shapes.cases import CASES
from hypothesis import given, settings
from hypothesis import strategies as st

import matchset as ms
from matchset.image.click_region import disc_mask, regions_at_click
from matchset.image.color_learning import ColorParameters, RegionParameters
from matchset.image.disc_network.click_discs import BallAtClickParameters

Picture = npt.NDArray[np.uint8]
Mask = npt.NDArray[np.bool_]
RADII = [4, 7, 14, 40, 120]
X, Y = 330.4, 241.7


@functools.cache
def textured(seed: int = 0, size: tuple[int, int] = (480, 640), spread: float = 10.0) -> Picture:
    """A wall with large and small spots and with noise."""
    rng = np.random.default_rng(seed)
    image = np.full((*size, 3), (120.0, 125.0, 130.0))
    for blur in (3.0, 20.0):
        spots = cv2.GaussianBlur(rng.normal(0.0, 1.0, image.shape), (0, 0), blur)
        image += 0.5 * spread * spots / spots.std()
    image += rng.normal(0.0, 2.0, image.shape)
    rounded: Picture = np.rint(image).clip(0, 255).astype(np.uint8)
    rounded.flags.writeable = False
    return rounded


def paint(image: Picture, inside: Mask, color: tuple[float, float, float]) -> Picture:
    """The picture with a region in one color, with some noise and a soft rim."""
    cover = cv2.GaussianBlur(inside.astype(np.float32), (0, 0), 0.7)[..., np.newaxis]
    value = np.asarray(color) + np.random.default_rng(7).normal(0.0, 3.0, image.shape)
    mixed: Picture = np.rint(image + cover * (value - image)).clip(0, 255).astype(np.uint8)
    return mixed


def disc(shape: tuple[int, ...], x: float = X, y: float = Y, radius: float = 40.0) -> Mask:
    return disc_mask(shape, (x, y, radius), 1.0)


def gray_of(image: Picture) -> Picture:
    return np.asarray(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), np.uint8)


def reading_at(image: Picture, click: tuple[float, float]) -> tuple[float, float, float]:
    """Circle of the likeliest reading of a click."""
    return regions_at_click(image, *click)[1][0].circle


def overlap(a: Mask, b: Mask) -> float:
    return float((a & b).sum() / (a | b).sum())


@pytest.mark.parametrize("gray", [False, True])
@pytest.mark.parametrize("radius", RADII)
def test_a_disc_is_found_wherever_it_is_clicked(radius: int, gray: bool) -> None:
    image = paint(textured(radius), disc((480, 640), radius=radius), (190.0, 60.0, 30.0))
    image = gray_of(image) if gray else image
    for turn, share in ((0.3, 0.0), (2.9, 0.6), (5.3, 0.6)):
        click = X + share * radius * math.cos(turn), Y + share * radius * math.sin(turn)
        x, y, r = reading_at(image, click)
        assert math.hypot(x - X, y - Y) < 0.1 * radius + 1.0, click
        assert abs(r - radius) < 0.1 * radius + 1.0, click


@pytest.mark.parametrize("size", [(1, 1), (3, 5), (9, 400)])
def test_small_and_narrow_pictures_are_no_error(size: tuple[int, int]) -> None:
    image = np.random.default_rng(1).integers(0, 256, (*size, 3), np.uint8)
    for x, y in ((0.0, 0.0), (size[1] - 1.0, size[0] - 1.0)):
        regions, _ = regions_at_click(image, x, y)
        assert all(region.shape == size and region.any() for region in regions)


@settings(max_examples=25)
@given(x=st.floats(-30.0, 60.0), y=st.floats(-30.0, 60.0), radius=st.floats(0.0, 50.0), share=st.floats(0.1, 1.0))
def test_the_pixels_of_a_disc_are_those_within_it(x: float, y: float, radius: float, share: float) -> None:
    mask = disc_mask((24, 33), (x, y, radius), share)
    for row, column in ((0, 0), (23, 32), (12, 16), (round(min(max(y, 0), 23)), round(min(max(x, 0), 32)))):
        away = math.hypot(column - x, row - y)
        if abs(away - share * radius) > 1e-6:
            assert mask[row, column] == (away < share * radius)


@pytest.mark.parametrize(("border", "share"), [(-8.0, -0.6), (0.0, -0.6), (0.0, 0.6), (8.0, 0.6)])
def test_a_ball_of_two_tones_is_taken_whole(border: float, share: float) -> None:
    """Clicked at the smaller of its parts, which looks like a half disc or a cap."""
    whole = disc((480, 640), radius=45.0)
    upper = whole & (np.indices((480, 640))[0] < Y + border)
    image = paint(paint(textured(spread=4.0), whole, (40.0, 60.0, 200.0)), upper, (110.0, 130.0, 225.0))
    regions, (taken, *_) = regions_at_click(image, X, Y + share * 45.0)
    circle = taken.circle
    assert np.hypot(circle[0] - X, circle[1] - Y) < 4.0
    assert overlap(regions[0], whole) > 0.7
    assert regions[0][whole & ~upper].mean() > 0.7
    assert regions[0][upper].mean() > 0.7


@pytest.mark.parametrize("radius", [9.0, 12.0])
@pytest.mark.parametrize("click", [(0.0, -0.5), (0.25, -0.3), (0.0, 0.0)])
def test_the_lit_part_of_a_ball_is_not_the_ball(radius: float, click: tuple[float, float]) -> None:
    """A gray ball before a light wall, with a green spot where the light falls on it."""
    image = paint(textured(spread=2.0) // 2 + 135, disc((480, 640), radius=radius), (105.0, 112.0, 108.0))
    spot = disc((480, 640), X + 0.15 * radius, Y - 0.3 * radius, 0.55 * radius)
    image = cv2.GaussianBlur(paint(image, spot, (120.0, 150.0, 85.0)), (0, 0), 0.08 * radius).astype(np.uint8)
    circle = reading_at(image, (X + click[0] * radius, Y + click[1] * radius))
    assert math.hypot(circle[0] - X, circle[1] - Y) < 0.2 * radius
    assert abs(circle[2] - radius) < 0.2 * radius


def test_a_vivid_ball_before_a_plate_is_the_ball() -> None:
    image = paint(textured(spread=2.0), disc((480, 640), radius=50.0), (140.0, 145.0, 145.0))
    image = paint(image, disc((480, 640), radius=30.0), (60.0, 60.0, 200.0))
    assert reading_at(image, (X + 10.0, Y)) == pytest.approx((X, Y, 30.0), abs=4.0)


def with_a_patch(shelf: bool) -> Picture:
    """A red ball with a pale patch, which is clicked; before a wall with a shelf of the patch's color, or without."""
    image = paint(textured(spread=2.0), disc((480, 640), radius=24.0), (35.0, 55.0, 170.0))
    pale = disc((480, 640), X - 9.6, Y - 9.6, 10.0)
    pale[:60] = shelf
    return cv2.GaussianBlur(paint(image, pale, (120.0, 170.0, 190.0)), (0, 0), 1.0).astype(np.uint8)


def test_the_ball_around_a_part_of_the_color_of_a_shelf_can_be_asked_for() -> None:
    image = with_a_patch(shelf=True)
    first = ms.ColorModel.pick(image, X - 10.0, Y - 10.0)
    assert [each.name for each in first.alternatives][:2] == ["ball", "ball around it"]
    color = ms.ColorModel.pick(image, X - 10.0, Y - 10.0, reading=2)
    assert color.circle == pytest.approx((X, Y, 24.0), abs=3.0)
    looks = color.scores(image) > 0
    assert looks[disc((480, 640), radius=21.0)].mean() > 0.7
    assert looks[~disc((480, 640), radius=27.0)].mean() < 0.05


def test_a_part_of_a_color_of_its_own_is_what_was_clicked() -> None:
    image = with_a_patch(shelf=False)
    color = ms.ColorModel.pick(image, X - 10.0, Y - 10.0)
    looks = color.scores(image) > 0
    assert looks[disc((480, 640), X - 9.6, Y - 9.6, 7.0)].all()
    assert not looks[disc((480, 640), X + 8.0, Y + 8.0, 8.0)].any()


def leaking() -> tuple[Picture, Mask]:
    """A ball that runs into a long thin bar and a far beam of its own color."""
    ball = disc((480, 640), radius=30.0)
    bars = np.zeros((480, 640), bool)
    bars[round(Y) - 7 : round(Y) + 7, 40 : round(X)] = True
    bars[40:440, 40:60] = True
    bars[40:60, 40:600] = True
    return paint(textured(spread=4.0), ball | bars, (60.0, 180.0, 60.0)), ball


def test_a_region_that_leaks_is_replaced_by_the_circle() -> None:
    image, ball = leaking()
    regions, (taken, *_) = regions_at_click(image, X + 5.0, Y)
    circle = taken.circle
    assert math.hypot(circle[0] - X, circle[1] - Y) < 4.0
    assert not (regions[0] & ~disc((480, 640), radius=34.0)).any()
    assert overlap(regions[0], ball) > 0.6


def test_how_a_click_is_understood_can_be_said() -> None:
    image, _ = leaking()
    leaks = ColorParameters(region=RegionParameters(far=100.0))
    regions, (taken, *_) = regions_at_click(image, X + 5.0, Y, leaks)
    assert (regions[0] & ~disc((480, 640), radius=34.0)).any()
    assert ms.ColorModel.pick(image, X + 5.0, Y, leaks).circle == taken.circle
    nothing = ColorParameters(ball=BallAtClickParameters(used=False))
    assert [each.name for each in regions_at_click(image, X + 5.0, Y, nothing)[1]] == ["region"]
    with pytest.raises(
        ValueError, match=r"no background is left to learn from, nor does anything round .* click elsewhere"
    ):
        ms.ColorModel.pick(image, X + 5.0, Y, nothing)


@pytest.mark.parametrize("radius", [5.0, 7.0, 10.0])
def test_a_small_ball_between_blocks_is_not_refused(radius: float) -> None:
    """Gray blocks of a coarse picture about as different from each other as the ball is from them."""
    rng = np.random.default_rng(7)
    blocks = np.repeat(np.repeat(rng.integers(110, 150, (15, 20)), 16, axis=0), 16, axis=1)
    image = np.repeat(blocks[:, :, np.newaxis], 3, axis=2).astype(np.uint8)
    rows, columns = np.indices(image.shape[:2])
    image[np.hypot(columns - 160.0, rows - 120.0) < radius] = (150, 120, 95)
    image = np.asarray(cv2.imdecode(cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, 40])[1], cv2.IMREAD_COLOR))
    for parameters in (ColorParameters(), ColorParameters(least_hits=1.1)):  # its color told, and refused
        circle = ms.ColorModel.pick(image, 160.0 + 0.4 * radius, 120.0, parameters).circle
        assert circle is not None
        assert math.hypot(circle[0] - 160.0, circle[1] - 120.0) < 0.5 * radius
        assert 0.6 < circle[2] / radius < 1.7


def faint(seed: int, radius: float = 6.0, step: float = 16.0, noise: float = 12.0) -> Picture:
    """A disc at (80, 60) whose step is about the noise of a pixel: no outline is closed."""
    rng = np.random.default_rng(seed)
    rows, columns = np.indices((120, 160))
    inside = np.hypot(columns - 80.0, rows - 60.0) < radius
    values = 110.0 + step * inside[:, :, np.newaxis] * np.array((0.2, 1.0, -0.6)) + rng.normal(0, noise, (120, 160, 3))
    return np.asarray(np.clip(np.rint(values), 0, 255), np.uint8)


@pytest.mark.parametrize("seed", range(4))
def test_a_faint_disc_that_no_outline_closes_is_found(seed: int) -> None:
    for image in (faint(seed), faint(seed, step=40.0).max(axis=2)):
        found = reading_at(image, (82.0, 58.0))
        assert math.hypot(found[0] - 80.0, found[1] - 60.0) < 2.0
        assert 0.6 < found[2] / 6.0 < 1.6


@pytest.mark.parametrize("seed", range(4))
def test_noise_has_no_disc(seed: int) -> None:
    with pytest.raises(ValueError, match="click elsewhere"):
        ms.ColorModel.pick(faint(seed, step=0.0, noise=4.0), 80.0, 60.0)


@pytest.mark.parametrize(("width", "height"), [(120, 120), (160, 80), (90, 140)])
def test_a_card_stays_a_card(width: int, height: int) -> None:
    card = np.zeros((480, 640), bool)
    card[180 : 180 + height, 250 : 250 + width] = True
    image = paint(textured(spread=4.0), card, (40.0, 60.0, 200.0))
    regions, _ = regions_at_click(image, 250.0 + 0.5 * width, 180.0 + 0.5 * height)
    assert overlap(regions[0], card) > 0.85


def everywhere() -> Picture:
    """A ball on a plain gray board; beyond the board all has the color of the ball."""
    image = paint(textured(spread=4.0), ~disc((480, 640), radius=150.0), (40.0, 150.0, 60.0))
    return paint(image, disc((480, 640), radius=30.0), (40.0, 150.0, 60.0))


def test_a_color_that_is_everywhere_but_beside_the_target_is_noted_and_tracked() -> None:
    image = everywhere()
    color = ms.ColorModel.pick(image, X - 4.0, Y)
    assert color.note.endswith("is all over the picture: learned against what is next to it")
    assert not color.gray
    assert color.circle is not None
    tracker = ms.Tracker(ms.Circle, color, start=(X - 4.0, Y))
    for index in range(3):
        track = tracker.update(ms.Frame(image, index / 30.0, index))
        assert isinstance(track, ms.Track)
        assert math.hypot(track.shape.x - X, track.shape.y - Y) < 1.0
        assert abs(track.shape.radius - 30.0) < 1.0


def test_a_click_where_nothing_stands_out_is_refused() -> None:
    image = np.full((240, 320, 3), 128, np.uint8)
    with pytest.raises(ValueError, match=r"pick \(160, 120\)"):
        ms.ColorModel.pick(image, 160.0, 120.0)
    with pytest.raises(ValueError, match=r"pick \(160, 120\)"):
        ms.ColorModel.pick(image[:, :, 0], 160.0, 120.0)


def test_a_copy_keeps_circle_and_note_and_a_file_does_not(tmp_path: Path) -> None:
    color = ms.ColorModel.pick(everywhere(), X, Y)
    copy = color.copy()
    assert copy.circle == color.circle is not None
    assert copy.note == color.note != ""
    color.save(tmp_path / "ball.npz")
    loaded = ms.ColorModel.load(tmp_path / "ball.npz")
    assert color.is_local
    assert copy.is_local
    assert loaded.is_local
    np.testing.assert_array_equal(loaded.table, color.table)
    assert loaded.circle is None
    assert loaded.note == ""


def test_a_small_ball_before_a_plain_wall_is_not_taken_for_the_wall() -> None:
    """The seed of the region is the most uniform place near the click, wherever that is: on the wall."""
    rng = np.random.default_rng(3)
    wall = np.zeros((480, 640), bool)
    wall[200:270, 270:410] = True
    image = paint(textured(spread=30.0), wall, (150.0, 150.0, 150.0))
    ball = disc((480, 640), radius=6.0)
    image[ball] = np.clip(np.array((40.0, 60.0, 170.0)) + rng.normal(0.0, 25.0, (int(ball.sum()), 3)), 0, 255)
    color = ms.ColorModel.pick(image, X - 3.0, Y, ColorParameters(seed_search_px=14.0, seed_distance_cost=0.0))
    alike = color.scores(image) > 0
    assert alike[ball].mean() > 0.6
    assert alike[wall & ~disc((480, 640), radius=8.0)].mean() < 0.05


def test_a_sheet_before_a_wall_is_no_spot_on_a_ball() -> None:
    """Of a piece of the wall the network is just sure enough, but only one circle leads there."""
    clip = CASES["quadrilateral"].clip("typical", 103, 1)
    image, click = next(iter(clip))[0].image, clip.first_click
    circle = ms.ColorModel.pick(image, *click).circle
    assert circle is not None
    assert circle[2] < 60.0
    assert math.hypot(circle[0] - click[0], circle[1] - click[1]) < 20.0
