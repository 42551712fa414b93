"""The parameters of a flight with their units and meanings, as `flight.toml` and `vehicle.toml` explain them."""

import re
from collections.abc import Iterator
from importlib import resources

import msgspec

from matchset.flight.chain.config import default_toml
from matchset.flight.chain.flight_parameters import FlightParameters

VEHICLE = "world.vehicle"


class ParameterRow(msgspec.Struct, frozen=True):
    """A parameter: its key (``pilot.place.height``), its value, its unit, its meaning, and whether it was changed."""

    key: str
    value: str
    unit: str = ""
    meaning: str = ""
    changed: bool = False


def parameter_rows(parameters: FlightParameters) -> list[ParameterRow]:
    """List all parameters of a flight, in their order; units and meanings come from the commented files."""
    known = explanations()
    default = dict(_flat("", msgspec.to_builtins(FlightParameters())))
    return [
        ParameterRow(key, value, *(known.get(key) or _alike(key, known)), changed=default.get(key) != value)
        for key, value in _flat("", msgspec.to_builtins(parameters))
    ]


def explanations() -> dict[str, tuple[str, str]]:
    """Read unit and meaning of each key from the comments of the files with the defaults."""
    vehicle = resources.files("matchset.sim").joinpath("vehicle.toml").read_text(encoding="utf-8")
    return dict(_explained(default_toml(), "")) | dict(_explained(vehicle, VEHICLE))


def _alike(key: str, known: dict[str, tuple[str, str]]) -> tuple[str, str]:
    """Meaning of the key of the same name in a section beside, or one further out; its unit may be another."""
    above, _, name = key.rpartition(".")
    while beside := (above := above.rpartition(".")[0]):
        found = [text for each, (_, text) in known.items() if re.fullmatch(rf"{re.escape(beside)}\.\w+\.{name}", each)]
        if found:
            return "", f"as of the others: {found[0]}"
    return "", ""


def _explained(text: str, section: str) -> Iterator[tuple[str, tuple[str, str]]]:
    for line in text.splitlines():
        if head := re.match(r"\[([\w.]+)\]", line):
            section = head[1].removeprefix("flight").removeprefix(".")
        elif found := re.match(r"(?:# )?(\w+) *= .*?# ([^,]+), (.*)", line):
            unit = "" if found[2] == "no unit" else found[2]
            yield f"{section}.{found[1]}" if section else found[1], (unit, found[3].partition(";")[0].strip())


def _flat(name: str, value: object) -> Iterator[tuple[str, str]]:
    """Yield the keys and values of nested parameters: ``pilot.place.height``."""
    if not isinstance(value, dict):
        yield name, str(value)
        return
    for key, each in value.items():
        yield from _flat(f"{name}.{key}" if name else key, each)
