"""The public door to the world, `ms.sim`: what a program of one's own types, and what it gets wrong."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import matchset as ms

CAMERA = ms.CameraModel.from_fov(160, 120, 1.5)
make: Any = ms.sim  # so that a type checker lets wrong types pass


@pytest.fixture(scope="module")
def world() -> ms.sim.World:
    return ms.sim.World(ms.sim.ChainParameters(vehicles=2), seed=3)


def test_a_world_needs_no_parameters() -> None:
    assert len(ms.sim.World().poses(0)) == 3


def test_its_pictures_are_those_of_the_seed_and_each_is_an_array_of_its_own() -> None:
    pictures = []
    for seed in (3, 3, 4):
        world = ms.sim.World(ms.sim.ChainParameters(vehicles=2), seed)
        world.advance(20)
        cameras = ms.sim.WorldCameras(world, CAMERA)
        pictures.append(cameras.image(0, 16))
        again = cameras.image(0, 16)
        assert not np.shares_memory(again, pictures[-1])
    assert pictures[0].shape == (120, 160, 3)
    assert pictures[0].dtype == np.uint8
    np.testing.assert_array_equal(pictures[0], pictures[1])
    assert (pictures[0] != pictures[2]).any()


def test_who_is_let_go_falls_and_who_is_held_does_not() -> None:
    world = ms.sim.World(seed=1)
    world.let_go(0)
    world.advance(ms.sim.RATE // 4)
    fallen, held = (world.poses(world.step)[who].position[1] - world.poses(0)[who].position[1] for who in (0, 1))
    assert 0.1 < fallen < 0.5 * 9.81 * 0.25**2  # its rotors run down
    assert held == 0.0


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (lambda _: make.World(3), "parameters must be a ChainParameters, got 3"),
        (lambda _: make.World(seed=-1), "seed must be a whole number, 0 or more, got -1"),
        (lambda _: make.World(seed=1.5), "seed must be .* got 1.5"),
        (lambda world: world.send(1, ms.sim.Command()), r"the followers of this chain are 0 \.\.\. 0, got 1"),
        (lambda world: world.send(-1, ms.sim.Command()), "got -1"),
        (lambda world: world.let_go(1), "got 1"),
        (lambda world: world.place(7), "got 7"),
        (lambda world: world.poses(10_000), "step 10000 is not among the last 480"),
        (
            lambda world: make.WorldCameras(world, CAMERA, "good"),
            "preset must be one of clean, typical, bad, got 'good'",
        ),
        (lambda world: ms.sim.WorldCameras(world, CAMERA).image(0, world.step), "is not among the last"),
    ],
)
def test_misuse_shows_the_value(world: ms.sim.World, wrong: Callable[[Any], object], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        wrong(world)
