"""One partner, as a table of what it sends: the newest counts, what is old is never used, each oddity is told once."""

from typing import Any

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

import matchset as ms
from matchset.sharing.clock_offset import ExchangeParameters, Offset
from matchset.sharing.messages import FORMAT, ClockMessage, OffsetMessage, PoseMessage, TargetsMessage
from matchset.sharing.partner import Partner, PartnerParameters
from matchset.sharing.shared_target import Age, AgeParameters, SharedTarget, is_pose, reason_not_to_use
from sharing_poses import LEVEL, TRACK, target_messages

AGES = AgeParameters()
HOUR = 3600.0


def partner(here: bool = True) -> Partner:
    made = Partner("left", ("me", 1), ExchangeParameters(), PartnerParameters())
    if here:
        made.come()
    return made


def message(number: int, captured: float, run: int = 7, **changed: Any) -> TargetsMessage:
    plain = TargetsMessage(
        format=FORMAT,
        name="left",
        run=run,
        number=number,
        sent=captured,
        offsets=[],
        targets=target_messages(LEVEL, captured),
    )
    return msgspec.structs.replace(plain, **changed)


def answer(now: float, ahead: float = 0.0, run: int = 7, wall: float = 0.0) -> ClockMessage:
    there = now + ahead
    return ClockMessage(format=FORMAT, name="left", run=run, received=there, answered=there, wall=wall)


def synchronized(ahead: float = 0.0) -> Partner:
    """One whose clock is known, and which has sent a picture of 10.00 s that came at 10.02 s."""
    made = partner()
    made.take(message(0, 10.0 + ahead), 10.02)
    made.compare(10.03, answer(10.031, ahead), 10.032, 0.0)
    return made


def only(made: Partner, now: float) -> SharedTarget:
    (found,) = made.targets(now, AGES)
    return found


@pytest.mark.parametrize("ahead", [0.0, HOUR, -HOUR])
def test_a_pose_has_its_time_on_the_own_clock(ahead: float) -> None:
    found = only(synchronized(ahead), 10.1)
    assert found
    assert isinstance(found.pose, ms.Pose)
    assert found.pose.time == pytest.approx(10.0, abs=0.0011)
    assert found.age is not None
    assert found.age.seconds == pytest.approx(0.1, abs=0.0011)
    assert found.age.uncertainty == pytest.approx(0.001, abs=1e-4)


@given(st.floats(0.0, 100.0), st.floats(-1e5, 1e5))
def test_what_is_too_old_is_never_used(later: float, ahead: float) -> None:
    found = only(synchronized(ahead), 10.032 + later)
    assert found.age is not None
    usable = found.age.seconds + found.age.uncertainty <= AGES.max_age
    assert bool(found) == isinstance(found.pose, ms.Pose) == usable
    if later > 0.5:
        assert not found
    if not found:
        assert (found.values, found.reason != "") == ({}, True)


def test_an_outline_is_not_used_either_when_it_is_old() -> None:
    made = synchronized()
    made.take(message(1, 10.0, targets=target_messages(TRACK, 10.0)), 10.04)
    assert only(made, 10.1).values == TRACK.measured()
    old = only(made, 20.0)
    assert (old.shape, old.values) == ("Circle", {})


def test_without_a_clock_nothing_is_used() -> None:
    made = partner()
    made.take(message(0, 10.0), 10.02)
    found = only(made, 10.03)
    assert (bool(found), found.age, found.reason) == (False, None, "the clock of the partner is not known yet")
    assert isinstance(found.pose, ms.Lost)


def test_the_partners_own_measurement_counts_where_there_is_none() -> None:
    told = OffsetMessage(partner="me", run=1, offset=HOUR, uncertainty=0.002)
    made = partner()
    made.take(message(0, 10.0 + HOUR, offsets=[told]), 10.02)
    assert made.offset.at(10.02) == Offset(-HOUR, 0.002)
    assert only(made, 10.03)
    other = partner()
    other.take(message(0, 10.0, offsets=[msgspec.structs.replace(told, run=2)]), 10.02)
    assert other.offset.at(10.02) is None


