"""Crowds with physics: the truth agrees with the picture, and a seed makes one crowd."""

import math
from pathlib import Path

import numpy as np
import pytest
from benchmarks.crowds.cases import Case
from benchmarks.crowds.physics import clip
from benchmarks.crowds.physics.camera import JITTER, Camera, Lamp, View
from benchmarks.crowds.physics.clip import PhysicsCrowd
from benchmarks.crowds.physics.scenes import STAGES
from benchmarks.crowds.physics.surfaces import COLORS, marked
from benchmarks.crowds.physics.world import RATE, World

pytest.importorskip("pybullet", reason="crowds with physics need pybullet: pip install pybullet")


def test_truth_is_where_a_ball_at_rest_is_drawn() -> None:
    random = np.random.default_rng(1)
    with World() as world:
        camera = Camera((1.0, -10.0, 8.0), (0.0, 0.3, 0.6), 640.0)
        for _ in range(6):
            world.ball(float(random.uniform(0.3, 0.6)), marked(random, COLORS["orange"], 1), equal=True, bounce=0.8)
        view = View(world, camera, Lamp((3.0, 2.0, 14.0), 1.0, 0.5, 10.0, (0.0, 0.0, 0.0)), (0.0, 0.0, 1.0))
        for number, ball in enumerate(world.balls):
            world.throw(ball, (1.9 * number - 4.7, float(random.uniform(-2.0, 3.0)), 0.5), (0.0, 0.0, 0.0))
        _, bodies = view.light()
        for ball, seen in zip(
            world.balls, view.truth(bodies, [(each, each.body) for each in world.balls]), strict=True
        ):
            rows, columns = np.nonzero(bodies == ball.body)
            assert math.hypot(columns.mean() - seen.circle.x, rows.mean() - seen.circle.y) < 0.15
            assert abs(math.sqrt(len(rows) / math.pi) - seen.circle.radius) < 0.3
            assert seen.visible > 0.95


@pytest.mark.parametrize("scene", ["box", "juggling"])
def test_truth_is_in_the_middle_of_the_exposure(scene: str) -> None:
    with World() as world:
        stage = STAGES[scene](world, 2, np.random.default_rng(3))
        view = View(world, stage.camera, stage.lamp, stage.normal)
        for step in range(RATE // 2):
            stage.act(step / RATE)
            world.step()
        drawn: dict[int, list[np.ndarray]] = {}
        for part, jitter in enumerate(JITTER):
            for spaced in range(3):
                stage.act((RATE // 2 + 3 * part + spaced) / RATE)
                world.step()
            _, bodies = view.light(jitter)
            seen = view.truth(bodies, [(each, each.body) for each in world.balls if each.equal])
            for each in seen:
                drawn.setdefault(each.identity, []).append(np.argwhere(bodies == each.identity).mean(axis=0))
            if jitter == (0.0, 0.0):
                middle = seen
        whole = [each for each in middle if each.visible > 0.97 and len(drawn[each.identity]) == len(JITTER)]
        assert whole
        for each in whole:
            y, x = np.mean(drawn[each.identity], axis=0)
            assert math.hypot(x - each.circle.x, y - each.circle.y) < 0.4


def test_a_seed_makes_one_crowd_and_a_file_keeps_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(clip, "FOLDER", tmp_path / "one")
    first = list(PhysicsCrowd("juggling", 2, 0.1, 5))
    kept = list(PhysicsCrowd("juggling", 2, 0.1, 5))
    monkeypatch.setattr(clip, "FOLDER", tmp_path / "other")
    again = list(PhysicsCrowd("juggling", 2, 0.1, 5))
    assert list((tmp_path / "one").glob("*.npz"))
    for (one, truth), *others in zip(first, kept, again, strict=True):
        assert one.image.shape == (480, 640, 3)
        for other, same in others:
            assert np.array_equal(one.image, other.image)
            assert truth == same


def test_a_case_knows_the_scenes() -> None:
    crowd = Case("physics_bouncing", 6, 10.0, 500).crowd()
    assert isinstance(crowd, PhysicsCrowd)
    assert crowd.balls == 6
