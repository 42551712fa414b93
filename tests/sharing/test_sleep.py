"""A computer that sleeps, as a clock that a test sets: no pose from before is used afterwards, by nobody."""

import time

import pytest

import matchset as ms
from matchset.sharing.clock import Clock
from sharing_poses import LEVEL
from sharing_processes import Heard, told, until

pytest.importorskip("zenoh", reason="eclipse-zenoh, the extra `net`, is not installed")


class Laptop:
    """Can be put to sleep for a time, s: its clock of pictures stands still meanwhile, that of one awake does not."""

    def __init__(self) -> None:
        self.slept, right = 0.0, Clock()
        self.clock = Clock(lambda: right.now() + self.slept)
        self.awake = Clock(lambda: right.now() + self.slept, lambda: right.awake() + self.slept)


def test_what_came_before_this_computer_slept_is_old_and_what_comes_then_is_not(key: str) -> None:
    laptop = Laptop()
    with ms.Share("me", key=key, clock=laptop.clock) as share, ms.Share("left", key=key) as left:

        def heard_anew() -> bool:
            left.publish(LEVEL, time.monotonic())
            share.publish(LEVEL, time.monotonic())
            return any(share.others()) and any(left.others())

        heard, other = Heard(share), Heard(left)
        until(heard_anew)
        laptop.slept = 3600.0
        (found,) = share.others()
        assert not found
        assert isinstance(found.pose, ms.Lost)
        assert heard.has("me: this computer slept for 3600.0 s: the clocks of all are measured anew")
        until(heard_anew)
        (state,) = share.partners()
        assert state.offset is not None
        assert abs(state.offset.seconds - 3600.0) <= state.offset.uncertainty
        (found,) = share.others()
        assert isinstance(found.pose, ms.Pose)
        assert abs(found.pose.time - time.monotonic()) < 60.0
        assert other.count("me: began anew") == heard.count("slept") == 1


def test_a_short_sleep_is_enough(key: str) -> None:
    laptop = Laptop()
    with ms.Share("me", key=key, clock=laptop.clock) as share, ms.Share("left", key=key) as left:
        until(lambda: told(left) and any(share.others()))
        laptop.slept = 0.6
        assert not any(share.others())


def test_a_picture_from_before_the_sleep_is_not_new_for_others(key: str) -> None:
    laptop = Laptop()
    with ms.Share("me", key=key, clock=laptop.clock) as share, ms.Share("left", key=key, clock=laptop.awake) as left:

        def seen(taken: float, now: float | None) -> bool:
            share.publish(LEVEL, taken, now)
            return any(left.others())

        heard = Heard(left)
        until(lambda: seen(time.monotonic(), None))
        taken, laptop.slept = time.monotonic(), 3600.0

        def refused() -> bool:
            assert not seen(taken, taken + 0.1)
            return left.others()[0].reason.startswith("it is 3600.")

        until(refused)
        until(lambda: seen(time.monotonic(), None))
        assert not heard.has("slept")
