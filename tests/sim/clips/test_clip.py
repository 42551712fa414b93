import cv2
import numpy as np
import pytest

from matchset.sim.analog_link import AnalogLink
from matchset.sim.clips.clip import Clip, ClipTruth
from matchset.sim.clips.truth import mean_circle, sphere_outline

SMALL = {"width": 160, "height": 120, "radii": (8.0, 30.0)}


def small(**changes: object) -> Clip:
    return Clip(**(SMALL | changes))  # type: ignore[arg-type]


def test_a_clip_is_frames_and_their_truth() -> None:
    clip = small(frames=3)
    pairs = list(clip)
    assert len(pairs) == len(clip) == 3
    for index, (frame, truth) in enumerate(pairs):
        assert frame.image.shape == (120, 160, 3)
        assert frame.image.dtype == np.uint8
        assert (frame.index, truth.index) == (index, index)
        assert frame.time == pytest.approx(index / 30.0)
        assert truth == clip.truth(index)


def test_the_same_clip_gives_the_same_bytes() -> None:
    first, again = (list(Clip.hard(frames=2, seed=4, **SMALL)) for _ in range(2))
    for (a, s), (b, t) in zip(first, again, strict=True):
        np.testing.assert_array_equal(a.image, b.image)
        assert s == t
    other = next(iter(Clip.hard(frames=2, seed=5, **SMALL)))[0]
    assert (other.image != first[0][0].image).any()


def test_the_ball_is_where_the_truth_says() -> None:
    clip = Clip(frames=200, preset=None, seed=3)
    background = clip.background()
    for index in (0, 60, 199):
        circle = clip.truth(index).circle
        assert circle is not None
        changed = np.abs(clip.render(index, background).image - np.rint(background)).sum(axis=2) > 2.0
        y, x = np.nonzero(changed)
        assert x.mean() == pytest.approx(circle.x, abs=0.5)
        assert y.mean() == pytest.approx(circle.y, abs=0.5)
        assert np.sqrt(changed.sum() / np.pi) == pytest.approx(circle.radius, abs=0.7)


def test_the_path_is_smooth_covers_the_radii_and_keeps_the_disc_in_the_picture() -> None:
    clip = Clip(frames=1000, preset=None, seed=1)
    rows = [clip.truth(i) for i in range(len(clip))]
    assert all(t.share == 1.0 for t in rows)
    circles = np.array([[t.circle.x, t.circle.y, t.circle.radius] for t in rows if t.circle])
    steps = np.abs(np.diff(circles, axis=0)).max(axis=0)
    assert 7.0 < steps[0] < 12.0
    assert 7.0 < steps[1] < 12.0
    assert 1.4 < steps[2] < 2.2
    assert 19.0 < circles[:, 2].min() < 25.0
    assert 115.0 < circles[:, 2].max() < 124.0


def test_a_fixed_radius_stays_nearly_fixed() -> None:
    clip = Clip(frames=200, preset=None, radii=(40.0, 40.0))
    radii = [t.circle.radius for t in map(clip.truth, range(200)) if t.circle]
    assert 39.5 < min(radii) <= max(radii) < 46.0


def test_fields_are_taken_at_their_own_times() -> None:
    pal = AnalogLink(interlaced=True)
    clip = Clip(frames=60, preset=pal, seed=3, radii=(40.0, 40.0), speed=2.0)
    still = Clip(frames=60, preset=None, seed=3, radii=(40.0, 40.0), speed=2.0)
    background = clip.background()
    image = clip.render(20, background).image.astype(float)
    moved = np.abs(image - background).sum(axis=2) > 30.0
    centers = [np.nonzero(moved[start::2])[1].mean() for start in (0, 1)]
    path = still._path
    outlines = [sphere_outline(clip.camera, path.position(20 + dt), 0.14) for dt in (-0.25, 0.25)]
    assert abs(outlines[1].x - outlines[0].x) > 2.0
    assert centers == pytest.approx([o.x for o in outlines], abs=0.5)
    assert clip.truth(20).circle == mean_circle([o.circle() for o in outlines])


def test_truth_is_at_the_middle_of_the_exposure() -> None:
    sharp, blurred = (
        Clip(frames=60, preset=None, seed=3, radii=(40.0, 40.0), speed=2.0, exposure=e) for e in (0.0, 1.0)
    )
    background = sharp.background()
    assert sharp.truth(20).circle == blurred.truth(20).circle
    circle = sharp.truth(20).circle
    assert circle is not None
    black, white = (blurred.render(20, np.full_like(background, v)).image.astype(float) for v in (0.0, 255.0))
    covered = 1.0 - (white - black)[..., 0] / 255.0
    y, x = np.mgrid[: sharp.height, : sharp.width]
    assert (covered * x).sum() / covered.sum() == pytest.approx(circle.x, abs=0.15)
    assert (covered * y).sum() / covered.sum() == pytest.approx(circle.y, abs=0.15)
    assert ((covered > 0.02) & (covered < 0.98)).sum() > 1000


