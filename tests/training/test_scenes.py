"""The balls that the network of discs was learned from, and what is read of them."""

from pathlib import Path

import cv2
import msgspec
import numpy as np
import pytest
from training.examples import ExampleParameters, Examples, make_examples, read_examples, write_examples
from training.rendering import photographs as photographs_module
from training.rendering.ball import (
    BallColorParameters,
    BallParameters,
    PatternParameters,
    ball_colors,
    surface_normal,
)
from training.rendering.camera import CameraParameters, VideoParameters, through_video
from training.rendering.covers import CoverParameters, with_covers
from training.rendering.hands import HandParameters, any_hand, with_fingers, with_grip, with_palm
from training.rendering.layers import band, disc, offsets, which, within
from training.rendering.light import LightParameters
from training.rendering.other_shapes import OtherShapeParameters, other_shape
from training.rendering.photographs import (
    REPOSITORY,
    PhotographParameters,
    Photographs,
    fetch,
    find_photographs,
    read_photographs,
)
from training.rendering.scene import BackgroundParameters, Scene, SceneParameters, render

from matchset.image.disc_network.patch_format import DIRECTIONS, RADII

GRAY = 128
EVERYTHING = 1.0  # share
SEEDS = range(8)

PERFECT = CameraParameters(blurs=0.0, gain=0.0, gamma=0.0, exposure=(1.0, 1.0), noise=0.0, sharpened=0.0, coded=0.0)
FLAT = LightParameters(ambient=(1.0, 1.0), shades=0.0, rims=0.0, highlights=0.0, grounds=0.0)
RED = BallParameters(
    color=BallColorParameters(shares=(0.0, 1.0), hues=1, saturation=(255, 255), value=(255, 255)),
    pattern=PatternParameters(shares=(0.0, 0.0, 0.0, 0.0)),
)
PLAIN = SceneParameters(
    radius=(5.0, 40.0),
    hands=0.0,
    moving=0.0,
    shaken=0.0,
    cut=0.0,
    videos=0.0,
    background=BackgroundParameters(blurs=0.0, faded=0.0, shadows=0.0, alike=0.0),
    ball=RED,
    light=FLAT,
    covers=CoverParameters(counts=(1.0, 0.0)),
    camera=PERFECT,
)
"""A red ball before a photograph, with nothing else."""


@pytest.fixture(scope="module")
def photographs(tmp_path_factory: pytest.TempPathFactory) -> Photographs:
    folder = tmp_path_factory.mktemp("photographs")
    random = np.random.default_rng(5)
    for index in range(3):
        coarse = random.integers(0, 256, (30, 40, 3), dtype=np.uint8)
        cv2.imwrite(str(folder / f"{index}.png"), cv2.resize(coarse, (1000, 800), interpolation=cv2.INTER_CUBIC))
    return Photographs.read([folder])


@pytest.fixture(scope="module")
def wall() -> Photographs:
    return Photographs([np.full((800, 1000, 3), GRAY, np.uint8)], PhotographParameters(variety=(0.0,)))


def shares_of_ball(scene: Scene) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    """How much of each pixel a red ball before a gray wall covers."""
    red = scene.image[..., 2].astype(np.float64)
    return np.asarray((red - np.median(red)) / (red.max() - np.median(red)))


