"""The known motions of the sticks: they are bounded, end where they began, and wait for a flight near its place."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from matchset.control.control_output import ControlOutput
from matchset.control.follower import RelativeSetpoint
from matchset.control.pid import PidTerms
from matchset.control.safety import DesiredCommand, Phase, SafetyState
from matchset.flight.chain.excitation import Excitation, ExcitationParameters, wave

PARAMETERS = ExcitationParameters()
PLACE = RelativeSetpoint(height=-0.19)
WANTED = DesiredCommand(0.1, -0.05, 0.02, 0.6)


def control(side: float = 0.0, height: float = -0.19, heading: float = 1.5, bearing: float = 0.0) -> ControlOutput:
    return ControlOutput(WANTED, side, height, heading, bearing, *(PidTerms(),) * 4)


def after(excitation: Excitation, seconds: float, phase: Phase = "flying") -> DesiredCommand:
    """The command so many s after the take-off."""
    for step in range(round(30.0 * seconds)):
        command = excitation(control(), SafetyState(phase), step / 30.0)
    return command


@pytest.mark.parametrize("holds", [PARAMETERS.roll_holds, PARAMETERS.yaw_holds, (0.2,)])
def test_a_vehicle_ends_where_it_began(holds: tuple[float, ...]) -> None:
    step = 1e-4
    speed = way = 0.0
    for k in range(round(4.0 * sum(holds) / step)):
        speed += wave((k + 0.5) * step, holds) * step
        way += speed * step
    assert abs(speed) < 1e-3
    assert abs(way) < 1e-3


@given(time=st.floats(0.0, 1e4), throttle=st.floats(0.0, 1.0))
def test_what_is_added_is_bounded(time: float, throttle: float) -> None:
    added = Excitation(PLACE).added(DesiredCommand(0.0, 0.0, 0.0, throttle), time)
    for name in ("roll", "pitch", "yaw"):
        assert abs(getattr(added, name)) <= getattr(PARAMETERS, name)
    assert abs(added.throttle - throttle) <= PARAMETERS.throttle * throttle + 1e-12


def test_it_waits_until_the_follower_hovers() -> None:
    excitation = Excitation(PLACE)
    assert after(excitation, PARAMETERS.begin - 0.1) == WANTED
    assert excitation.shaken == 0.0
    assert after(Excitation(PLACE), PARAMETERS.begin + 0.5) != WANTED


@pytest.mark.parametrize("phase", ["locked", "holding", "descending", "cut"])
def test_it_adds_nothing_unless_it_flies_and_sees_the_ball(phase: Phase) -> None:
    assert after(Excitation(PLACE), 5.0, phase) == WANTED


@pytest.mark.parametrize(
    "far",
    [{"side": 0.8}, {"height": 0.6}, {"heading": 0.7}, {"bearing": 0.4}, {"bearing": -0.4}, {"side": math.nan}],
)
def test_it_adds_nothing_far_from_its_place_or_with_the_ball_aside(far: dict[str, float]) -> None:
    excitation = Excitation(PLACE)
    after(excitation, 3.0)
    assert excitation(control(**far), SafetyState("flying"), 3.1) == WANTED
    assert excitation(control(), SafetyState("flying"), 3.2) != WANTED


@pytest.mark.parametrize(
    "wrong", [{"yaw": 0.6}, {"roll": -0.1}, {"throttle": 0.4}, {"yaw_holds": ()}, {"begin": math.nan}]
)
def test_what_is_no_excitation_is_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(ValueError, match=next(iter(wrong))):
        ExcitationParameters(**wrong)  # type: ignore[arg-type]
