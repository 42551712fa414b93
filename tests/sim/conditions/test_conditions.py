"""What is told and what is: each of the conditions changes the simulated side, by default none does."""

import math
from typing import Any

import msgspec
import numpy as np
import pytest

from matchset.camera.camera_model import CameraModel
from matchset.control.command import Command
from matchset.control.follower import RelativeSetpoint
from matchset.numeric.record import fields
from matchset.sim.conditions.conditions import Conditions, quantities
from matchset.sim.quadrotor import STATE
from matchset.sim.rope import RopeParameters
from matchset.sim.vehicle import toy
from matchset.sim.world import RATE, ChainParameters, World
from matchset.sim.world_views import WorldViews

CAMERA = CameraModel.from_fov(640, 480, math.radians(90.0))
PLACE = RelativeSetpoint(height=-0.19)
HOVER = Command(throttle=0.6)
NOMINAL = [
    0.5221375452349999,
    -0.27706158432182804,
    -0.4420460031988321,
    0.049644928603849434,
    -0.619730770134444,
    -0.7979570083266498,
    0.9537657204957829,
    0.03965789665289352,
    0.2978874092223694,
    -0.0046144411376885614,
    0.02293855355756872,
    0.598203045585378,
    -0.07495448478388668,
    1.0472933080892166,
    0.0017972700242632853,
    5.250979799889393e-16,
    0.0017261380747142401,
]


