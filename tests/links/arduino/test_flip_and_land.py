"""The flip switch stays off whatever is commanded, and every landing is a ramp."""

import itertools

import numpy as np
import pytest
from fakes import FakePort

from matchset.control.command import Command
from matchset.links import crsf_frame as crsf
from matchset.links.arduino import channels
from matchset.links.arduino.arduino_link import ArduinoLink
from matchset.links.simulated import SimulatedChain
from matchset.links.simulation_parameters import FPS, SimulationParameters

FLIP = 6  # which channel, from 0


def test_no_command_flips() -> None:
    sticks = (-1.0, -0.5, 0.0, 1e-3, 1.0)
    for roll, pitch, yaw in itertools.product(sticks, repeat=3):
        for throttle, armed, high_rate in itertools.product((0.0, 0.5, 1.0), (False, True), (False, True)):
            values = channels.channels(Command(roll, pitch, yaw, throttle), armed, high_rate)
            assert values[FLIP] == crsf.CHANNEL_LOW
            assert values[4] == (crsf.CHANNEL_HIGH if armed else crsf.CHANNEL_LOW)


@pytest.mark.parametrize("throttle", [0.3, 0.6, 1.0])
def test_a_landing_is_a_ramp(throttle: float) -> None:
    port = FakePort()
    port.clock.sleep(0.2)
    link = ArduinoLink("serial:///fake", port, clock=port.clock, sleep=port.clock.sleep)
    link.arm()
    for _ in range(15):
        link.send(Command(0.5, -0.5, 0.5, throttle))
        port.clock.sleep(1 / 30)
    before, begin = len(port.heard), port.clock()
    link.land(1.5)
    heard = port.heard[before:]
    assert 1.4 < port.clock() - begin < 1.8
    ramp = np.array([values[2] for values in heard if values[4] == crsf.CHANNEL_HIGH]) - crsf.CHANNEL_LOW
    full = throttle * (crsf.CHANNEL_HIGH - crsf.CHANNEL_LOW)
    even = full * link.parameters.frame_period / 1.5
    falls = -np.diff([full, *ramp])
    assert falls.min() >= -1.0
    assert falls.max() <= 2.0 * even + 2.0
    assert ramp[-1] <= 2.0 * even + 2.0
    assert {tuple(values[k] for k in (0, 1, 3)) for values in heard} == {(crsf.CHANNEL_CENTER,) * 3}
    assert {values[FLIP] for values in port.heard} == {crsf.CHANNEL_LOW}
    assert (port.state, port.throttle) == ("locked", 0)


def test_a_simulated_landing_is_a_ramp_too() -> None:
    chain = SimulatedChain(SimulationParameters(vehicles=2, width=160, height=120, pal="clean"))
    link = chain.links[0]
    link.arm()
    link.send(Command(0.5, -0.5, 0.5, 0.6))
    begin = chain.world.step
    link.land(1.5)
    throttles = []
    for step in range(round(1.6 * FPS)):
        chain.world.advance(begin + 16 * (step + 3))
        throttles.append(chain.world._active[0].throttle)
    falls = -np.diff([0.6, *throttles])
    assert falls.min() >= 0.0
    assert falls.max() <= 3.0 * 0.6 / (1.5 * FPS) + 1 / 255
    assert chain.world._active[0] == Command()
    chain.close()
