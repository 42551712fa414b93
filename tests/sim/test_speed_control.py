"""Simulated vehicles that are told speeds: they hold them, also in wind, begin in a hand and land by themselves."""

import math

import msgspec
import numpy as np
import numpy.typing as npt
import pytest

from matchset.control.command import HOLD, Command
from matchset.control.ego_motion import EgoMotion
from matchset.control.sticks.ego_parameters import EgoMotionParameters, SpeedCommand
from matchset.numeric.record import fields
from matchset.sim.conditions.conditions import Conditions
from matchset.sim.on_board.speed_control import SpeedControlParameters
from matchset.sim.quadrotor import STATE
from matchset.sim.vehicle import VehicleParameters, toy
from matchset.sim.world import RATE, ChainParameters, World

TOLD = SpeedControlParameters(used=True)
Floats = npt.NDArray[np.float64]


def world(bias_deg: float = 0.0, **conditions: float) -> World:
    still = {"level_bias_deg": bias_deg, "level_wander_deg": 0.0}
    vehicle: VehicleParameters = msgspec.structs.replace(toy(), **still)
    return World(
        ChainParameters(vehicles=2, vehicle=vehicle, speed_control=TOLD, conditions=Conditions(**conditions)), 3
    )


def flown(chain: World, command: Command, seconds: float) -> Floats:
    """Velocity in the room after a command has been sent for some time."""
    for _ in range(round(30 * seconds)):
        chain.send(0, command)
        chain.advance(chain.step + RATE // 30)
    return np.array(fields(chain.states[0], STATE).velocity)


@pytest.mark.parametrize(
    ("command", "velocity"),
    [
        (Command(throttle=HOLD), (0.0, 0.0, 0.0)),
        (Command(roll=0.4, throttle=HOLD), (0.4, 0.0, 0.0)),
        (Command(pitch=-0.4, throttle=HOLD), (0.0, 0.0, -0.4)),
        (Command(throttle=0.6), (0.0, -0.2, 0.0)),
        (Command(throttle=0.4), (0.0, 0.2, 0.0)),
    ],
)
@pytest.mark.parametrize("wind", [0.0, 0.8])
def test_it_flies_as_fast_as_it_is_told(command: Command, velocity: tuple[float, ...], wind: float) -> None:
    chain = world(2.0, wind_m_s=wind)
    yaw = chain.rope.yaw(0.0)
    right, down, ahead = velocity
    turned = (right * math.cos(yaw) + ahead * math.sin(yaw), down, ahead * math.cos(yaw) - right * math.sin(yaw))
    found = flown(chain, Command(throttle=HOLD), 2.5)
    assert found == pytest.approx([0.0, 0.0, 0.0], abs=0.03)
    found = flown(chain, command, 1.5)
    assert found == pytest.approx(turned, abs=0.07)
    assert not chain.crashes


def test_it_begins_in_a_hand_which_lets_go_at_half_of_the_throttle() -> None:
    chain = world()
    before = chain.states[0].copy()
    flown(chain, Command(roll=1.0, throttle=0.4), 0.5)
    assert (chain.states[0][:3] == before[:3]).all()
    assert chain.motion.held[0] == 1
    flown(chain, Command(throttle=HOLD), 0.1)
    assert chain.motion.held[0] == 0


@pytest.mark.parametrize("silent", [True, False])
def test_without_throttle_or_commands_it_sinks_level(silent: bool) -> None:
    chain = world()
    flown(chain, Command(pitch=0.3, throttle=HOLD), 1.0)
    if silent:
        chain.advance(chain.step + round(1.5 * RATE))
        velocity = np.array(fields(chain.states[0], STATE).velocity)
    else:
        velocity = flown(chain, Command(), 1.2)
    assert velocity == pytest.approx([0.0, TOLD.landing_speed, 0.0], abs=0.06)


def test_dead_reckoning_knows_it() -> None:
    chain, model = world(), EgoMotionParameters(speed_commands=True)
    own, rng = EgoMotion(model), np.random.default_rng(1)
    yaw, told = chain.rope.yaw(0.0), Command(throttle=HOLD)
    worst = 0.0
    for k in range(240):
        if k % 12 == 0 and k > 10:
            roll, pitch, rise = rng.uniform(-0.5, 0.5, 3)
            told = Command(roll, pitch, 0.0, HOLD + 0.3 * rise)
        told = chain.send(0, told)
        up = (told.throttle - HOLD) / HOLD
        own.update(SpeedCommand(told.roll, told.pitch, 0.0, up), k / 30.0)
        chain.advance(chain.step + RATE // 30)
        velocity = own.at((k + 1) / 30.0).velocity
        x, y, z = np.array(fields(chain.states[0], STATE).velocity).tolist()
        level = (x * math.cos(yaw) - z * math.sin(yaw), y, x * math.sin(yaw) + z * math.cos(yaw))
        worst = max(worst, float(np.abs(velocity - level).max()))
    assert worst < 0.06


def test_what_is_out_of_range_is_refused() -> None:
    with pytest.raises(ValueError, match="speed_time"):
        SpeedControlParameters(speed_time=0.0)
    with pytest.raises(ValueError, match="landing_speed"):
        SpeedControlParameters(landing_speed=-1.0)
