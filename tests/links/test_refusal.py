"""The simulated transmitter refuses as the real one does: after its failsafe, until it is armed again."""

import pytest

from matchset.control.command import Command
from matchset.links.simulated import SimulatedChain
from matchset.links.simulation_parameters import SimulationParameters
from matchset.sim.world import RATE

FLIGHT = Command(throttle=0.6)
SMALL = SimulationParameters(vehicles=2, width=160, height=120, pal="clean")


def flying(parameters: SimulationParameters = SMALL) -> SimulatedChain:
    chain = SimulatedChain(parameters)
    chain.links[0].arm()
    assert chain.links[0].send(FLIGHT).throttle > 0.0
    return chain


def wait(chain: SimulatedChain, seconds: float) -> None:
    chain.world.advance(chain.world.step + round(seconds * RATE))


def test_silence_makes_it_hold_then_refuse_until_it_is_armed_again() -> None:
    chain = flying()
    link = chain.links[0]
    wait(chain, 0.15)
    assert (link.status().state, link.status().refusal) == ("holding", "")
    assert link.send(FLIGHT).throttle > 0.0
    assert link.status().state == "armed"
    wait(chain, 0.25)
    assert link.status().state == "failsafe"
    assert "stopped the motors" in link.status().refusal
    assert link.send(FLIGHT) == Command()
    wait(chain, 0.02)
    assert link.send(FLIGHT) == Command()
    link.arm()
    assert link.send(FLIGHT).throttle > 0.0
    chain.close()


def test_the_time_begins_with_the_first_command_after_arming() -> None:
    chain = SimulatedChain(SMALL)
    chain.links[0].arm()
    wait(chain, 1.0)
    assert chain.links[0].send(FLIGHT).throttle > 0.0
    chain.close()


def test_a_transmitter_that_hears_nothing_for_a_while_refuses() -> None:
    chain = flying(SimulationParameters(vehicles=2, width=160, height=120, pal="clean", silent=0.5, silent_for=0.3))
    link = chain.links[0]
    confirmed = []
    for _ in range(30):
        wait(chain, 1 / 30)
        confirmed.append((chain.now(), link.send(FLIGHT).throttle))
    assert all(throttle > 0.0 for time, throttle in confirmed if time < 0.7)
    assert all(throttle == 0.0 for time, throttle in confirmed if time >= 0.8)
    assert link.status().state == "failsafe"
    chain.close()


@pytest.mark.parametrize("armed", [True, False])
def test_a_cut_stops_the_motors_until_it_is_armed_again(armed: bool) -> None:
    chain = flying() if armed else SimulatedChain(SMALL)
    link = chain.links[0]
    link.cut()
    assert link.send(FLIGHT) == Command()
    assert link.status().state == "locked"
    link.arm()
    assert link.send(FLIGHT).throttle > 0.0
    chain.close()
