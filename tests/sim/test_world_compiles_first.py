"""A world and its cameras compile in their constructors: no picture waits for a compiler."""

import pytest
from numba.core import event

from balls import BARREL, PINHOLE
from matchset.camera.camera_model import CameraModel
from matchset.control.command import Command
from matchset.sim.cameras import WorldCameras
from matchset.sim.world import RATE, ChainParameters, World


@pytest.mark.parametrize(("camera", "preset"), [(PINHOLE, "clean"), (BARREL, "typical")])
def test_nothing_compiles_in_a_flight(camera: CameraModel, preset: str) -> None:
    world = World(ChainParameters(), 3)
    cameras = WorldCameras(world, camera, preset)
    cameras.hide_balls(0.5, 1.0)
    with event.install_recorder("numba:compile") as recorder:
        cameras.held_ball(0)
        for _ in range(75):
            for who in range(2):
                world.send(who, Command(throttle=0.58))
            world.advance(world.step + RATE // 30)
        cameras.image(0, world.step - 4)
        cameras.shows_ball(1, world.step)
        world.place(0)
    assert recorder.buffer == []
