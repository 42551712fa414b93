"""Random videos: what is drawn is where the truth says, and what is measured on them."""

from pathlib import Path

import cv2
import numpy as np
import pytest
from benchmarks.random_videos.__main__ import lines, strip, summary
from benchmarks.random_videos.following import PEERS, Task, follow
from benchmarks.random_videos.motion import BallMotionParameters, CameraMotionParameters, ball_way, camera_way
from benchmarks.random_videos.video import VideoParameters, frames
from training.rendering.ball import BallColorParameters, BallParameters, PatternParameters
from training.rendering.light import LightParameters
from training.rendering.photographs import PhotographParameters, Photographs

import matchset as ms
from matchset.app.track.score import TruthRow

SIZE = 320, 240
SHORT = VideoParameters(frames=12, sizes=(SIZE,))
NO_POST = VideoParameters(frames=12, sizes=(SIZE,), posts=0.0)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with two pictures of blots."""
    pytest.importorskip("av")
    place, random = tmp_path_factory.mktemp("photographs"), np.random.default_rng(0)
    for name in "ab":
        blots = cv2.resize(random.integers(0, 256, (30, 40, 3), np.uint8), (1200, 900), interpolation=cv2.INTER_CUBIC)
        cv2.imwrite(str(place / f"{name}.png"), blots)
    return place


@pytest.fixture(scope="module")
def photographs(folder: Path) -> Photographs:
    return Photographs.read([folder], PhotographParameters(variety=(0.0,)))


def video(seed: int, photographs: Photographs, limits: VideoParameters) -> list[tuple[ms.Frame, TruthRow]]:
    return list(frames(seed, photographs, limits))


def test_the_same_seed_gives_the_same_bytes(photographs: Photographs) -> None:
    one, other = (video(3, photographs, SHORT) for _ in range(2))
    assert [truth for _, truth in one] == [truth for _, truth in other]
    for (frame, _), (again, _) in zip(one, other, strict=True):
        np.testing.assert_array_equal(frame.image, again.image)


@pytest.mark.parametrize("seed", range(2))
def test_rows_belong_to_their_frames(photographs: Photographs, seed: int) -> None:
    seen = video(seed, photographs, SHORT)
    assert [frame.index for frame, _ in seen] == [truth.frame for _, truth in seen] == list(range(SHORT.frames))
    assert {frame.image.shape for frame, _ in seen} == {(SIZE[1], SIZE[0], 3)}


@pytest.mark.parametrize("seed", range(2))
def test_the_ball_is_where_its_truth_says(folder: Path, seed: int) -> None:
    """Nobody who follows a vivid ball in clean pictures is told by the renderer where it is but in the first one."""
    clean = VideoParameters(
        frames=8,
        sizes=(SIZE,),
        camera=CameraMotionParameters(kinds=(1.0, 0.0)),
        motion=BallMotionParameters(kinds=(1.0, 0.0), radius=(16.0, 0.1), roam=0.05),
        ball=BallParameters(BallColorParameters((0.0, 1.0)), PatternParameters((0.0, 0.0, 0.0, 0.0))),
        light=LightParameters(ambient=(1.0, 1.0), shades=0.0, rims=0.0, highlights=0.0, grounds=0.0),
        posts=0.0,
        exposures=(0.0,),
        soft=0.0,
        noise=(0.0, 0.0),
        denoised=0.0,
        sharpened=0.0,
        steps=0.0,
        bits=(4.0, 4.1),
    )
    score = follow(Task(seed, folder, clean))["matchset"]
    assert score.valid == score.tight > 0
    assert score.mean_error_px is not None
    assert score.mean_error_px < 0.7


def test_a_ball_begins_whole_in_the_picture_and_its_radius_is_positive() -> None:
    for seed in range(200):
        way = ball_way(np.random.default_rng(seed), 90, SIZE, BallMotionParameters())
        margin = way.radius[0]
        assert margin <= way.x[0] <= SIZE[0] - 1 - margin
        assert margin <= way.y[0] <= SIZE[1] - 1 - margin
        assert way.radius.min() > 0.0
        assert np.isfinite(way.x).all()
        assert np.isfinite(way.y).all()


@pytest.mark.parametrize("kinds", [(1.0, 0.0), (0.0, 1.0), (0.0, 0.0)])
def test_a_camera_stays_on_its_photograph(kinds: tuple[float, float]) -> None:
    limits = CameraMotionParameters(kinds=kinds)
    for seed in range(50):
        way = camera_way(np.random.default_rng(seed), 90, SIZE[0], limits)
        assert max(np.abs(way.x).max(), np.abs(way.y).max()) <= limits.farthest * SIZE[0]
        assert way.x[0] == way.y[0] == 0.0
        assert (kinds[0] == 1.0) == (not np.any(way.x))


def test_behind_a_post_a_ball_is_absent(photographs: Photographs) -> None:
    limits = VideoParameters(
        frames=90,
        sizes=(SIZE,),
        camera=CameraMotionParameters(kinds=(1.0, 0.0)),
        motion=BallMotionParameters(kinds=(0.0, 1.0), radius=(5.0, 0.05)),
        posts=1.0,
        post_at=(0.5, 0.5),
        post_width=(0.3, 0.3),
    )
    seen = video(2, photographs, limits)
    behind = [truth for _, truth in seen if truth.circle is None]
    partly = [truth for _, truth in seen if truth.circle is not None and truth.lowconf]
    assert len(behind) > 5
    assert partly
    assert seen[0][1].tight


def test_everybody_follows_and_is_scored(folder: Path) -> None:
    task = Task(0, folder, NO_POST)
    scores = follow(task)
    assert tuple(scores) == PEERS
    assert {each.visible + each.absent for each in scores.values()} == {NO_POST.frames - 1}
    assert "matchset" in summary([scores])
    assert "seed" in lines([task], [scores], held=101.0)
    assert "| 0 |" in lines([task], [scores], held=101.0)


def test_a_sheet_shows_some_frames(folder: Path) -> None:
    assert strip(Task(0, folder, NO_POST)).shape == (240, 4 * 320, 3)
