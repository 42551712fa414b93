"""The file that `matchset fly --config` reads: `vehicle_toml`, settings with standard deviations and dates."""

from collections.abc import Sequence
from datetime import date

from matchset.flight.identify.parameters import IdentifyParameters
from matchset.flight.identify.verdict import VehicleFinding

FOLLOWER = ("hover_throttle",)
OWN = (
    "full_tilt",
    "full_yaw_rate",
    "delay",
    "tilt_lag",
    "tilt_time",
    "tilt_damping",
    "yaw_lag",
    "lift_lag",
    "effective_mass_ratio",
)
"""What a flight reads, in ``[flight.pilot.follower]`` and ``[flight.pilot.follower.ego_motion]``."""


def vehicle_toml(found: Sequence[VehicleFinding], source: str, day: date, parameters: IdentifyParameters) -> str:
    """Write what was found as settings of a flight; what was not found keeps the flight's own number.

    Parameters
    ----------
    found : sequence of VehicleFinding
    source : str
        By what flight, for people: the link, and how long.
    day : date
    parameters : IdentifyParameters
    """
    by_name = {each.name: each for each in found}
    lines = [f"# A vehicle, by matchset identify {' '.join(source.split())}, {day}; +- is one standard deviation.", ""]
    for table, names in (("flight.pilot.follower", FOLLOWER), ("flight.pilot.follower.ego_motion", OWN)):
        lines += [f"[{table}]", *(_setting(by_name[name], day, parameters) for name in names), ""]
    for each in found:
        lines += [
            "[[identified]]" + (f"            # not found: {each.missing}" if each.missing else ""),
            f'name = "{each.name}"',
            f"value = {each.value:.6g}",
            f"sigma = {each.sigma:.2g}",
            f'unit = "{each.unit}"',
            f"found = {'false' if each.missing else 'true'}",
            f"date = {day}",
            "",
        ]
    return "\n".join(lines)


def _setting(finding: VehicleFinding, day: date, parameters: IdentifyParameters) -> str:
    """Write a line with unit, standard deviation, date and meaning; a comment where nothing was found."""
    unit = finding.unit or "no unit"
    if finding.missing:
        return f"# {finding.name}: not found: {finding.missing}"
    value, note = finding.value, ""
    if finding.name == "delay" and value < parameters.least_delay:
        value, note = parameters.least_delay, f"; found {finding.value:.4f}: pictures are stamped too late"
    setting = f"{finding.name} = {value:.6g}"
    return f"{setting:<23} # {unit}, +- {finding.sigma:.2g}, {day}; {finding.meaning}{note}"
