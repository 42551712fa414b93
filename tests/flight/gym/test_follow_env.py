"""The Gymnasium environment: spaces, determinism, end, reward, and that nothing of the truth is observed."""

import math
import subprocess
import sys
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import matchset as ms

gymnasium = pytest.importorskip("gymnasium")
from gymnasium.utils.env_checker import check_env  # noqa: E402

gymnasium.register_envs(ms.gym)
SMALL: dict[str, Any] = {"width_px": 160, "height_px": 120}
HOVER = np.array((0.0, 0.0, 0.0, 0.58), np.float32)


def made(**words: Any) -> Any:
    return gymnasium.make("matchset/Follow-v0", **words)


@pytest.mark.parametrize("observation", ["picture", "pose"])
def test_the_checker_of_gymnasium_has_nothing_to_say(observation: str) -> None:
    env = made(observation=observation, **SMALL)
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        check_env(env.unwrapped)
    assert [str(each.message) for each in said] == []


def test_spaces_are_what_the_page_says() -> None:
    picture, pose = made(), made(observation="pose")
    assert picture.observation_space == gymnasium.spaces.Box(0, 255, (480, 640, 3), np.uint8)
    assert pose.observation_space.shape == (8,)
    assert picture.action_space.low.tolist() == [-1.0, -1.0, -1.0, 0.0]
    assert picture.action_space.high.tolist() == [1.0] * 4


def test_the_same_seed_is_the_same_flight_and_another_is_not() -> None:
    flights = []
    for seed in (5, 5, 6):
        env = made(**SMALL)
        first, info = env.reset(seed=seed)
        rewards = [env.step(HOVER)[1] for _ in range(5)]
        second, _ = env.reset()
        flights.append((first, rewards, second, info["truth"]["place"]))
    one, same, other = flights
    for a, b in zip(one, same, strict=True):
        np.testing.assert_array_equal(a, b)
    assert (one[0] != other[0]).any()
    assert one[1] != other[1]
    assert (one[0] != one[2]).any(), "the next episode is another one"


def test_a_hand_lets_go_at_the_first_step_whatever_the_sticks_are() -> None:
    """Nobody earns anything by staying in the hand."""
    env = made(**SMALL)
    env.reset(seed=2)
    rewards, terminated, info = [], False, {}
    while not terminated:
        _, reward, terminated, truncated, info = env.step(np.zeros(4, np.float32))
        rewards.append(reward)
        assert not truncated
    assert info["crash"] == "hit the floor"
    assert info["time"] < 3.0
    assert rewards[-1] == pytest.approx(-1800.0 - info["truth"]["error"])
    assert rewards[:-1] == sorted(rewards[:-1], reverse=True), "it falls away from its place"
    with pytest.raises(gymnasium.error.ResetNeeded, match="call reset"):
        env.unwrapped.step(HOVER)


def test_the_reward_is_the_distance_from_the_set_place_and_has_a_bound() -> None:
    env = made(max_error=0.1, start_off=0.3, **SMALL)
    env.reset(seed=1)
    _, reward, _, _, info = env.step(HOVER)
    assert info["truth"]["error"] > 0.4
    assert reward == -0.1
    env = made(**SMALL)
    env.reset(seed=1)
    _, reward, _, _, info = env.step(HOVER)
    assert reward == -info["truth"]["error"]
    assert info["truth"]["error"] == pytest.approx(math.dist(info["truth"]["place"], (0.0, -0.19, 1.5)))


def test_time_truncates() -> None:
    env = made(duration=0.2, **SMALL)
    env.reset(seed=1)
    assert [env.step(HOVER)[2:4] for _ in range(6)] == [(False, False)] * 5 + [(False, True)]


def test_pictures_are_as_old_as_the_latency() -> None:
    env = made(latency_ms=100.0, **SMALL)
    _, info = env.reset(seed=1)
    for _ in range(3):
        assert info["time"] - info["taken"] == pytest.approx(0.1)
        info = env.step(HOVER)[4]


def test_what_is_observed_comes_from_the_picture_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """Gray pictures: the pose is not known, wherever the ball is."""
    monkeypatch.setattr(ms.sim.WorldCameras, "image", lambda *_: np.full((480, 640, 3), 90, np.uint8))
    env = made(observation="pose")
    for observation in (env.reset(seed=4)[0], *(env.step(HOVER)[0] for _ in range(3))):
        assert observation.tolist() == [0.0] * 8
    picture = made()
    assert (picture.reset(seed=4)[0] == 90).all()


