"""What a computer that sleeps does to ages: two clocks that a test sets, one of which stands still meanwhile."""

import contextlib
import threading
import time
from collections.abc import Iterator

import pytest
from hypothesis import given
from hypothesis import strategies as st

import matchset as ms
from matchset.sharing.clock import Clock, PictureAges
from matchset.sharing.sent_targets import sent_targets
from sharing_poses import LEVEL

SENT = sent_targets(LEVEL)


class Laptop:
    """A computer with two clocks."""

    def __init__(self) -> None:
        self.awake, self.slept, self.between = 100.0, 0.0, 0.0
        self.clock = Clock(lambda: self.awake + self.slept, self._awake)

    def _awake(self) -> float:
        """The clock of pictures, which is read `between` after the other one."""
        return self.awake + self.between


def test_sleep_is_what_one_clock_counts_and_the_other_does_not() -> None:
    laptop = Laptop()
    laptop.awake += 50.0
    assert laptop.clock.asleep == 0.0
    laptop.slept += 3600.0
    assert (laptop.clock.asleep, laptop.clock.asleep) == (3600.0, 3600.0)
    laptop.slept += 60.0
    assert laptop.clock.asleep == 3660.0
    assert laptop.clock.ahead == 3660.0


@given(st.lists(st.floats(0.0, 10.0), min_size=1, max_size=20))
def test_pauses_between_the_readings_are_no_sleep(pauses: list[float]) -> None:
    laptop = Laptop()
    for pause in pauses:
        laptop.between = pause
        assert laptop.clock.asleep == 0.0


@pytest.fixture
def interrupted() -> Iterator[float]:
    """Pauses between the first readings."""
    return iter((2.0, 0.0, 1.0, *[0.0] * 9))


def test_a_pause_between_the_first_readings_is_no_sleep(interrupted: Iterator[float]) -> None:
    assert Clock(lambda: 5.0, lambda: 5.0 + next(interrupted)).asleep == 0.0


def test_the_clock_of_the_messages_goes_on_beside_that_of_pictures() -> None:
    clock = Clock()
    before = clock.now()
    assert before <= clock.now() < before + 60.0
    assert clock.awake() == pytest.approx(time.monotonic(), abs=60.0)
    if hasattr(time, "CLOCK_BOOTTIME"):
        assert clock.now() == pytest.approx(time.clock_gettime(time.CLOCK_BOOTTIME), abs=60.0)


def test_where_a_kernel_has_no_such_clock_the_other_one_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    def no_clock(_: int) -> float:
        raise OSError(22, "Invalid argument")

    monkeypatch.setattr(time, "clock_gettime", no_clock)
    assert Clock().now is time.monotonic


def test_pictures_from_before_a_sleep_are_as_old_as_they_are() -> None:
    laptop = Laptop()
    ages = PictureAges(laptop.clock)
    assert ages.of(SENT, 99.9, None) == [pytest.approx(0.1)]
    laptop.awake, laptop.slept = 101.0, 3600.0
    assert ages.of(SENT, 99.9, None) == [pytest.approx(3601.1)]
    assert ages.of(SENT, 100.95, None) == [pytest.approx(3600.05)]  # from before, or from after: nobody knows
    laptop.awake = 101.1
    assert ages.of(SENT, 101.05, None) == [pytest.approx(0.05)]
    assert ages.of(SENT, 100.95, None) == [pytest.approx(3600.15)]
    laptop.awake, laptop.slept = 110.0, 3610.0
    assert ages.of(SENT, 99.9, None) == [pytest.approx(3620.1)]
    assert ages.of(SENT, 101.05, None) == [pytest.approx(18.95)]


def test_so_are_those_with_times_of_another_clock_until_that_begins_anew() -> None:
    laptop = Laptop()
    ages = PictureAges(laptop.clock)
    assert ages.of(SENT, 7.0, 7.1) == [pytest.approx(0.1)]
    laptop.slept = 60.0
    assert ages.of(SENT, {"ball": 7.0}, 7.2) == [pytest.approx(60.2)]
    assert ages.of(SENT, 7.3, 7.3) == [0.0]
    assert ages.of(SENT, 0.0, 0.1) == [pytest.approx(0.1)]
    assert ages.of(SENT, 7.0, 7.1) == [pytest.approx(0.1)]


def test_a_picture_from_between_now_and_the_sleep_is_from_before() -> None:
    laptop = Laptop()
    ages = PictureAges(laptop.clock)
    laptop.awake = 100.012
    ages.of(SENT, 99.990, 100.0)
    laptop.awake, laptop.slept = 100.045, 3600.0  # `now` was read, a picture taken at 100.040, and then it slept
    assert ages.of(SENT, 100.030, 100.033) == [pytest.approx(3600.003)]
    laptop.awake = 100.070
    assert ages.of(SENT, 100.040, 100.058) == [pytest.approx(3600.018)]
    assert ages.of(SENT, 100.067, 100.068) == [pytest.approx(0.001)]


def test_who_has_not_told_anything_for_long_tells_new_pictures_soon_after_a_sleep() -> None:
    laptop = Laptop()
    ages = PictureAges(laptop.clock)
    laptop.awake, laptop.slept = 900.0, 3600.0
    ages.of(SENT, 899.9, 900.0)
    laptop.awake = 901.1
    assert ages.of(SENT, 901.05, 901.1) == [pytest.approx(0.05)]


def test_a_camera_that_is_told_a_moment_late_does_not_forget_a_sleep() -> None:
    laptop = Laptop()
    ages = PictureAges(laptop.clock)
    ages.of(SENT, 99.9, 100.0)
    laptop.slept = 60.0
    ages.of(SENT, 99.9, 100.05)
    ages.of(SENT, 99.9, 100.049)
    assert ages.of(SENT, 100.0, 100.1) == [pytest.approx(60.1)]


class Together(float):
    """A shortest sleep that two threads compare with theirs at the same time, if they may."""

    waiting = threading.Barrier(2)

    def __lt__(self, other: float) -> bool:
        with contextlib.suppress(threading.BrokenBarrierError):
            self.waiting.wait(0.2)
        return float(self) < other


def test_a_sleep_is_noted_once_by_several_threads() -> None:
    slept = [0.0]
    clock = Clock(lambda: slept[0], lambda: 0.0, Together(0.1))
    slept[0] = 60.0
    threads = [threading.Thread(target=lambda: clock.asleep) for _ in range(2)]
    for each in threads:
        each.start()
    for each in threads:
        each.join()
    assert clock.asleep == 60.0


def test_a_lost_target_has_an_age_too() -> None:
    lost: ms.Lost[ms.Circle] = ms.Lost("hidden", 1.0)
    assert PictureAges(Laptop().clock).of(sent_targets(lost), 99.0, None) == [1.0]