def test_absent_hidden_and_away_frames_say_so() -> None:
    empty = small(frames=2, ball=False)
    assert empty.truth(1) == ClipTruth(index=1, circle=None, visible=False, share=0.0, outline=None, position=None)
    hidden = small(frames=9, hidden=((3, 6),), exposure=0.5, preset=None)
    assert [hidden.truth(i).visible for i in range(9)] == [True] * 3 + [False] * 3 + [True] * 3
    background = hidden.background()
    blue, green, red = np.moveaxis(hidden.render(4, background).image.astype(int), 2, 0)
    assert (blue - np.maximum(green, red)).max() < 15
    blue, green, red = np.moveaxis(hidden.render(7, background).image.astype(int), 2, 0)
    assert (blue - np.maximum(green, red)).max() > 90
    away = small(frames=90, away=((40, 50),), preset=None)
    rows = [away.truth(i) for i in range(90)]
    assert not any(t.visible for t in rows[40:50])
    assert all(t.outline is not None for t in rows)
    assert rows[10].share == rows[80].share == 1.0
    shares = [t.share for t in rows[10:45]]
    assert shares == sorted(shares, reverse=True)


def test_the_occluder_hides_its_share() -> None:
    clip = Clip.hard(frames=100)
    shares = [clip.truth(i).share for i in range(0, 100, 7)]
    assert min(shares) > 0.785
    assert max(shares) < 0.815


def test_the_ball_shrinks() -> None:
    clip = Clip(frames=100, shrink_to=4.0, preset=None)
    first, last = clip.truth(0).circle, clip.truth(99).circle
    assert first is not None
    assert last is not None
    assert first.radius > 100.0
    assert last.radius == pytest.approx(4.0, abs=0.5)


@pytest.mark.parametrize("seed", range(12))
def test_the_first_click_hits_the_blue_of_the_ball(seed: int) -> None:
    clip = Clip.hard(frames=1, seed=seed)
    x, y = clip.first_click
    circle = clip.truth(0).circle
    assert circle is not None
    assert (x, y) == pytest.approx((circle.x - circle.radius / 2.0, circle.y))
    image = clip.render(0, clip.background()).image if seed < 3 else None
    if image is not None:
        blue, green, red = image[round(y) - 1 : round(y) + 2, round(x) - 1 : round(x) + 2].mean(axis=(0, 1))
        assert blue > max(green, red) + 40.0
    with pytest.raises(ValueError, match="not seen"):
        _ = Clip(ball=False).first_click


def test_brightness_swings_by_the_stated_factor_and_white_balance_drifts() -> None:
    clip = small(frames=120, ball=False, preset=None, gain_swing=2.0)
    background = np.full((120, 160, 3), 100.0, np.float32)
    levels = [float(clip.render(i, background).image.mean()) for i in range(120)]
    assert max(levels) / min(levels) == pytest.approx(2.0, rel=0.03)
    drift = small(frames=1, ball=False, preset=None, white_balance_drift=0.1).render(67, background).image
    assert drift[0, 0].tolist() == [110, 100, 90]


def test_a_clip_changes_its_room() -> None:
    clip = small(frames=4, ball=False, preset=None, scene_frames=2)
    images = [frame.image for frame, _ in clip]
    np.testing.assert_array_equal(images[0], images[1])
    assert (images[1] != images[2]).mean() > 0.3
    np.testing.assert_array_equal(images[2], images[3])


def test_jpeg_is_the_last_step() -> None:
    raw, packed = (small(frames=1, preset=None, jpeg=q) for q in (None, 40))
    image = raw.render(0, raw.background()).image
    _, data = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, 40])
    np.testing.assert_array_equal(packed.render(0, packed.background()).image, cv2.imdecode(data, cv2.IMREAD_COLOR))


def test_equal_radius_in_a_larger_picture() -> None:
    wide = Clip(width=3840, height=2160, frames=300, radii=(50.0, 50.0), preset=None)
    circle = wide.truth(7).circle
    assert circle is not None
    assert circle.radius == pytest.approx(52.0, abs=3.0)


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"frames": -1}, "-1"),
        ({"preset": "awful"}, "awful"),
        ({"radii": (30.0, 20.0)}, "30"),
        ({"radii": (20.0, 300.0)}, "300"),
        ({"occluder": 0.9}, "0.9"),
        ({"exposure": 1.5}, "1.5"),
        ({"gain_swing": 0.5}, "0.5"),
        ({"jpeg": 0}, "got 0"),
        ({"seed": -3}, "-3"),
        ({"shrink_to": 0.0}, "0.0"),
    ],
)
def test_misuse(changes: dict[str, object], text: str) -> None:
    with pytest.raises(ValueError, match=text):
        Clip(**changes)  # type: ignore[arg-type]
