"""Parameters of control: an error begins with the name of the parameter, which is its key in a file."""

import math

import msgspec
import pytest

from matchset.control.follower import FollowerParameters
from matchset.control.neighbor_model import NeighborFilterParameters
from matchset.control.pid import PidParameters
from matchset.control.safety import SafetyParameters
from matchset.control.sticks.ego_parameters import EgoMotionParameters


def test_an_error_begins_with_the_name() -> None:
    with pytest.raises(ValueError, match=r"^effective_mass_ratio must be positive, got -1.0$"):
        EgoMotionParameters(effective_mass_ratio=-1.0)
    with pytest.raises(ValueError, match=r"^gate must be positive, got nan$"):
        NeighborFilterParameters(gate=math.nan)
    with pytest.raises(msgspec.ValidationError, match=r"^max_error must be positive, got 0.0"):
        msgspec.convert({"proportional": 1.0, "max_error": 0.0}, PidParameters)
    with pytest.raises(ValueError, match="min_throttle must be below max_throttle"):
        SafetyParameters(min_throttle=0.9)
    with pytest.raises(ValueError, match=r"integral_floor must be within 0"):
        PidParameters(proportional=1.0, integral_floor=1.5)
    with pytest.raises(ValueError, match=r"horizontal_lead must be zero or positive"):
        FollowerParameters(horizontal_lead=-0.1)
