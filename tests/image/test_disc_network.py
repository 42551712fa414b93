"""The network of discs: its patch and its layers beside slow twins, where it leads, and what it says of noise."""

import math

import cv2
import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from matchset.image.disc_network.click_discs import BallAtClickParameters, discs_at
from matchset.image.disc_network.look import MOVES
from matchset.image.disc_network.network import DiscNetwork, NetworkFollowParameters
from matchset.image.disc_network.patch_format import NUMBERS, PLACES, RADII, RAYS
from matchset.image.disc_network.polar_patch import colors_of, read_patch

Picture = npt.NDArray[np.uint8]
Floats = npt.NDArray[np.float64]
Circle3 = tuple[float, float, float]
BALL = (150.0, 110.0, 30.0)
FOLLOW = NetworkFollowParameters()


def picture(ball: Circle3 = BALL, color: tuple[float, float, float] = (60.0, 150.0, 70.0), seed: int = 0) -> Picture:
    """A shaded ball before a wall with a little noise, BGR."""
    rows, columns = np.indices((240, 320), np.float64)
    away = np.hypot(columns - ball[0], rows - ball[1])
    share = np.clip(ball[2] - away + 0.5, 0.0, 1.0)[..., np.newaxis]
    shade = (1.0 - 0.3 * np.clip((rows - ball[1]) / ball[2], -1.0, 1.0))[..., np.newaxis]
    wall = np.full((240, 320, 3), (150.0, 155.0, 165.0)) + 0.1 * columns[..., np.newaxis]
    noise = np.random.default_rng(seed).normal(0.0, 3.0, wall.shape)
    return np.asarray(np.clip(wall * (1.0 - share) + np.array(color) * shade * share + noise, 0, 255), np.uint8)


def error(found: Circle3 | None, ball: Circle3 = BALL) -> float:
    return math.inf if found is None else float(np.abs(np.subtract(found, ball)).sum())


def test_a_patch_holds_the_colors_along_the_rays() -> None:
    image = cv2.GaussianBlur(picture(), (0, 0), 2.0).astype(np.uint8)
    patch = read_patch(image, (150.0, 110.0, 16.0))
    assert patch is not None
    assert patch.shape == (RAYS, PLACES, NUMBERS)
    assert patch.dtype == np.float32
    lab = cv2.cvtColor(image.astype(np.float32) / np.float32(255.0), cv2.COLOR_BGR2Lab)
    colors = np.empty((RAYS, PLACES, 3))
    for ray in range(RAYS):
        for place in range(PLACES):
            angle, away = 2.0 * math.pi * ray / RAYS, 16.0 * float(RADII[place])
            column, row = 150.0 + away * math.cos(angle), 110.0 + away * math.sin(angle)
            left, top = math.floor(column), math.floor(row)
            across, down = column - left, row - top
            upper = (1.0 - across) * lab[top, left] + across * lab[top, left + 1]
            lower = (1.0 - across) * lab[top + 1, left] + across * lab[top + 1, left + 1]
            colors[ray, place] = 0.02 * ((1.0 - down) * upper + down * lower)
    apart = colors - np.median(colors[:, RADII < 0.7].reshape(-1, 3), axis=0)
    expected = 0.7 * apart / max(math.sqrt(float((apart**2).mean())), 0.08)
    assert np.abs(patch[..., :3] - expected).max() < 0.05
    assert patch[..., 4].all()


def test_log_odds_are_high_inside_and_low_around() -> None:
    patch = read_patch(picture(), BALL)
    assert patch is not None
    assert patch[:, RADII < 0.8, 3].mean() > 0.7
    assert patch[:, RADII > 1.2, 3].mean() < -0.7
    assert np.abs(patch[..., 3]).max() <= 1.0


def known_in(image: Picture, known: npt.NDArray[np.float32] | None) -> Floats:
    """Log-odds of the colors known at the places around the ball's circle."""
    patch = read_patch(image, BALL, known)
    assert patch is not None
    return np.asarray(patch[..., 5], np.float64)


def test_colors_known_from_another_picture_tell_inside_from_around() -> None:
    other = (90.0, 70.0, 45.0)
    known = known_in(picture(), colors_of(picture(other, seed=1), other))
    assert known[:, RADII < 0.8].mean() > 0.6
    assert known[:, RADII > 1.2].mean() < -0.6
    assert np.abs(known).max() <= 1.0
    assert not known_in(picture(), None).any()


