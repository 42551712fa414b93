import math
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt
import pytest

from matchset.sim.clips.balloon import Balloon
from matchset.sim.clips.clip import Clip
from matchset.sim.clips.hand import hand_at
from matchset.sim.clips.truth import SphereOutline
from matchset.sim.digital_camera.control_steps import ControlSteps
from matchset.sim.digital_camera.digital_camera import DigitalCamera
from matchset.sim.rendering.renderer import Light

Array = npt.NDArray[np.float64]
SMALL = {"width": 160, "height": 120, "radii": (8.0, 30.0), "preset": None}
WHITE = (225.0, 228.0, 230.0)
KNOBS: dict[str, dict[str, Any]] = {
    "exposure": {"digital": DigitalCamera(steps=ControlSteps(brightness=2.0, tint=0.1, every=0.1))},
    "noise": {"digital": DigitalCamera(noise=8.0)},
    "denoising": {"digital": DigitalCamera(noise=8.0, denoising=0.8, trail=0.5)},
    "sharpening": {"digital": DigitalCamera(sharpening=2.0)},
    "defocus": {"digital": DigitalCamera(defocus=2.0)},
    "saturation": {"digital": DigitalCamera(saturation=0.2)},
    "highlight": {"light": Light(highlight=800.0)},
    "shadow": {"light": Light(shadow=0.8)},
    "soccer": {"balloon": Balloon(color=WHITE, pattern="soccer")},
    "logo": {"balloon": Balloon(pattern="logo", pattern_color=WHITE)},
    "grass": {"backdrop": "grass"},
}


def small(**changes: object) -> Clip:
    return Clip(**(SMALL | changes))  # type: ignore[arg-type]


def covered(clip: Clip, index: int) -> Array:
    """Coverage of each pixel by what moves, from the same frame over black and over white."""
    shape = (clip.height, clip.width, 3)
    black, white = (clip.render(index, np.full(shape, v, np.float32)).image.astype(float) for v in (0.0, 255.0))
    found: Array = 1.0 - (white - black)[..., 0] / 255.0
    return found


@pytest.mark.parametrize("name", KNOBS)
def test_a_knob_changes_pictures_but_no_truth_and_follows_from_the_seed(name: str) -> None:
    changes = KNOBS[name]
    plain, first, again = (list(small(frames=6, seed=5, **c)) for c in ({}, changes, changes))
    for (_, truth), (frame, told), (same, _) in zip(plain, first, again, strict=True):
        assert told == truth
        np.testing.assert_array_equal(frame.image, same.image)
    assert any((a.image != b.image).any() for (a, _), (b, _) in zip(plain, first, strict=True))
    if "digital" in changes:
        other = small(frames=6, seed=6, **changes)
        assert (next(iter(other))[0].image != first[0][0].image).any()


@pytest.mark.parametrize(
    "changes",
    [
        {"digital": DigitalCamera(), "light": Light(), "hand": 0.0, "backdrop": "room", "blur_samples": 16},
        {"digital": DigitalCamera(halo=4.0)},
        {"balloon": Balloon(pattern="plain", pattern_color=WHITE, spin=1.0)},
    ],
)
def test_knobs_at_zero_give_the_same_bytes(changes: dict[str, object]) -> None:
    for preset in ("typical", "clean"):
        pairs = zip(small(frames=2, preset=preset), small(frames=2, preset=preset, **changes), strict=True)
        for (frame, truth), (other, told) in pairs:
            np.testing.assert_array_equal(frame.image, other.image)
            assert truth == told


def test_a_rolling_shutter_shears_the_ball_by_its_speed_times_the_time_of_a_row() -> None:
    clip = Clip(frames=60, seed=3, preset=None, radii=(40.0, 40.0), speed=2.0, digital=DigitalCamera(readout=1.0))
    path = clip._path
    index = max(range(1, 59), key=lambda k: abs(path.apparent(k + 0.5)[0] - path.apparent(k - 0.5)[0]))
    truth = clip.truth(index)
    assert truth.circle is not None
    y = np.arange(clip.height)
    rows = np.abs(y - truth.circle.y) < 30.0
    slopes, at_center = [], []
    for one in (clip, msgspec.structs.replace(clip, digital=DigitalCamera())):  # the other: an ellipse may lean
        share = covered(one, index)
        middles = (share @ np.arange(clip.width))[rows] / share.sum(axis=1)[rows]
        slopes.append(np.polyfit(y[rows], middles, 1)[0])
        at_center.append(np.interp(truth.circle.y, y[rows], middles))
    speed = path.apparent(index + 0.5)[0] - path.apparent(index - 0.5)[0]
    assert abs(speed) > 10.0
    assert slopes[0] - slopes[1] == pytest.approx(speed / clip.height, rel=0.15)
    assert at_center[0] == pytest.approx(truth.circle.x, abs=0.3)


def test_truth_under_a_rolling_shutter_is_that_of_the_row_of_the_center() -> None:
    rolling, still = (small(frames=40, seed=3, digital=DigitalCamera(readout=r)) for r in (0.8, 0.0))
    for index in (3, 17, 33):
        truth = rolling.truth(index)
        assert truth.outline is not None
        late = 0.8 * ((truth.outline.y + 0.5) / rolling.height - 0.5)
        outline = still._outline(index + late)
        assert truth.outline.x == pytest.approx(outline.x, abs=1e-3)
        assert truth.outline.y == pytest.approx(outline.y, abs=1e-3)
        assert truth.position == pytest.approx(tuple(still._path.position(index + late)), abs=1e-4)