def test_the_pose_is_measured_and_not_the_truth() -> None:
    env = made(observation="pose")
    _, before = env.reset(seed=4)
    off = []
    for _ in range(6):
        observation, _, _, _, info = env.step(HOVER)
        assert observation[0] == 1.0
        off.append(float(np.linalg.norm(observation[1:4] - info["truth"]["ball"])))
    assert min(off) > 1e-5, "a measurement is never exact"
    assert max(off) < 0.1
    assert before["crash"] == ""


def test_observations_stay_as_they_were() -> None:
    env = made(**SMALL)
    first, _ = env.reset(seed=1)
    kept = first.copy()
    first[:] = 0
    second = env.step(HOVER)[0]
    assert not np.shares_memory(first, second)
    assert (env.reset(seed=1)[0] == kept).all()


def test_it_renders_rgb_and_leaves_the_observation_alone() -> None:
    env = made(render_mode="rgb_array")
    observation, _ = env.reset(seed=1)
    before = observation.copy()
    picture = env.render()
    assert picture.shape == observation.shape
    np.testing.assert_array_equal(observation, before)
    upper = slice(0, 60)  # neither ring nor caption is there
    np.testing.assert_array_equal(picture[upper], observation[upper, :, ::-1])


def test_several_worlds_side_by_side() -> None:
    envs = gymnasium.make_vec("matchset/Follow-v0", num_envs=2, vectorization_mode="sync", **SMALL)
    pictures, info = envs.reset(seed=3)
    assert pictures.shape == (2, 120, 160, 3)
    assert (pictures[0] != pictures[1]).any()
    _, rewards, terminated, _, info = envs.step(np.stack((HOVER, HOVER)))
    assert rewards.shape == (2,)
    assert not terminated.any()
    assert info["truth"]["place"].shape == (2, 3)
    envs.close()


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (lambda: made(observation="truth"), "observation must be picture or pose, got 'truth'"),
        (lambda: made(duration=0.0), "duration must be within 0.1 ... 3600, got 0.0"),
        (lambda: made(pal="good"), "pal must be one of clean, typical, bad, got 'good'"),
        (lambda: made(width_px=10), "width must be within 64 ... 1920, got 10"),
        (lambda: ms.gym.FollowEnv(widht=3), "no such parameter of FollowParameters.*widht"),
        (lambda: ms.gym.FollowEnv(render_mode="human"), "render_mode must be rgb_array or None, got 'human'"),
        (lambda: made(**SMALL).unwrapped.reset(options={"wind": 3}), "no options of reset, got {'wind': 3}"),
    ],
)
def test_misuse_shows_the_value(wrong: Callable[[], object], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        wrong()


@pytest.mark.parametrize("action", [[0.0] * 3, [0.0, 0.0, 0.0, math.nan], "up"])
def test_an_action_is_four_finite_numbers(action: Any) -> None:
    env = ms.gym.FollowEnv(ms.gym.FollowParameters(**SMALL))
    with pytest.raises(gymnasium.error.ResetNeeded):
        env.step(HOVER)
    env.reset(seed=1)
    with pytest.raises(ValueError, match=r"four finite numbers|could not convert"):
        env.step(action)


def test_actions_out_of_range_are_clipped() -> None:
    heights = []
    for throttle in (1.0, 7.0):
        env = ms.gym.FollowEnv(**SMALL)
        env.reset(seed=1)
        for _ in range(4):
            info = env.step(np.array((0.0, 0.0, 0.0, throttle)))[4]
        heights.append(info["truth"]["position"][1])
    assert heights[0] == heights[1]


def test_without_gymnasium_one_is_told_what_to_install(tmp_path: Path) -> None:
    (tmp_path / "gymnasium.py").write_text("raise ModuleNotFoundError('gymnasium')")
    program = "import sys; sys.path.insert(0, sys.argv[1]); import matchset as ms; ms.sim; ms.gym"
    done = subprocess.run([sys.executable, "-c", program, str(tmp_path)], capture_output=True, text=True, check=False)
    assert "pip install 'gymnasium>=1.0'" in done.stderr.splitlines()[-1]


def test_gymnasium_finds_it_by_its_module() -> None:
    program = "import gymnasium; print(gymnasium.make('matchset.flight.gym:matchset/Follow-v0').unwrapped.spec.id)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout == "matchset/Follow-v0\n"
