import pytest

from matchset.flight.chain.pacer import Pacer


class Clock:
    def __init__(self) -> None:
        self.time = 0.0

    def __call__(self) -> float:
        return self.time

    def sleep(self, seconds: float) -> None:
        self.time += seconds


def test_deadlines_do_not_drift() -> None:
    clock = Clock()
    pacer = Pacer(0.1, clock, clock.sleep)
    for k in range(1, 50):
        clock.time += 0.03
        pacer.wait()
        assert clock.time == pytest.approx(0.1 * k)


def test_a_late_turn_moves_no_deadline_and_what_was_missed_is_skipped() -> None:
    clock = Clock()
    pacer = Pacer(0.1, clock, clock.sleep)
    clock.time = 0.35
    pacer.wait()
    assert pacer.missed == 2
    assert clock.time == pytest.approx(0.35)
    pacer.wait()
    assert clock.time == pytest.approx(0.4)


def test_a_period_that_is_none_is_refused() -> None:
    with pytest.raises(ValueError, match="period"):
        Pacer(0.0)