@pytest.mark.parametrize("seed", range(16))
def test_a_ball_is_where_the_circle_of_its_scene_is(seed: int, wall: Photographs) -> None:
    scene = render(np.random.default_rng(seed), wall, True, PLAIN)
    shares = shares_of_ball(scene)
    rows, columns = np.mgrid[: shares.shape[0], : shares.shape[1]]
    x, y, radius = scene.circle
    assert np.sum(shares * columns) / shares.sum() == pytest.approx(x, abs=0.05)
    assert np.sum(shares * rows) / shares.sum() == pytest.approx(y, abs=0.05)
    assert np.sqrt(shares.sum() / np.pi) == pytest.approx(radius, abs=0.08)
    assert scene.sweep == (0.0, 0.0)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_moving_ball_is_smeared_evenly_about_its_circle(seed: int, wall: Photographs) -> None:
    moving = msgspec.structs.replace(PLAIN, moving=EVERYTHING, fast=0.0, moving_hidden=0.0)
    scene = render(np.random.default_rng(seed), wall, True, moving)
    shares = shares_of_ball(scene)
    rows, columns = np.mgrid[: shares.shape[0], : shares.shape[1]]
    across = columns - np.sum(shares * columns) / shares.sum()
    down = rows - np.sum(shares * rows) / shares.sum()
    assert np.sum(shares * columns) / shares.sum() == pytest.approx(scene.circle[0], abs=0.3)
    assert np.sum(shares * rows) / shares.sum() == pytest.approx(scene.circle[1], abs=0.3)
    # the variance along each axis is that of the disc, r^2 / 4, and that of the way, a third of half its square
    for offset, half in zip((across, down), scene.sweep, strict=True):
        expected = scene.circle[2] ** 2 / 4.0 + half**2 / 3.0
        assert np.sum(shares * offset**2) / shares.sum() == pytest.approx(expected, rel=0.15)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_border_cuts_the_ball(seed: int, wall: Photographs) -> None:
    cut = msgspec.structs.replace(PLAIN, cut=EVERYTHING, cut_at=(0.2, 0.6))
    scene = render(np.random.default_rng(seed), wall, True, cut)
    whole = disc((scene.image.shape[0], scene.image.shape[1]), scene.circle)
    assert np.abs(shares_of_ball(scene) - whole).max() < 0.3  # the circle moved with the picture
    assert whole.sum() < 0.98 * np.pi * scene.circle[2] ** 2


def test_the_same_seed_gives_the_same_scene(photographs: Photographs) -> None:
    one, same, other = (render(np.random.default_rng(seed), photographs, True) for seed in (3, 3, 4))
    assert np.array_equal(one.image, same.image)
    assert one[1:4] == same[1:4]
    assert np.array_equal(one.earlier, same.earlier)
    assert one.circle != other.circle


@pytest.mark.parametrize("seed", SEEDS)
def test_the_earlier_picture_shows_the_ball_at_rest_with_nothing_in_front(seed: int, wall: Photographs) -> None:
    moving = msgspec.structs.replace(
        PLAIN, hands=EVERYTHING, moving=EVERYTHING, moving_hidden=EVERYTHING, cut=EVERYTHING, videos=0.0
    )
    scene = render(np.random.default_rng(seed), wall, True, moving)
    height, width = scene.earlier.shape[:2]
    inside = disc((height, width), scene.earlier_circle) == 1.0
    middle = scene.earlier[inside].astype(np.int64)
    assert np.ptp(middle, axis=0).max() <= 4  # it is plain, and all of it is seen
    assert middle[:, 2].min() > 200
    assert scene.earlier_circle[2] == scene.circle[2]


@pytest.mark.parametrize("is_ball", [True, False])
def test_scenes_are_pictures_with_their_circle_in_them(is_ball: bool, photographs: Photographs) -> None:
    random = np.random.default_rng(11)
    for _ in range(30):
        scene = render(random, photographs, is_ball)
        assert scene.is_ball is is_ball
        assert scene.image.dtype == np.uint8
        assert scene.image.ndim == 3
        assert scene.image.flags.c_contiguous
        height, width = scene.image.shape[:2]
        x, y, radius = scene.circle
        assert np.isfinite((*scene.circle, *scene.sweep)).all()
        assert 4.0 <= radius <= 60.0
        assert -0.5 <= x <= width
        assert -0.5 <= y <= height


def test_a_hidden_and_blurred_ball_is_still_a_picture(photographs: Photographs) -> None:
    worst = SceneParameters(
        hands=EVERYTHING,
        palms=EVERYTHING,
        moving=EVERYTHING,
        fast=EVERYTHING,
        moving_hidden=EVERYTHING,
        cut=EVERYTHING,
        camera=CameraParameters(blurs=1.0, defocus=1.0, noise=80.0, sharpened=1.0, coded=1.0, rescaled=1.0),
    )
    for seed in SEEDS:
        scene = render(np.random.default_rng(seed), photographs, True, worst)
        assert scene.image.dtype == np.uint8
        assert min(scene.image.shape[:2]) > 3
        assert np.hypot(*scene.sweep) >= 0.5 * 1.3 * scene.circle[2] - 1e-9


