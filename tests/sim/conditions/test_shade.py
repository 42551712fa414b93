import math

import numpy as np
import pytest

import matchset as ms
from matchset.numeric.record import fields
from matchset.sim.clips.balloon import Balloon
from matchset.sim.conditions.conditions import Conditions
from matchset.sim.conditions.shade import Shade
from matchset.sim.rendering.coverage import SHADING
from matchset.sim.rendering.renderer import Light, ball_shading
from matchset.sim.scene.furniture import FLOOR

BROWN = np.array((90.0, 120.0, 150.0))


def picture(**named: float) -> np.ndarray:
    """What the first camera sees after 0.3 s."""
    world = ms.sim.World(ms.sim.ChainParameters(vehicles=3, conditions=Conditions(**named)), seed=11)
    cameras = ms.sim.WorldCameras(world, ms.CameraModel.from_fov(320, 240, math.radians(90.0)), preset="clean")
    for k in range(1, 10):
        for who in range(2):
            world.send(who, ms.sim.Command(throttle=0.595))
        world.advance(16 * k)
    return cameras.image(0, 140).astype(np.float64)


def test_a_ball_is_darker_in_a_patch_and_on_the_side_away_from_the_lamp() -> None:
    shade = Shade(0.8, BROWN, 3)
    lights = [shade.light_at(np.array((0.0, 0.0, z))) for z in np.linspace(0.0, 4.0, 200)]
    assert (min(lights), max(lights)) == pytest.approx((0.2, 1.0), abs=0.01)
    template = ball_shading(Balloon(), Light(), np.array((0.0, 0.0, 1.0)))
    before = fields(template, SHADING)
    color, ambient = before.color.copy(), float(before.ambient)
    place, turned = np.array((0.3, -0.2, 1.0)), np.array(((0.0, 0.0, -1.0), (0.0, 1.0, 0.0), (1.0, 0.0, 0.0)))
    lit = fields(shade.ball(template, place, turned), SHADING)
    np.testing.assert_allclose(lit.color, color * shade.light_at(place))
    assert lit.ambient == pytest.approx(0.2 * ambient)
    np.testing.assert_allclose(lit.light, turned @ np.array(shade.parameters.lamp) / math.hypot(*shade.parameters.lamp))
    np.testing.assert_array_equal(before.color, color)


def test_a_shadow_falls_on_the_floor_away_from_the_lamp() -> None:
    spot = Shade(0.5, BROWN, 0).below(np.array((1.0, FLOOR - 0.72, 2.0)))
    assert spot == pytest.approx((1.48, FLOOR - 0.005, 2.5))
    assert Shade(0.5, BROWN, 0).below(np.array((1.0, FLOOR + 1.0, 2.0))) == pytest.approx((1.0, FLOOR - 0.005, 2.0))


def test_shadows_are_in_the_picture_and_only_where_they_belong() -> None:
    plain, shaded = picture(), picture(shadow=0.7)
    darker = (plain - shaded).mean(axis=2)
    assert darker[110:].max() > 40.0  # spots on the floor, and the balls
    assert np.abs(darker[:60]).max() == 0.0  # nothing flies there
    assert (darker > 20.0).mean() < 0.1
    assert not np.array_equal(plain, shaded)
    np.testing.assert_array_equal(picture(shadow=0.0), plain)
