"""Parameters of control: the keys of their files stay, and an error names key and field."""

import math

import msgspec
import pytest

from matchset.control.feedforward import FeedforwardParameters
from matchset.control.follower import FollowerParameters
from matchset.control.neighbor_model import NeighborFilterParameters
from matchset.control.pid import PidParameters
from matchset.control.safety import SafetyParameters
from matchset.control.sticks.ego_parameters import EgoMotionParameters

KEYS: dict[type[msgspec.Struct], str] = {
    EgoMotionParameters: """full_tilt full_yaw_rate delay tilt_lag tilt_time tilt_damping yaw_lag lift_lag drag_time
        heft""",
    FeedforwardParameters: "share calm",
    FollowerParameters: "level rise yaw hover lead rise_lead ahead drift pace rise_pace own motion reach memory",
    NeighborFilterParameters: """acceleration turning lasting turn_lasting period damping sway turn_sway tilt yaw shared
        gate jump patience""",
    PidParameters: """proportional integral derivative smoothing stride most most_integral within foresight learning
        settled""",
    SafetyParameters: """tilt yaw least_throttle most_throttle slew throttle_slew fresh hold seen_again descent
        descent_throttle""",
}


@pytest.mark.parametrize("kind", KEYS)
def test_the_keys_of_files_stay(kind: type[msgspec.Struct]) -> None:
    assert set(KEYS[kind].split()) <= set(kind.__struct_encode_fields__)


def test_an_error_begins_with_the_key_and_names_the_field() -> None:
    with pytest.raises(ValueError, match=r"^heft \(effective_mass_ratio\) must be positive, got -1.0$"):
        EgoMotionParameters(effective_mass_ratio=-1.0)
    with pytest.raises(ValueError, match=r"^gate must be positive, got nan$"):
        NeighborFilterParameters(gate=math.nan)
    with pytest.raises(msgspec.ValidationError, match=r"^stride \(max_error\) must be positive, got 0.0"):
        msgspec.convert({"proportional": 1.0, "stride": 0.0}, PidParameters)
    with pytest.raises(ValueError, match=r"least_throttle \(min_throttle\) must be below most_throttle"):
        SafetyParameters(min_throttle=0.9)
    with pytest.raises(ValueError, match=r"settled \(integral_floor\) must be within 0"):
        PidParameters(proportional=1.0, integral_floor=1.5)
    with pytest.raises(ValueError, match=r"lead \(horizontal_lead\) must be zero or positive"):
        FollowerParameters(horizontal_lead=-0.1)