@pytest.mark.parametrize("mpeg4", [0.0, 1.0])
@pytest.mark.parametrize("radius", [4.3, 21.0])
def test_the_last_picture_of_a_good_video_is_the_picture_and_of_a_bad_one_still_shows_the_ball(
    mpeg4: float, radius: float, wall: Photographs
) -> None:
    pytest.importorskip("av")
    scene = render(np.random.default_rng(7), wall, True, msgspec.structs.replace(PLAIN, radius=(radius, radius)))
    good = VideoParameters(mpeg4=mpeg4, crf=(1.0, 1.0), quantizer=(1, 1))
    bad = VideoParameters(mpeg4=mpeg4, crf=(40.0, 40.0), quantizer=(28, 28), step=(0.5, 0.5))
    few, many = (through_video(np.random.default_rng(3), scene.image, scene.circle, limits) for limits in (good, bad))
    for coded in (few, many):
        assert coded.shape == scene.image.shape
        assert coded.dtype == np.uint8
    off_few, off_many = (float(np.abs(coded.astype(float) - scene.image).mean()) for coded in (few, many))
    assert off_few < off_many < 40.0
    assert off_few < 10.0  # the colors have half the resolution
    x, y, _ = (round(value) for value in scene.circle)
    blue, _, red = many[y, x].astype(int)
    assert red > blue + 60


def test_earlier_pictures_differ_by_the_way_of_the_ball_and_end_with_the_picture(wall: Photographs) -> None:
    pytest.importorskip("av")
    scene = render(np.random.default_rng(8), wall, True, PLAIN)
    still = VideoParameters(step=(0.0, 0.0), carried=0.0, mpeg4=0.0, crf=(12.0, 12.0))
    moved = msgspec.structs.replace(still, step=(0.7, 0.7))
    pictures = (through_video(np.random.default_rng(3), scene.image, scene.circle, each) for each in (still, moved))
    first, second = pictures
    for coded in (first, second):
        assert np.abs(coded.astype(float) - scene.image).mean() < 10.0
    assert np.any(first != second)


def test_hands_and_covers_change_the_picture_and_keep_it_finite(photographs: Photographs) -> None:
    circle, random = (60.0, 60.0, 20.0), np.random.default_rng(2)
    plain = np.full((120, 120, 3), float(GRAY), np.float32)
    limits = HandParameters()
    for _ in range(10):
        hand = any_hand(random, limits)
        palm = with_palm(random, plain, circle, hand, limits)
        fingers = with_fingers(random, plain, circle, hand, limits)
        covered = with_covers(random, plain, circle, photographs, CoverParameters(counts=(0.0, 0.5)))
        for picture in (palm, fingers, covered):
            assert picture.dtype == np.float32
            assert np.isfinite(picture).all()
        assert not np.array_equal(palm, plain)
        assert not np.array_equal(fingers, plain)
    assert np.array_equal(with_covers(random, plain, circle, photographs, PLAIN.covers), plain)


def test_a_grip_lies_around_the_rim_and_leaves_the_middle_free(wall: Photographs) -> None:
    picture, circle = np.zeros((120, 120, 3), np.float32), (60.0, 60.0, 24.0)
    limits = HandParameters(grip_length=(0.1, 0.3), grip_arc=(3.0, 3.0))
    random = np.random.default_rng(4)
    hand = any_hand(random, limits)
    drawn = with_grip(random, picture, circle, hand, (limits.grip_before, limits)).max(axis=2) > 0
    rows, columns = np.indices(drawn.shape)
    away = np.hypot(columns - 60.0, rows - 60.0) / 24.0
    assert not drawn[away < 0.6].any()
    assert 0.1 < drawn[(away > 0.95) & (away < 1.05)].mean() < 0.9
    assert not drawn[away > 2.1].any()


def test_a_shaken_scene_is_smeared_as_a_whole_about_its_circle(wall: Photographs) -> None:
    limits = msgspec.structs.replace(PLAIN, radius=(20.0, 20.0), shaken=1.0, shake=(0.8, 0.8))
    sharp = render(np.random.default_rng(6), wall, True, msgspec.structs.replace(limits, shaken=0.0))
    shaken = render(np.random.default_rng(6), wall, True, limits)
    assert shaken.circle == sharp.circle
    assert np.hypot(*shaken.sweep) == pytest.approx(0.4 * 20.0)
    redness = [scene.image[..., 2].astype(float) - scene.image[..., 0] for scene in (sharp, shaken)]
    rows, columns = np.indices(redness[0].shape)
    for axis in (rows, columns):
        before, after = (
            float((each.clip(60.0) - 60.0).ravel() @ axis.ravel() / (each.clip(60.0) - 60.0).sum()) for each in redness
        )
        assert after == pytest.approx(before, abs=0.5)
    assert np.abs(redness[0] - redness[1]).max() > 30.0


