"""What the vehicles behind links are told, angles or speeds, and a Tello's own video: `for_links`, `start_video`."""

from collections.abc import Sequence
from typing import Literal

import msgspec

from matchset.flight.chain.config import with_world
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.linked.parameters import LinkedFollower
from matchset.links.tello.tello_client import SCHEME, TelloParameters, parse_tello
from matchset.links.tello.tello_link import TelloLink


def told_to(uri: str) -> Literal["angles", "speeds"]:
    """Return what the vehicle behind a link is told.

    Parameters
    ----------
    uri : str
    """
    return "speeds" if uri.startswith(SCHEME) else "angles"


def for_links(parameters: FlightParameters, uris: Sequence[str]) -> FlightParameters:
    """Return the parameters of a flight as its links ask for it.

    Parameters
    ----------
    parameters : FlightParameters
    uris : sequence of str
        Of the links of all followers.

    Raises
    ------
    ValueError
        If links differ in what they tell, or the settings say speeds and a link tells angles.
    """
    kinds = {told_to(uri): uri for uri in uris}
    if len(kinds) > 1:
        raise ValueError(
            f"{kinds['speeds']} is told speeds, {kinds['angles']} angles and thrust: fly them by two programs"
        )
    follower = parameters.pilot.follower
    if "angles" in kinds:
        if "speeds" in (follower.commands, parameters.world.commands):
            raise ValueError(
                f'commands = "speeds": --link {kinds["angles"]} tells angles and thrust; only tello: speeds'
            )
        return parameters
    takeoff = max(follower.speeds.takeoff_duration, TelloParameters().takeoff_time)
    speeds = msgspec.structs.replace(follower.speeds, takeoff_duration=takeoff)
    follower = msgspec.structs.replace(follower, commands="speeds", speeds=speeds)
    pilot = msgspec.structs.replace(parameters.pilot, follower=follower)
    return msgspec.structs.replace(with_world(parameters, commands="speeds"), pilot=pilot)


def start_video(follower: LinkedFollower) -> None:
    """Let a Tello send pictures if they are what its follower sees; they go on when this link is closed again.

    Parameters
    ----------
    follower : LinkedFollower

    Raises
    ------
    ValueError, LinkError
        If its address has another form, or it does not answer.
    """
    if told_to(follower.link) == "speeds" and str(follower.camera).endswith(f":{parse_tello(follower.link).video}"):
        with TelloLink(follower.link) as link:
            link.start_video()
