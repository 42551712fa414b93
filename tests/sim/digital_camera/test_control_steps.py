import math

import pytest

from matchset.sim.digital_camera.control_steps import ControlSteps


def test_without_steps_nothing_changes() -> None:
    for steps in (ControlSteps(), ControlSteps(settling=0.3)):
        assert {steps.gain(0.1 * k) for k in range(100)} == {(1.0, 1.0, 1.0)}


def test_a_step_of_the_camera_stays_until_the_next() -> None:
    steps = ControlSteps(brightness=2.0, every=1.0)
    levels = [steps.gain(t)[1] for t in (0.0, 0.49, 0.51, 1.49, 1.51, 2.49, 2.51)]
    assert levels == [1.0, 1.0, 2.0, 2.0, 1.0, 1.0, 2.0]


def test_a_step_of_the_light_is_taken_back() -> None:
    steps = ControlSteps(brightness=4.0, every=10.0, settling=0.3)
    assert steps.gain(4.999)[1] == 1.0
    assert steps.gain(5.0 + 1e-9)[1] == pytest.approx(4.0)
    assert steps.gain(5.3)[1] == pytest.approx(4.0 ** math.exp(-1.0))
    assert steps.gain(14.9)[1] == pytest.approx(1.0, abs=1e-6)
    assert steps.gain(15.0 + 1e-9)[1] == pytest.approx(0.25)


def test_tint_moves_blue_and_red_apart() -> None:
    blue, green, red = ControlSteps(tint=0.2, every=1.0).gain(0.6)
    assert (blue, green, red) == pytest.approx((1.2, 1.0, 0.8))


@pytest.mark.parametrize(
    "changes", [{"brightness": 9.0}, {"tint": 1.0}, {"every": 0.0}, {"settling": -1.0}, {"brightness": math.nan}]
)
def test_misuse_of_steps(changes: dict[str, float]) -> None:
    with pytest.raises(ValueError, match=next(iter(changes))):
        ControlSteps(**changes)