def test_the_own_measurement_counts_where_it_is_the_better_one() -> None:
    made = synchronized()
    for number in range(1, 40):
        told = OffsetMessage(partner="me", run=1, offset=0.0, uncertainty=0.5)
        made.take(message(number, 10.0, offsets=[told]), 10.04)
    known = made.offset.at(10.04)
    assert known is not None
    assert known.uncertainty < 0.002


@given(st.permutations(range(8)))
def test_of_messages_in_any_order_the_newest_counts(order: list[int]) -> None:
    made, newest = partner(), -1
    for number in order:
        made.take(message(number, float(number)), 10.0)
        newest = max(newest, number)
        state = made.state(10.0)
        assert made._message is not None
        assert made._message.number == newest
        assert state.received + state.missed == newest - order[0] + 1


def test_lost_messages_are_counted_from_the_first_that_came() -> None:
    made = partner()
    for number in (100, 101, 105, 104):
        made.take(message(number, 1.0), 1.0)
    assert (made.state(1.0).received, made.state(1.0).missed) == (3, 3)


def test_messages_that_nobody_looked_at_are_not_missed() -> None:
    made = partner()
    made.take(message(0, 1.0), 1.0)
    made.take(message(5, 1.0), 1.0, 3)
    assert (made.state(1.0).received, made.state(1.0).missed) == (4, 2)


def test_who_has_slept_measures_every_clock_anew_and_so_do_partners() -> None:
    made = synchronized()
    made.woken(2)
    assert only(made, 10.05).reason == "the clock of the partner is not known yet"
    before = OffsetMessage(partner="me", run=1, offset=0.0, uncertainty=0.002)
    made.take(message(1, 10.0, offsets=[before]), 10.05)
    assert made.offset.at(10.05) is None
    made.take(message(2, 10.0, offsets=[msgspec.structs.replace(before, run=2)]), 10.06)
    assert only(made, 10.07)


def test_poses_have_their_time_on_the_clock_of_pictures() -> None:
    (found,) = synchronized().targets(10.1, AGES, 3.0)
    assert isinstance(found.pose, ms.Pose)
    assert found.pose.time == pytest.approx(7.0, abs=0.0011)


def test_a_partner_that_begins_anew_is_told_and_its_past_does_not_come_back() -> None:
    made = synchronized()
    assert made.take(message(0, 11.0, run=8), 11.0) == ["left: began anew"]
    assert made.offset.at(11.0) is None
    words = "left: two computers share under this name: the one that began last counts"
    assert made.take(message(1, 11.0, run=7), 11.0) == [words]
    assert made.take(message(2, 11.0, run=7), 11.0) == []
    assert made.compare(11.0, answer(11.0, run=7), 11.0, 0.0) == []
    assert made.run == 8


def test_silence_is_told_once_and_so_is_the_return() -> None:
    made = synchronized()
    assert made.look(10.5) == []
    assert made.look(11.5) == ["left: silent for 1.5 s"]
    assert made.look(11.8) == []
    assert made.state(11.8).silent
    assert made.take(message(1, 12.0), 12.02) == ["left: back after 2.0 s"]
    assert made.look(12.1) == []


def test_one_that_is_gone_is_told_and_not_used() -> None:
    made = synchronized()
    assert made.leave() == ["left: gone"]
    assert made.leave() == []
    assert made.look(20.0) == []
    assert only(made, 10.05).reason == "not seen: its program is gone"
    assert made.come() == ["left: here"]
    assert only(made, 10.05).reason == "not seen: its program is gone"
    made.take(message(1, 10.04), 10.06)
    assert only(made, 10.07)


def test_a_wrong_time_of_day_is_told_once_and_changes_nothing() -> None:
    made = partner()
    made.take(message(0, 10.0), 10.02)
    words = "left: its time of day is 3600 s ahead of this one: ages are measured, they are right"
    assert made.compare(10.03, answer(10.031, wall=HOUR), 10.032, 0.0) == [words]
    assert made.compare(10.04, answer(10.041, wall=HOUR), 10.042, 0.0) == []
    assert only(made, 10.05)


