"""What a person is told before a real flight, and after it: `before`, `taken_off`."""

from collections.abc import Container, Iterator

from matchset.flight.chain.chain_step import FlightSetup
from matchset.flight.linked.followers import LinkedFollowers


def before(setup: FlightSetup, followers: LinkedFollowers, keys: bool) -> Iterator[str]:
    """Say what will be flown with what, what is assumed, and how to stop it; a line each.

    Parameters
    ----------
    setup : FlightSetup
    followers : LinkedFollowers
    keys : bool
        Whether the space key is read.
    """
    for number, (pilot, words) in enumerate(zip(followers.pilots, setup.devices, strict=True), 1):
        model, status = pilot.camera.model, pilot.link.status()
        yield f"vehicle {number}: {words}; {model.width} x {model.height} px; transmitter {status.version}"
        yield from (f"warning: {warning}" for warning in status.warnings)
    yield from (f"note: {note}" for note in followers.notes)
    yield assumed(setup)
    if setup.kind == "dry run":
        yield "DRY RUN: no throttle is sent, nothing is armed. With --arm in its place the motors turn"
        return
    key = "The space key and SIGUSR1 stop" if keys else "SIGUSR1 stops"
    yield (
        f"THE MOTORS TURN in {setup.countdown:g} s, as soon as the ball is in sight. {key} them at once: the vehicle "
        "falls. Ctrl-C lands"
    )


def assumed(setup: FlightSetup) -> str:
    """Say which numbers a flight relies on that nobody can see in a picture."""
    pilot = setup.parameters.pilot
    target, place, follower = pilot.target, pilot.place, setup.parameters.loop.follower
    own, hovers = follower.ego_motion, f"throttle that hovers {follower.hover_throttle:g}"
    speeds = f"it holds speeds, at full stick {own.full_speed:g} m/s, upward {own.full_rise:g} m/s"
    return (
        f"assumed: ball {100.0 * target.diameter:g} cm, marker {100.0 * target.marker_diameter:g} cm; place "
        f"{place.heading:g} m before the marker, {place.side:+g} m to its right, {place.height:+g} m above the ball; "
        f"{speeds if own.speed_commands else hovers}"
    )


def taken_off(count: int, flown: Container[int]) -> str:
    """Say who of so many followers would have taken off."""
    stayed = [str(number + 1) for number in range(count) if number not in flown]
    return f"vehicle {' and '.join(stayed)} would not have taken off" if stayed else "everybody would have taken off"