def test_a_ball_that_rests_is_the_same_under_a_rolling_shutter() -> None:
    rest = {"radii": (20.0, 20.0), "speed": 0.0, "occluder": 0.2}
    rolling, still = (small(frames=1, digital=DigitalCamera(readout=r), **rest) for r in (0.9, 0.0))
    room = still.background()
    difference = rolling.render(0, room).image.astype(int) - still.render(0, room).image
    assert np.abs(difference).max() <= 1


@pytest.mark.parametrize("share", [0.1, 0.2, 0.3, 0.4])
def test_a_hand_hides_its_share_of_the_rim(share: float) -> None:
    outline = SphereOutline(x=300.0, y=200.0, a=60.0, b=60.0, angle=0.0, projected_x=300.0, projected_y=200.0)
    rim = outline.points(3600)
    hidden = np.zeros(3600, bool)
    for finger in hand_at(outline, share, 3.0, 1).fingers:
        hidden |= finger.covers(*rim.T)
    assert hidden.mean() == pytest.approx(share, abs=0.03)


def test_the_hand_moves_with_the_ball_and_is_left_out_of_the_share() -> None:
    clip, bare = (Clip(frames=30, seed=4, preset=None, hand=h) for h in (0.3, 0.0))
    for index in (0, 20):
        share, truth = clip.truth(index).share, clip.truth(index)
        assert 0.6 < share < 0.95
        assert truth.circle == bare.truth(index).circle
        assert truth.circle is not None
        circle = truth.circle
        room = clip.background()
        changed = (clip.render(index, room).image != bare.render(index, room).image).any(axis=2)
        y, x = np.nonzero(changed)
        inside = np.hypot(x - circle.x, y - circle.y) < 0.99 * circle.radius
        assert inside.sum() / (math.pi * circle.radius**2) == pytest.approx(1.0 - share, abs=0.03)


def test_the_shadow_is_below_and_the_outline_stays() -> None:
    lit, dark = (Clip(frames=1, seed=4, preset=None, light=Light(shadow=s)) for s in (0.0, 0.9))
    circle = lit.truth(0).circle
    assert circle is not None
    room = lit.background()
    before, after = (clip.render(0, room).image.astype(float).sum(axis=2) for clip in (lit, dark))
    x, y, r = round(circle.x), round(circle.y), circle.radius
    low, high = y + round(0.75 * r), y - round(0.6 * r)
    assert after[low, x] < 0.35 * before[low, x]
    assert after[high, x] == pytest.approx(before[high, x], abs=3.0)
    np.testing.assert_allclose(covered(dark, 0), covered(lit, 0), atol=0.01)


def test_a_pattern_has_its_two_colors_and_turns() -> None:
    balloon = Balloon(color=WHITE, pattern="soccer", spin=0.1)
    clip = Clip(frames=9, seed=4, preset=None, speed=0.0, radii=(60.0, 60.0), balloon=balloon)
    circle = clip.truth(0).circle
    assert circle is not None
    room = clip.background()
    y, x = np.mgrid[: clip.height, : clip.width]
    inside = np.hypot(x - circle.x, y - circle.y) < 0.8 * circle.radius
    images = [clip.render(index, room).image for index in (0, 8)]
    black = [(image.max(axis=2) < 60)[inside].mean() for image in images]
    assert all(0.1 < share < 0.5 for share in black)
    assert (images[0] != images[1]).any(axis=2)[inside].mean() > 0.3
    np.testing.assert_allclose(
        covered(clip, 0), covered(Clip(frames=9, seed=4, preset=None, speed=0.0, radii=(60.0, 60.0)), 0), atol=0.01
    )


def test_blur_longer_than_the_ball_is_smooth_with_more_samples() -> None:
    path = {"radii": (6.0, 6.0), "speed": 8.0, "exposure": 1.0, "preset": None, "seed": 3, "frames": 40}
    few, many = (Clip(**path, blur_samples=n) for n in (16, 200))  # type: ignore[arg-type]
    index = max(range(40), key=lambda k: abs(few._path.apparent(k + 0.5)[0] - few._path.apparent(k - 0.5)[0]))
    share = covered(many, index)
    columns = np.nonzero(share.sum(axis=0) > 0.05)[0]
    assert np.ptp(columns) > 3 * 12
    assert share.max() < 0.5
    roughness = [float(np.abs(np.diff(covered(clip, index), 2, axis=1)).mean()) for clip in (few, many)]
    assert roughness[1] < roughness[0]


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"hand": 0.5}, "0.5"),
        ({"backdrop": "beach"}, "beach"),
        ({"blur_samples": 0}, "got 0"),
    ],
)
def test_misuse_of_degradations(changes: dict[str, object], text: str) -> None:
    with pytest.raises(ValueError, match=text):
        Clip(**changes)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="checkers"):
        Balloon(pattern="checkers")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="shadow"):
        Light(shadow=1.5)
