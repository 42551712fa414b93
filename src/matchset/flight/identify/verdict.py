"""What was found of a vehicle and what not, and why: `findings`."""

import math

import msgspec

from matchset.flight.identify.estimate import VehicleEstimate
from matchset.flight.identify.flight_log import STICKS, StickLog
from matchset.flight.identify.parameters import IdentifyParameters
from matchset.flight.identify.unknowns import UNKNOWNS, Unknown

NEEDED = ("hover_throttle", "delay", "full_yaw_rate", "full_tilt")
"""Without these a flight with other vehicles fails: docs/flight.md has what happens."""
SHOWN = (
    *("hover_throttle", "sag", "delay", "full_yaw_rate", "yaw_lag", "yaw_trim", "full_tilt", "tilt_lag", "tilt_time"),
    *("tilt_damping", "roll_trim", "pitch_trim", "lift_lag", "effective_mass_ratio"),
)
"""What a person or a flight wants to know, in this order; the others are there for the fit."""
STICK_OF = {
    "full_yaw_rate": "yaw",
    "yaw_lag": "yaw",
    "full_tilt": "pitch",
    "tilt_lag": "pitch",
    "tilt_time": "pitch",
    "tilt_damping": "pitch",
    "lift_lag": "throttle",
    "effective_mass_ratio": "pitch",
    "delay": "yaw",
}


class VehicleFinding(msgspec.Struct, frozen=True):
    """A number of a vehicle after the flight.

    Parameters
    ----------
    name : str
    value : float
        In its unit; what is most likely even where the flight tells little.
    sigma : float
        Its standard deviation.
    unit, meaning : str
    missing : str
        Why it was not found, in words; empty if it was.
    """

    name: str
    value: float
    sigma: float
    unit: str
    meaning: str
    missing: str = ""

    @property
    def words(self) -> str:
        """Value and standard deviation for people: degrees and ms where the file has rad and s."""
        scale, unit = 1.0, self.unit
        if unit.startswith("rad"):
            scale, unit = math.degrees(1.0), unit.replace("rad", "degrees")
        elif unit == "s":
            scale, unit = 1e3, "ms"
        elif self.name in ("hover_throttle", "sag"):
            scale, unit = 100.0, "%" if self.name == "hover_throttle" else "%/s"
        value, sigma = scale * self.value, scale * self.sigma
        digits = max(1 - math.floor(math.log10(max(sigma, 1e-9))), 0)
        return f"{value:.{digits}f} +- {sigma:.{digits}f} {unit}".rstrip()


def findings(found: VehicleEstimate, log: StickLog, parameters: IdentifyParameters) -> tuple[VehicleFinding, ...]:
    """Say of each of `SHOWN` what it is, and whether the flight tells.

    Parameters
    ----------
    found : VehicleEstimate
    log : StickLog
    parameters : IdentifyParameters
    """
    return tuple(_finding(name, found, log, parameters) for name in SHOWN)


def _finding(name: str, found: VehicleEstimate, log: StickLog, parameters: IdentifyParameters) -> VehicleFinding:
    unknown, value, share = (getattr(each, name) for each in (UNKNOWNS, found.values, found.shares))
    missing = found.doubt or _bound(unknown, value, parameters.edge)
    if not missing and share > parameters.found:
        missing = _silence(name, log)
    return VehicleFinding(name, value, getattr(found.sigmas, name), unknown.unit, unknown.meaning, missing)


def _bound(unknown: Unknown, value: float, edge: float) -> str:
    """Say that a value is at a bound; empty if it is not."""
    for word, end in (("least", unknown.low), ("largest", unknown.high)):
        if abs(unknown.coordinate(value) - unknown.coordinate(end)) < edge:
            return f"out of bounds: at {end:g}, the {word} that is searched"
    return ""


def _silence(name: str, log: StickLog) -> str:
    """Say why a log tells nothing of a number."""
    stick = STICK_OF.get(name)
    if stick is None:
        return "the flight was too short, or too unsteady"
    moved = float(log.sticks[log.sent >= log.taken[0], STICKS.index(stick)].std())
    return f"the {stick} stick hardly moved (by {100.0 * moved:.0f} %), or too much else did"