def test_a_clock_that_jumps_is_told() -> None:
    made = synchronized()
    assert made.compare(10.04, answer(10.041, HOUR), 10.042, 0.0) == ["left: its clock has jumped: it is measured anew"]
    assert "s from now" in only(synchronized(), 9.9).reason


def test_a_pose_from_before_a_clock_jumped_does_not_become_new() -> None:
    made = partner()
    made.take(message(3, 10.0), 10.02)
    made.compare(10.03, answer(10.031), 10.032, 0.0)
    made.compare(20.0, answer(20.001, -10.0), 20.002, 0.0)  # of a picture of 10 s it is 10 s there again
    assert made.targets(20.01, AGES) == []
    made.take(message(2, 9.9), 20.02)
    assert made.targets(20.03, AGES) == []
    made.take(message(4, 10.02), 20.04)
    assert only(made, 20.05)


def test_what_a_partner_tells_of_its_clock_does_not_displace_what_was_measured_here() -> None:
    made = synchronized()
    wrong = OffsetMessage(partner="me", run=1, offset=HOUR, uncertainty=1e-6)
    made.take(message(1, 10.0, offsets=[wrong]), 10.04)
    known = made.offset.at(10.04)
    assert known is not None
    assert abs(known.seconds) < 0.002
    made.take(message(2, 10.0, offsets=[msgspec.structs.replace(wrong, offset=0.0)]), 10.05)
    assert made.offset.at(10.05) == Offset(0.0, 1e-6)


def test_a_message_under_another_name_is_refused_once() -> None:
    made = partner()
    words = "left: sends messages that say they are of 'right': refused"
    assert made.take(message(0, 1.0, name="right"), 1.0) == [words]
    assert made.take(message(0, 1.0, name="right"), 1.0) == []
    assert made.targets(1.0, AGES) == []


@pytest.mark.parametrize(
    ("age", "lost", "words"),
    [
        (Age(0.1, 0.001), "", ""),
        (Age(0.1, 0.001), "hidden", "not seen: hidden"),
        (None, "", "not known yet"),
        (Age(0.499, 0.002), "", "0.50 s old, at most 0.5 s is used"),
        (Age(0.1, 0.06), "", "known to ±0.06 s, at most ±0.05 s"),
        (Age(-0.01, 0.001), "", "0.01 s from now"),
        (Age(-0.0005, 0.001), "", ""),
        (Age(float("nan"), 0.0), "", "at most 0.5 s is used"),
    ],
)
def test_why_something_is_not_used(age: Age | None, lost: str, words: str) -> None:
    reason = reason_not_to_use(age, lost, AGES)
    assert words in reason
    assert bool(words) == bool(reason)


def test_a_shared_target_is_a_line_and_a_dictionary() -> None:
    found = only(synchronized(), 10.1)
    assert repr(found).startswith("SharedTarget(left 'ball', 0.1000 ±0.0010 s old: Pose(")
    assert found.to_dict()["usable"] is True
    old = only(synchronized(), 20.0)
    assert repr(old) == "SharedTarget(left 'ball', not to be used: it is 10.00 s old, at most 0.5 s is used)"
    assert old.to_dict()["pose"]["found"] is False


@pytest.mark.parametrize(
    "change",
    [
        {"rotation_matrix": ((0.0,) * 3,) * 3},
        {"rotation_matrix": ((2.0, 0.0, 0.0), (0.0, 3.0, 0.0), (0.0, 0.0, 1.0))},
        {"rotation_matrix": ((-1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))},
        {"covariance": tuple(tuple(-1.0 if row == column == 2 else 0.0 for column in range(6)) for row in range(6))},
    ],
)
def test_numbers_that_are_no_pose(change: dict[str, Any]) -> None:
    even = tuple(tuple(float(row == column) for column in range(6)) for row in range(6))
    turned = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    sent = {"position": (0.0, 0.0, 1.0), "rotation_matrix": turned, "covariance": even, "observed": "full", "time": 0.0}
    assert is_pose(msgspec.convert(sent, PoseMessage))
    assert not is_pose(msgspec.convert(sent | change, PoseMessage))