def flown(seconds: float = 1.0, command: Command = HOVER, seed: int = 3, **named: Any) -> World:
    world = World(ChainParameters(vehicles=2, place=PLACE, conditions=Conditions(**named)), seed)
    for _ in range(round(30 * seconds)):
        world.send(0, command)
        world.advance(world.step + RATE // 30)
    return world


def moved(world: World) -> np.ndarray:
    return np.array(fields(world.states[0], STATE).position)


def test_by_default_the_flight_is_the_one_without_conditions() -> None:
    # Written down before there were conditions: all 17 numbers of the follower after 1.5 s of these sticks.
    world = flown(1.5, Command(0.1, -0.2, 0.3, 0.61), seed=5)
    np.testing.assert_allclose(world.states[0], NOMINAL, rtol=0.0, atol=1e-9)


def test_every_name_changes_something_and_says_what_it_is() -> None:
    steady = {"told_latency_ms", "jitter_ms", "frames_lost", "commands_lost", "marker_yaw_deg", "focal_length"}
    steady |= {"camera_pitch_deg", "camera_yaw_deg", "camera_roll_deg", "gust_time_s"}  # cameras, links, or with gusts
    steady |= {"blur_ms", "flicker", "exposure_swing", "shadow"}  # pictures alone
    sticks = Command(0.2, -0.3, 0.5, 0.62)
    nominal = flown(0.7, sticks)
    for each in quantities():
        assert len(each.meaning) > 10
        assert each.low < each.high
        assert each.default is None or each.low <= each.default <= each.high
        if each.name not in steady:
            changed: dict[str, Any] = {each.name: each.low + 0.55 * (each.high - each.low)}
            world = flown(0.7, sticks, **changed)
            assert not np.array_equal(world.states, nominal.states), each.name


@pytest.mark.parametrize("each", quantities(), ids=lambda each: each.name)
def test_what_is_out_of_range_is_refused_with_its_name(each: object) -> None:
    for wrong in (each.low - 1.0, each.high + 1.0, math.nan):  # type: ignore[attr-defined]
        with pytest.raises(ValueError, match=each.name):  # type: ignore[attr-defined]
            Conditions(**{each.name: wrong})  # type: ignore[attr-defined]


def test_a_heavier_vehicle_has_the_motors_it_had() -> None:
    heavy, weak = Conditions(mass=1.2), Conditions(thrust=0.8)
    full = toy().mass * toy().thrust_to_weight
    assert heavy.vehicle(toy()).mass == pytest.approx(1.2 * toy().mass)
    assert heavy.full_thrust(toy()) == pytest.approx(full)
    assert weak.vehicle(toy()).mass == toy().mass
    assert weak.full_thrust(toy()) == pytest.approx(0.8 * full)


def test_thrust_goes_with_a_power_of_the_throttle_and_hovers_where_it_did() -> None:
    hover = toy().hover_throttle
    for throttle in (hover, 0.8):
        linear, square = (
            float(fields(flown(0.6, Command(throttle=throttle), thrust_exponent=p).states[0], STATE).thrust)
            for p in (1.0, 2.0)
        )
        assert square / linear == pytest.approx(throttle / hover, rel=0.01)


def test_the_battery_loses_so_much_a_minute_besides() -> None:
    full, low = (float(fields(flown(3.0, battery_loss_per_min=loss).states[0], STATE).thrust) for loss in (0.0, 1.0))
    assert 1.0 - low / full == pytest.approx(0.05, abs=0.01)  # a twentieth of a minute


def test_a_yaw_trim_turns_a_vehicle_whose_stick_is_in_the_middle() -> None:
    rate = fields(flown(1.0, yaw_trim_deg_s=10.0).states[0], STATE).angular_velocity[1]
    assert math.degrees(rate) == pytest.approx(10.0, abs=0.5)


def test_wind_blows_steadily_from_the_direction_of_the_seed_and_gusts_have_their_deviation() -> None:
    still, windy = flown(1.0), flown(1.0, wind_m_s=1.0)
    wind = np.array(windy.motion.air.steady)
    assert np.linalg.norm(wind) == pytest.approx(1.0)
    assert wind[1] == 0.0
    assert (moved(windy) - moved(still)) @ wind > 0.01
    assert not np.allclose(wind, World(ChainParameters(conditions=Conditions(wind_m_s=1.0)), 4).motion.air.steady)
    world = World(ChainParameters(vehicles=2, place=PLACE, conditions=Conditions(gust_m_s=0.5, gust_time_s=0.1)), 3)
    seen = []
    for _ in range(600):
        world.advance(world.step + 48)
        seen.append(np.array(world.motion.air.gust[0]))
    assert np.std(seen, axis=0) == pytest.approx([0.5, 0.5, 0.5], rel=0.15)
    assert np.corrcoef(np.array(seen)[:-1, 0], np.array(seen)[1:, 0])[0, 1] == pytest.approx(math.exp(-1.0), abs=0.1)


def test_a_camera_looks_where_it_is_mounted() -> None:
    def ahead(**named: float) -> np.ndarray:
        world = World(ChainParameters(vehicles=2, place=PLACE, conditions=Conditions(**named)), 3)
        pose = world.poses(0)[0]
        return pose.rotation.T @ WorldViews(world, CAMERA).viewpoint(pose).from_room.T

    np.testing.assert_allclose(ahead(), np.eye(3), atol=1e-12)
    sine = math.sin(math.radians(10.0))
    assert ahead(camera_pitch_deg=10.0)[:, 2] == pytest.approx((0.0, -sine, math.cos(math.radians(10.0))))  # y is down
    assert ahead(camera_yaw_deg=10.0)[:, 2] == pytest.approx((sine, 0.0, math.cos(math.radians(10.0))))
    assert ahead(camera_roll_deg=10.0)[:, 0] == pytest.approx((math.cos(math.radians(10.0)), sine, 0.0))


def test_a_lens_is_longer_than_told_and_a_marker_sits_to_the_right() -> None:
    world = World(ChainParameters(conditions=Conditions(focal_length=1.1, marker_yaw_deg=10.0)), 3)
    views = WorldViews(world, CAMERA)
    assert [views.model.fx, views.model.cx] == pytest.approx([1.1 * CAMERA.fx, CAMERA.cx])
    marker = -views.marked(np.eye(3))[:, 2]  # seen from behind, x is to the right
    assert marker == pytest.approx((math.sin(math.radians(10.0)), 0.0, -math.cos(math.radians(10.0))))


def test_a_rope_has_its_length_and_must_be_long_enough_for_its_swing() -> None:
    assert Conditions(rope_length_m=0.6).rope(RopeParameters()).length == 0.6
    with pytest.raises(ValueError, match="swing"):
        Conditions(rope_length_m=0.3).rope(RopeParameters(swing=0.5))


def test_conditions_are_read_from_settings() -> None:
    assert msgspec.convert({"thrust": 0.8}, Conditions) == Conditions(thrust=0.8)
    with pytest.raises(msgspec.ValidationError, match="thurst"):
        msgspec.convert({"thurst": 0.8}, Conditions)
