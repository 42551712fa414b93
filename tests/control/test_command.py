import math

import pytest

from matchset.control.command import Command, clip


def test_at_rest_everything_is_zero() -> None:
    assert Command() == Command(roll=0.0, pitch=0.0, yaw=0.0, throttle=0.0)


@pytest.mark.parametrize("name", ["roll", "pitch", "yaw", "throttle"])
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 1.001, -1.001])
def test_what_must_never_be_sent_cannot_be_made(name: str, value: float) -> None:
    with pytest.raises(ValueError, match=f"{name} must be within"):
        Command(**{name: value})


def test_throttle_has_no_reverse() -> None:
    with pytest.raises(ValueError, match=r"-0\.1"):
        Command(throttle=-0.1)


@pytest.mark.parametrize(("value", "clipped"), [(-2.0, -1.0), (-1.0, -1.0), (0.3, 0.3), (0.5, 0.5), (0.7, 0.5)])
def test_a_number_is_clipped_to_a_range(value: float, clipped: float) -> None:
    assert clip(value, -1.0, 0.5) == clipped == min(max(value, -1.0), 0.5)
