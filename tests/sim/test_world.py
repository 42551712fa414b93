import math

import numpy as np
import pytest

from matchset.control.command import Command
from matchset.control.follower import RelativeSetpoint
from matchset.sim.on_board.radio import quantized
from matchset.sim.rope import RopeParameters
from matchset.sim.vehicle import VehiclePose, toy
from matchset.sim.world import CAMERA_AHEAD, RATE, ChainParameters, World, relative_position

CHAIN = ChainParameters(place=RelativeSetpoint(height=-0.19))
HOVER = Command(throttle=0.6)


def flown(world: World, seconds: float, command: Command = HOVER) -> World:
    for _ in range(round(30 * seconds)):
        for who in range(world.parameters.vehicles - 1):
            world.send(who, command)
        world.advance(world.step + RATE // 30)
    return world


def turned(yaw: float) -> np.ndarray:
    return np.array(((math.cos(yaw), 0.0, math.sin(yaw)), (0.0, 1.0, 0.0), (-math.sin(yaw), 0.0, math.cos(yaw))))


def test_the_same_seed_is_the_same_flight_and_another_is_not() -> None:
    one, two, other = (flown(World(CHAIN, seed), 0.5) for seed in (3, 3, 4))
    np.testing.assert_array_equal(one.states, two.states)
    assert not np.allclose(one.states, other.states)


def test_each_begins_at_its_set_place_or_as_far_off_as_asked() -> None:
    world = World(CHAIN, 5)
    for who in range(2):
        np.testing.assert_allclose(world.place(who), (0.0, -0.19, 1.5), atol=0.03)  # the rope hangs askew
    off = World(ChainParameters(place=RelativeSetpoint(height=-0.19), start_off=(0.5, 0.5, 0.5)), 5)
    assert np.abs(np.abs(off.place(1) - (0.0, -0.19, 1.5)) - 0.5).max() < 0.05


def test_a_place_is_side_height_and_heading_in_the_level_frame_of_the_ball() -> None:
    # The neighbor looks along its z; its marker looks back, at who is behind it.
    neighbor = VehiclePose(np.zeros(3), turned(0.3), np.array((0.0, -0.19, 0.0)))
    there = np.array((0.0, -0.19, 0.0)) + turned(0.3) @ np.array((-0.2, -0.1, -1.5 - CAMERA_AHEAD))
    np.testing.assert_allclose(
        relative_position(VehiclePose(there, turned(0.3), there), neighbor), (0.2, 0.1, 1.5), atol=1e-12
    )


def test_who_is_held_waits_for_the_motors() -> None:
    world = flown(World(CHAIN, 0), 1.0, Command())
    np.testing.assert_allclose(world.place(0), (0.0, -0.19, 1.5), atol=0.1)
    assert not world.crashes


def test_without_commands_the_motors_stop_and_it_falls() -> None:
    world = flown(World(CHAIN, 0), 0.5)
    world.advance(world.step + 3 * RATE)
    assert [what for _, _, what in world.crashes] == ["hit the floor"] * 2
    assert {who for _, who, _ in world.crashes} == {0, 1}


def test_a_command_acts_after_the_radio_and_the_battery_sags() -> None:
    chain = ChainParameters(place=RelativeSetpoint(height=-0.19), rope=RopeParameters(swing=0.0, yaw_deg=0.0))
    world = World(chain, 0)
    for _ in range(3):
        world.send(0, HOVER)
        world.advance(world.step + 8)
    before = float(world.states[0, 13])
    world.send(0, Command(throttle=1.0))
    world.advance(world.step + round(toy().radio_delay * RATE) - 1)
    assert float(world.states[0, 13]) < before + 0.05
    fresh = flown(World(chain, 0), 0.4)
    worn = World(chain, 0)
    worn.motion.battery_age[:] = toy().flight_time
    assert float(flown(worn, 0.4).states[0, 13]) == pytest.approx(0.6 * toy().thrust_to_weight * 0.981 * 0.8, rel=1e-2)
    assert float(fresh.states[0, 13]) > float(worn.states[0, 13])


def test_who_flies_into_another_crashes() -> None:
    world = flown(World(CHAIN, 1), 2.0, Command(pitch=0.5, throttle=0.62))
    assert any("hit vehicle" in what for _, _, what in world.crashes)


def test_sticks_have_steps() -> None:
    sent = quantized(Command(0.1234, -0.1234, 1.0, 0.5678), 255.0)
    assert sent.roll * 127.5 == pytest.approx(round(sent.roll * 127.5))
    assert sent.throttle * 255.0 == pytest.approx(round(sent.throttle * 255.0))
    assert sent.yaw <= 1.0
    assert sent.roll == pytest.approx(0.1234, abs=0.5 / 127.5)


@pytest.mark.parametrize(
    ("changes", "words"), [({"vehicles": 1}, "vehicles"), ({"start_off": (3.0, 0, 0)}, "start_off")]
)
def test_a_chain_that_is_none_is_refused(changes: dict[str, object], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        ChainParameters(**changes)  # type: ignore[arg-type]