def test_a_ball_of_another_color_is_told_by_the_colors_known() -> None:
    known = colors_of(picture(color=(60.0, 60.0, 190.0)), BALL)
    assert known_in(picture(), known).mean() < -0.2


@pytest.mark.parametrize("gain", [0.85, 1.15])
def test_a_little_more_or_less_light_leaves_the_colors_known(gain: float) -> None:
    relit = np.asarray(np.clip(picture() * gain, 0, 255), np.uint8)
    known = known_in(picture(), colors_of(relit, BALL))
    assert known[:, RADII < 0.8].mean() > 0.3


def test_colors_are_shares_and_there_are_none_far_outside() -> None:
    colors = colors_of(picture(), BALL)
    assert colors is not None
    assert colors.min() >= 0.0
    assert colors.sum() == pytest.approx(1.0, abs=1e-4)
    assert colors_of(picture(), (-400.0, 110.0, 30.0)) is None
    assert colors_of(picture(), (-27.0, 110.0, 30.0)) is None
    border = colors_of(picture(), (-15.0, 110.0, 30.0))
    assert border is not None
    assert border.sum() == pytest.approx(1.0, abs=1e-4)


def test_places_outside_of_the_picture_are_said_and_a_circle_far_outside_has_no_patch() -> None:
    patch = read_patch(picture(), (0.0, 110.0, 30.0))
    assert patch is not None
    assert patch[0, :, 4].all()
    assert not patch[RAYS // 2, :, 4].any()
    assert np.isfinite(patch).all()
    assert read_patch(picture(), (-400.0, 110.0, 30.0)) is None
    assert DiscNetwork.packaged().follow(picture(), (-400.0, 110.0, 30.0), FOLLOW) is None
    assert DiscNetwork.packaged().follow(picture(), (150.0, 110.0, 1.0), FOLLOW) is None


def weights_of(seed: int, width: int = 6) -> dict[str, npt.NDArray[np.float32]]:
    rng = np.random.default_rng(seed)
    shapes = {"first": (PLACES * NUMBERS, width), "out": (width, 2), "cls": (2 * width, 1)}
    shapes |= dict.fromkeys("abcd", (5 * width, width))
    weights = {f"{name}.w": rng.normal(0.0, 0.2, shape).astype(np.float32) for name, shape in shapes.items()}
    return weights | {f"{name}.b": rng.normal(0.0, 0.1, shape[1]).astype(np.float32) for name, shape in shapes.items()}


def test_the_layers_are_circular_convolutions_and_the_step_is_a_least_squares_fit() -> None:
    weights, patch = (
        weights_of(1),
        np.random.default_rng(2).normal(0.0, 1.0, (RAYS, PLACES, NUMBERS)).astype(np.float32),
    )
    rays = np.maximum(patch.reshape(RAYS, -1) @ weights["first.w"] + weights["first.b"], 0.0)
    for name, step in (("a", 1), ("b", 2), ("c", 4), ("d", 8)):
        kernel, made = weights[f"{name}.w"].reshape(5, 6, 6), np.empty_like(rays)
        for ray in range(RAYS):
            made[ray] = weights[f"{name}.b"]
            for k in range(5):
                made[ray] += rays[(ray + (k - 2) * step) % RAYS] @ kernel[k]
        rays = rays + np.maximum(made, 0.0)
    out = (rays @ weights["out.w"] + weights["out.b"]).astype(np.float64)
    root = np.exp(0.5 * np.clip(out[:, 1], -6.0, 8.0))[:, np.newaxis]
    system = np.vstack((root * MOVES, math.sqrt(30.0) * np.eye(3)))
    expected = np.linalg.lstsq(system, np.concatenate((root[:, 0] * out[:, 0], np.zeros(3))), rcond=None)[0]
    seen = DiscNetwork(weights).see(patch)
    assert seen.step == pytest.approx(expected, abs=1e-4)
    assert seen.precision == pytest.approx(system.T @ system, rel=1e-4)
    pooled = np.concatenate((rays.mean(axis=0), rays.max(axis=0)))
    assert seen.log_odds == pytest.approx(float((pooled @ weights["cls.w"] + weights["cls.b"])[0]), abs=1e-4)


@settings(max_examples=20)
@given(turn=st.integers(0, RAYS - 1), seed=st.integers(0, 1000))
def test_a_turned_patch_has_a_turned_step(turn: int, seed: int) -> None:
    network = DiscNetwork.packaged()
    patch = np.random.default_rng(seed).normal(0.0, 0.5, (RAYS, PLACES, NUMBERS)).astype(np.float32)
    one, other, angle = network.see(patch), network.see(np.roll(patch, turn, axis=0)), 2.0 * math.pi * turn / RAYS
    cosine, sine = math.cos(angle), math.sin(angle)
    expected = cosine * one.step[0] - sine * one.step[1], sine * one.step[0] + cosine * one.step[1], one.step[2]
    assert other.step == pytest.approx(expected, abs=1e-3)
    assert other.log_odds == pytest.approx(one.log_odds, abs=1e-3)


@pytest.mark.parametrize("radius", [7.0, 14.0, 30.0, 60.0])
@pytest.mark.parametrize("off", [(0.3, 0.0, 0.0), (0.0, -0.3, 0.2), (0.2, 0.2, -0.25)])
def test_it_leads_to_a_ball(radius: float, off: Circle3) -> None:
    ball = (150.0, 110.0, radius)
    start = (150.0 + off[0] * radius, 110.0 + off[1] * radius, radius * (1.0 + off[2]))
    found = DiscNetwork.packaged().follow(picture(ball), start, FOLLOW)
    assert found is not None
    assert error(found.circle, ball) < 0.08 * radius + 0.5
    assert found.log_odds > 2.0
    assert np.all(np.linalg.eigvalsh(found.precision) > 0.0)


def test_what_hides_a_third_of_a_ball_does_not_move_it() -> None:
    image = picture()
    cv2.line(image, (165, 20), (170, 220), (110, 140, 200), 22, cv2.LINE_AA)
    found = DiscNetwork.packaged().follow(image, (145.0, 113.0, 27.0), FOLLOW)
    assert found is not None
    assert error(found.circle) < 4.0


def test_the_middle_of_a_streak_is_found_with_the_radius_of_the_ball() -> None:
    exposures = [picture((130.0 + 2.0 * k, 110.0, 20.0), seed=k) for k in range(21)]
    streak = np.asarray(np.mean(exposures, axis=0), np.uint8)
    found = DiscNetwork.packaged().follow(streak, (142.0, 111.0, 21.0), FOLLOW)
    assert found is not None
    assert error(found.circle, (150.0, 110.0, 20.0)) < 5.0


@pytest.mark.parametrize("click", [(150.0, 110.0), (135.0, 110.0), (160.0, 125.0)])
def test_the_ball_around_a_click_is_found(click: tuple[float, float]) -> None:
    found = discs_at(picture(), *click, [], BallAtClickParameters())
    assert error(max(found, key=lambda each: each.merit).circle) < 3.0


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("deviation", [3.0, 12.0])
def test_noise_holds_no_ball(seed: int, deviation: float) -> None:
    noise = np.random.default_rng(seed).normal(128.0, deviation, (240, 320, 3))
    limits = BallAtClickParameters()
    found = discs_at(np.asarray(np.clip(noise, 0, 255), np.uint8), 160.0, 120.0, [], limits)
    assert max((each.merit for each in found), default=0.0) < limits.grown


def test_a_gray_picture_is_read_as_one_without_color() -> None:
    gray = picture()[..., 2]
    known = colors_of(gray, BALL)
    patch = read_patch(gray, (152.0, 108.0, 27.0), known)
    assert patch is not None
    for image in (gray[..., np.newaxis], np.repeat(gray[..., np.newaxis], 3, axis=2)):
        same = read_patch(image, (152.0, 108.0, 27.0), colors_of(image, BALL))
        assert same is not None
        assert np.array_equal(same, patch)
    found = discs_at(gray, 135.0, 110.0, [], BallAtClickParameters())
    assert error(max(found, key=lambda each: each.merit).circle) < 3.0


def test_without_the_network_nothing_is_said() -> None:
    assert discs_at(picture(), 150.0, 110.0, [], BallAtClickParameters(used=False)) == []
