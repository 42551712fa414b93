import re
from importlib import resources

import pytest

from matchset.sim.toml_settings import read_settings
from matchset.sim.vehicle import VehicleParameters, toy

TEXT = resources.files("matchset.sim").joinpath("vehicle.toml").read_text(encoding="utf-8")


def changed(pattern: str, new: str) -> str:
    text, count = re.subn(pattern, new, TEXT, flags=re.MULTILINE)
    assert count == 1
    return text


def test_every_line_has_a_unit_and_a_source() -> None:
    toy()
    for line in TEXT.splitlines():
        if "=" in line.split("#")[0]:
            unit, source = line.split("#", 1)[1].split(",", 1)
            assert unit.strip()
            assert len(source.strip()) > 15


@pytest.mark.parametrize(
    ("pattern", "new", "words"),
    [
        (r"^mass = .*$", "mass = -1.0", "vehicle.toml, line 2: mass must be positive, got -1.0"),
        (r"^mass = .*$", "mas = 0.1", "mas"),
        (r"^mass = .*$", 'mass = "heavy"', "line 2.*mass"),
        (r"^mass = .*$", "", "missing.*mass"),
        (r"^mass = .*$", "mass = = 1", "line 2"),
        (r"^thrust_to_weight = .*$", "thrust_to_weight = 0.9", "line 6: thrust_to_weight"),
        (r"^full_tilt_deg = .*$", "full_tilt_deg = nan", "line 11: full_tilt_deg"),
        (r"^level_bias_deg = .*$", "level_bias_deg = 90.0", "line 13: level_bias_deg"),
    ],
)
def test_what_is_wrong_is_refused_with_key_and_line(pattern: str, new: str, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        read_settings(changed(pattern, new), VehicleParameters, "vehicle.toml")