def test_other_shapes_are_no_discs() -> None:
    random, circle = np.random.default_rng(4), (50.0, 50.0, 20.0)
    round_one = disc((100, 100), circle)
    # without regular hexagons, whose area is close to a disc's
    limits = OtherShapeParameters(shares=(0.0, 0.3, 0.2, 0.2, 0.1), corners=(3, 4))
    for _ in range(40):
        mask = other_shape(random, (100, 100), circle, limits)
        assert mask.dtype == np.float32
        assert 0.0 <= mask.min() <= mask.max() <= 1.0
        assert np.minimum(mask, round_one).sum() < 0.97 * np.maximum(mask, round_one).sum()
    nothing = msgspec.structs.replace(limits, shares=(1.0, 0.0, 0.0, 0.0, 0.0))
    assert not other_shape(random, (100, 100), circle, nothing).any()


def test_a_ring_has_a_hole() -> None:
    circle = (50.0, 50.0, 20.0)
    rings = OtherShapeParameters(shares=(0.0, 0.0, 0.0, 0.0, 1.0), ring_hole=(0.5, 0.5))
    mask = other_shape(np.random.default_rng(3), (100, 100), circle, rings)
    assert mask[50, 50] == mask[50, 57] == mask[50, 73] == 0.0
    assert mask[50, 65] == mask[35, 50] == 1.0


def test_a_ball_has_spots_and_is_still_round() -> None:
    random, radius = np.random.default_rng(6), 20.0
    place = offsets((60, 60), (30.0, 30.0, radius))
    spotted = msgspec.structs.replace(
        RED, pattern=PatternParameters(shares=(0.0, 0.0, 0.0, 1.0), spots=(1, 1), spot_faces=1.0, spot_turned=0.0)
    )
    for _ in range(8):
        around = np.full((60, 60, 3), GRAY, np.float32)
        colors = ball_colors(random, around, (30.0, 30.0, radius), surface_normal(place), spotted)
        differs = np.abs(colors - colors[30, 2]).sum(axis=2) > 1.0
        assert differs[30, 30] or not differs.any()  # a spot in the middle, unless it has the ball's color
        assert not differs[np.hypot(*place) > np.sin(spotted.pattern.spot_size[1]) + 0.1].any()


def test_a_band_is_between_its_lines() -> None:
    mask = band((11, 31), (5.0, 5.0, 4.0), 0.0, (3.0, 10.0))
    assert mask[0].nonzero()[0].tolist() == list(range(8, 16))
    assert mask.sum() == pytest.approx(11 * 7.0)


def test_kinds_are_drawn_by_their_shares() -> None:
    random = np.random.default_rng(1)
    counts = np.bincount([which(random, (0.2, 0.5)) for _ in range(4000)], minlength=3)
    assert counts / 4000.0 == pytest.approx(np.array([0.2, 0.5, 0.3]), abs=0.03)
    assert all(2.0 <= within(random, (2.0, 3.0)) < 3.0 for _ in range(50))


@pytest.fixture(scope="module")
def examples(photographs: Photographs) -> Examples:
    return make_examples(7, 12, photographs)


def test_examples_have_the_shape_that_the_network_reads(examples: Examples) -> None:
    patches, targets = examples
    assert patches.dtype == np.float16
    assert patches.shape[1:] == (64, 32, 6)
    assert targets.dtype == np.float32
    assert targets.shape == (len(patches), 4)
    assert 60 <= len(patches) <= 72
    assert np.isfinite(patches.astype(np.float32)).all()
    assert np.abs(patches[..., 3]).max() <= 1.0
    assert set(np.unique(patches[..., 4])) <= {0.0, 1.0}


def test_targets_lead_to_the_ball_or_say_that_there_is_none(examples: Examples) -> None:
    there = examples.targets[:, 3]
    assert set(there) == {0.0, 1.0}
    assert np.mean(there) == pytest.approx(4 / 6, abs=0.05)
    steps = examples.targets[there == 1.0, :3]
    limits = ExampleParameters()
    assert np.abs(steps[:, 2]).max() <= limits.radius_share * limits.farthest / (1.0 - limits.farthest)
    assert 0.02 < np.abs(steps).mean() < 0.3
    assert np.abs(steps[:, :2]).max() < 3.0


