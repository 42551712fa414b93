"""What flies under a page: the simulated chain, and vehicles by their links."""

import itertools

import pytest

from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.chain.pilot import Pilot
from matchset.flight.linked.followers import LinkedFollowers
from matchset.links.connect import connect
from matchset.links.simulation_parameters import SimulationParameters
from matchset.live.piloting.fleet import FleetStep
from matchset.live.piloting.linked_fleet import LinkedFleet
from matchset.live.piloting.simulated_fleet import SimulatedFleet
from matchset.live.piloting.state import map_state
from matchset.localization.markers.ball_colors import learn_colors

URI = "sim://chain?vehicles=2&seed=5"


def chain(vehicles: int = 2) -> SimulatedFleet:
    """Make a chain that waits for no clock."""
    return SimulatedFleet(
        FlightParameters(world=SimulationParameters(vehicles=vehicles, seed=5, width=320, height=240)), real_time=False
    )


def phases(step: FleetStep) -> list[str]:
    return [each.safety.phase for each in step.steps]


def test_nobody_flies_who_was_not_armed_and_a_long_wait_does_no_harm() -> None:
    with chain() as fleet:
        for _ in range(200):
            step = fleet.step()
            assert step.steps[0].command.throttle == 0.0
        fleet.arm(fleet.pilots)
        for _ in range(100):
            step = fleet.step()
        assert phases(step) == ["flying"]
        assert not step.crashes


def test_a_landing_descends_for_two_seconds_and_stops_the_motors() -> None:
    with chain() as fleet:
        fleet.arm(fleet.pilots)
        for _ in range(60):
            fleet.step()
        fleet.pilots[0].land("enough")
        steps = [fleet.step() for _ in range(70)]
        throttles = [step.steps[0].command.throttle for step in steps]
        assert all(after <= before for before, after in itertools.pairwise(throttles))
        assert phases(steps[0]) == ["descending"]
        assert phases(steps[-1]) == ["cut"]
        assert steps[-1].steps[0].safety.reason == "enough"


def test_a_cut_stops_the_motors_within_a_tenth_of_a_second() -> None:
    with chain(3) as fleet:
        fleet.arm(fleet.pilots)
        for _ in range(60):
            step = fleet.step()
        assert all(each.command.throttle > 0.2 for each in step.steps)
        ordered = step.time
        fleet.cut("by hand")
        step = fleet.step()
        assert all(each.command.throttle == 0.0 for each in step.steps)
        assert step.time - ordered + SimulationParameters().vehicle.radio_delay < 0.1


def test_a_fleet_of_links_is_flown_by_their_contracts_alone() -> None:
    link = connect(URI)
    camera = link.chain.cameras[0]  # type: ignore[attr-defined]
    colors = learn_colors(camera.sample())
    with LinkedFleet(LinkedFollowers([Pilot(camera, link, colors)])) as fleet:
        fleet.arm(fleet.pilots)
        for _ in range(60):
            step = fleet.step()
        assert phases(step) == ["flying"]
        place = fleet.pilots[0].parameters.place
        shown = map_state(step, place)
        assert len(shown.vehicles) == 1
        assert shown.cameras[0] == pytest.approx((0.0, -place.heading), abs=0.4)
        fleet.cut("by hand")
        assert phases(fleet.step()) == ["cut"]
    link.chain.close()  # type: ignore[attr-defined]


def test_the_map_shows_the_chain_from_above() -> None:
    with chain(3) as fleet:
        for _ in range(3):
            step = fleet.step()
        place = fleet.pilots[0].parameters.place
        shown = map_state(step, place)
        ahead = [vehicle.at[1] for vehicle in shown.vehicles]
        assert ahead == sorted(ahead)
        for vehicle, camera, wanted in zip(shown.vehicles[:-1], shown.cameras, shown.places, strict=True):
            assert vehicle.nose == pytest.approx((0.0, 1.0), abs=0.5)
            assert camera == pytest.approx(wanted, abs=0.5)
