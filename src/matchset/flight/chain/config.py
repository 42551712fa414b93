"""The parameters of a flight from a TOML file, from a URI and from options; `flight.toml` has the defaults."""

import datetime
import functools
from importlib import resources
from pathlib import Path
from typing import Any

import msgspec

from matchset.app.exit_codes import print_note
from matchset.camera.camera_model import CameraModel
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.linked.parameters import LinkedFollower
from matchset.image.files.limits import LIMITS
from matchset.image.files.reading import read_text
from matchset.links.simulation_parameters import parse_uri
from matchset.sim.conditions.conditions import Conditions
from matchset.sim.toml_settings import read_settings

TEMPLATE = "flight.toml"


class Identified(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A number of a vehicle as `matchset identify` found it, for people and programs: a flight does not read it.

    Parameters
    ----------
    name : str
    value, sigma : float
        In its unit, and its standard deviation.
    unit : str
        Empty for none.
    found : bool
        Whether the flight told it.
    date : date
    """

    name: str
    value: float
    sigma: float
    unit: str
    found: bool
    date: datetime.date


class ConfigFile(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What a TOML file of a flight holds.

    Parameters
    ----------
    flight : FlightParameters
    camera : str
        A camera file for the simulated cameras, as `matchset calibrate` writes it; empty for none. Its path is relative
        to the TOML file.
    follower : tuple of LinkedFollower
        Real followers, in the order of the chain: ``[[follower]]``. Paths are relative to the TOML file.
    identified : tuple of Identified
        Where the numbers of a vehicle come from: ``[[identified]]``.
    """

    flight: FlightParameters = FlightParameters()
    camera: str = ""
    follower: tuple[LinkedFollower, ...] = ()
    identified: tuple[Identified, ...] = ()


def default_toml() -> str:
    """Return `flight.toml`, which comes with the package: every key with its default, its unit and its source."""
    return resources.files("matchset.flight.chain").joinpath(TEMPLATE).read_text(encoding="utf-8")


def read_flight(path: Path) -> FlightParameters:
    """Read the parameters of a flight.

    Parameters
    ----------
    path : Path
        The TOML file; what it leaves out has its default.

    Raises
    ------
    ValueError
        If a key is unknown, of a wrong kind or out of range, or camera and size disagree: with the key and the line.
    """
    text, file = _read(path)
    if not file.camera:
        return file.flight
    camera = CameraModel.load(path.parent / file.camera)
    world = file.flight.world
    if (camera.width, camera.height) != (world.width, world.height):
        line = next((k for k, each in enumerate(text.splitlines(), 1) if each.strip().startswith("camera")), 0)
        raise ValueError(
            f"{path}, line {line}: camera is for {camera.width} x {camera.height} px, but width and height are "
            f"{world.width} x {world.height}"
        )
    return with_world(file.flight, model=camera)


def _read(path: Path) -> tuple[str, ConfigFile]:
    """Read a TOML file; returns its text, too."""
    try:
        text = read_text(path, LIMITS.text)
    except UnicodeDecodeError as error:
        raise ValueError(f"{path}: not a text file: {error}") from None
    return text, read_settings(text, ConfigFile, str(path), _note_once)


@functools.cache
def _note_once(words: str) -> None:
    """Say something of a file on stderr, the first time that it is read."""
    print_note(f"{words}; 'matchset fly --print-config' prints all names")


def read_followers(path: Path) -> tuple[LinkedFollower, ...]:
    """Read the real followers of a TOML file, the paths of their files being made whole.

    Raises
    ------
    ValueError
        As `read_flight`.
    """

    def whole(name: str) -> str:
        return str(path.parent / name) if name else ""

    return tuple(
        msgspec.structs.replace(
            each,
            camera_file=whole(each.camera_file),
            color=tuple(map(whole, each.color)),
            marker_color=tuple(map(whole, each.marker_color)),
        )
        for each in _read(path)[1].follower
    )


def with_world(flight: FlightParameters, **world: Any) -> FlightParameters:
    """Return a flight with other parameters of its world, checked again; those that are None stay as they are.

    Raises
    ------
    ValueError
        If a value is out of range; the text begins with its name.
    """
    said = {name: value for name, value in world.items() if value is not None}
    new = msgspec.structs.replace(flight.world, **said)  # replace() does not run the checks
    new.__post_init__()
    return msgspec.structs.replace(flight, world=new)


def with_uri(uri: str, flight: FlightParameters) -> FlightParameters:
    """Return a flight with the parameters that a URI names.

    Raises
    ------
    ValueError
        If it does not begin with ``sim://chain``, a parameter is unknown or out of range, or there are no pictures.
    """
    parsed = parse_uri(uri)
    names = uri.partition("?")[2]
    keys = [pair.partition("=")[0] for pair in names.split("&") if pair]
    world = {key: getattr(parsed, key) for key in keys if key not in Conditions.__struct_fields__}
    named = {key: getattr(parsed.conditions, key) for key in keys if key in Conditions.__struct_fields__}
    changed = with_conditions(with_world(flight, **world), **named)
    if changed.world.quick:
        raise ValueError("quick: a flight without pictures can only be flown by matchset simulate")
    return changed


def with_conditions(flight: FlightParameters, **named: float) -> FlightParameters:
    """Return a flight under other conditions than its controllers are told.

    Raises
    ------
    ValueError
        If a value is out of range; the text begins with its name.
    """
    conditions = msgspec.structs.replace(flight.world.conditions, **named)
    conditions.__post_init__()
    return with_world(flight, conditions=conditions)


def flight_parameters(path: Path | None, duration: float | None) -> FlightParameters:
    """Read the parameters from a file if there is one, with another duration if one is given."""
    flight = FlightParameters() if path is None else read_flight(path)
    if duration is None:
        return flight
    new = msgspec.structs.replace(flight, duration=duration)
    new.__post_init__()
    return new