def test_the_colors_of_a_ball_are_known_and_told_from_around_it(examples: Examples) -> None:
    """Log-odds of the colors known are higher inside the ball than around it, in the mean of all circles near it."""
    inside, around = list[float](), list[float]()
    for patch, (right, down, larger, there) in zip(examples.patches, examples.targets, strict=True):
        if not there:
            continue
        away = np.hypot(np.outer(DIRECTIONS[:, 0], RADII) - right, np.outer(DIRECTIONS[:, 1], RADII) - down)
        share = away / (1.0 + larger)
        inside.append(float(patch[share < 0.8, 5].mean()))
        around.append(float(patch[(share > 1.25) & (patch[..., 4] > 0), 5].mean()))
    assert np.mean(inside) > np.nanmean(around) + 0.4


def test_the_same_seed_gives_the_same_examples(photographs: Photographs, examples: Examples) -> None:
    again = make_examples(7, 2, photographs)
    assert np.array_equal(again.patches, examples.patches[: len(again.patches)])
    assert np.array_equal(again.targets, examples.targets[: len(again.targets)])


def test_examples_are_read_as_they_were_written(tmp_path: Path, examples: Examples) -> None:
    write_examples(tmp_path / "a.npz", examples)
    read = read_examples([tmp_path / "a.npz", tmp_path / "a.npz"])
    assert np.array_equal(read.patches, np.concatenate([examples.patches] * 2))
    assert np.array_equal(read.targets, np.concatenate([examples.targets] * 2))


def test_of_examples_of_fewer_numbers_the_last_ones_are_none(tmp_path: Path, examples: Examples) -> None:
    write_examples(tmp_path / "five.npz", Examples(examples.patches[..., :5], examples.targets))
    read = read_examples([tmp_path / "five.npz"])
    assert np.array_equal(read.patches[..., :5], examples.patches[..., :5])
    assert not read.patches[..., 5].any()


def test_drawings_are_left_out_and_large_photographs_reduced(tmp_path: Path) -> None:
    (tmp_path / "below").mkdir()
    picture = np.random.default_rng(0).integers(0, 256, (300, 1300, 3), dtype=np.uint8)
    for name in ("taken.png", "below/also.jpg", "truchet-l.png", "Stripes.png"):
        cv2.imwrite(str(tmp_path / name), picture)
    (tmp_path / "usr/wallpapers/Next").mkdir(parents=True)
    cv2.imwrite(str(tmp_path / "usr/wallpapers/Next/drawn.png"), picture)
    (tmp_path / "words.txt").write_text("no picture")
    (tmp_path / "broken.png").write_text("no picture")
    assert [path.name for path in find_photographs([tmp_path])] == ["also.jpg", "broken.png", "taken.png"]
    assert len(Photographs.read([tmp_path])) == 2


def test_no_pictures_are_an_error(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="no pictures in"):
        Photographs.read([tmp_path])
    with pytest.raises(ValueError, match="no pictures"):
        Photographs([])


def test_photographs_are_fetched_where_there_are_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def put(folder: Path) -> list[str]:
        folder.mkdir(exist_ok=True)
        cv2.imwrite(str(folder / "one.png"), np.full((60, 80, 3), GRAY, np.uint8))
        return ["one that is gone"]

    monkeypatch.setattr(photographs_module, "fetch", put)
    assert len(read_photographs([tmp_path / "new"])) == 1
    monkeypatch.setattr(photographs_module, "fetch", lambda _: pytest.fail("there are some"))
    assert len(read_photographs([tmp_path / "new"])) == 1


def test_photographs_are_not_fetched_into_the_repository() -> None:
    with pytest.raises(ValueError, match="do not belong"):
        fetch(REPOSITORY / "benchmarks" / "photographs")


def test_a_crop_has_its_size_and_a_small_photograph_gives_gray(photographs: Photographs) -> None:
    random = np.random.default_rng(3)
    for size in ((20, 30), (90, 60)):
        crop = photographs.crop(random, size)
        assert crop.shape == (*size, 3)
        assert crop.dtype == np.float32
        assert 0.0 <= crop.min() <= crop.max() <= 255.0
    small = Photographs([np.zeros((8, 8, 3), np.uint8)])
    assert np.ptp(small.crop(random, (60, 60))) == 0.0
