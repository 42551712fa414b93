"""Which page commands, and what its silence does, walked exhaustively."""

import itertools
import math
from typing import Any, NamedTuple, cast

import msgspec
import pytest

from matchset.live.piloting.commander import IN_FLIGHT, Commander, Duty, SilenceParameters
from walks import walk_all

STEP, LONG = 0.1, 2.0


class Happening(NamedTuple):
    """What happens within a step: what somebody does, which page, how old its picture is, whether the clock works."""

    what: str
    page: str = "one"
    age: float = 0.0
    time: float = STEP


class Walked:
    """A commander after something happened, with times relative to now."""

    def __init__(self, before: Commander, happening: Happening) -> None:
        what, page, age, now = happening
        after = before.at(now)
        if what == "arm":
            after = after.arm(page, now)
        elif what == "alive":
            after = after.alive(page, now, now - age)
        elif what == "land":
            after = after.land(page)
        elif what:
            after = getattr(after, what)(*(() if what == "again" else (what,)))
        self.before, self.happening, self.now = before, happening, after
        heard = after.heard if math.isinf(after.heard) else max(round(after.heard - STEP, 6), -LONG)
        self.after = msgspec.structs.replace(after, heard=heard)


HAPPENINGS = [
    Happening(*cast("Any", each))
    for each in itertools.product(
        ("", "arm", "alive", "land", "end", "kill", "down", "again"),
        ("one", "other", ""),
        (0.0, 0.4, 0.6, -1.0, math.nan),
        (STEP, math.nan, -1.0),
    )
    if each[0] == "alive" or (each[2] == 0.0 and (each[1] == "one" or each[0] in ("arm", "land")))
]
WALK = walk_all(Commander(), HAPPENINGS, Walked)


def test_the_walk_sees_every_duty_with_every_silence() -> None:
    assert {each.after.duty for each in WALK} == {"idle", "flying", "holding", "descending", "stopped"}
    assert len({each.before for each in WALK}) > 40


def test_only_arming_begins_a_flight_and_only_from_idle() -> None:
    for each in WALK:
        if each.before.duty not in IN_FLIGHT and each.after.duty in IN_FLIGHT:
            assert each.happening.what == "arm"
            assert each.before.duty == "idle"
            assert each.after.page == each.happening.page != ""


def test_after_a_stop_it_takes_two_acts_of_a_person_to_fly() -> None:
    for each in WALK:
        if each.before.duty == "stopped":
            assert each.after.duty == ("idle" if each.happening.what == "again" else "stopped")


def test_a_descent_ends_in_stopped_only() -> None:
    for each in WALK:
        if each.before.duty == "descending":
            stops = each.happening.what in ("kill", "down")
            assert each.after.duty == ("stopped" if stops else "descending")
            assert each.after.reason


def test_a_page_that_does_not_command_or_does_not_see_keeps_nothing_alive() -> None:
    for each in WALK:
        what, page, age, time = each.happening
        if what == "alive" and (page != each.before.page or not 0.0 <= age <= 0.5):
            assert each.after == Walked(each.before, Happening("", page, 0.0, time)).after


def test_nobody_takes_the_command_in_flight() -> None:
    for each in WALK:
        if each.before.duty in IN_FLIGHT and each.after.duty in IN_FLIGHT:
            assert each.after.page == each.before.page
        if each.happening.what == "land" and each.happening.page != each.before.page:
            assert each.after == Walked(each.before, Happening("", "one", 0.0, each.happening.time)).after


def test_any_page_stops_the_motors() -> None:
    for each in WALK:
        if each.happening.what == "kill":
            assert (each.after.duty, each.after.page) == ("stopped", "")


def test_from_everywhere_silence_ends_the_flight_in_time() -> None:
    steps = math.ceil(SilenceParameters().descend / STEP)
    for situation in {each.before for each in WALK}:
        at = situation
        for _ in range(steps):
            at = Walked(at, Happening("")).after
        assert at.duty not in ("flying", "holding")


def test_silence_holds_then_descends() -> None:
    flying = Commander().arm("one", 10.0)
    duties = [flying.at(10.0 + silent).duty for silent in (0.0, 0.29, 0.31, 0.99, 1.01, math.nan, -1.0)]
    assert duties == ["flying", "flying", "holding", "holding", "descending", "descending", "descending"]
    assert flying.at(11.5).reason == "one was silent for 1 s"


def test_who_comes_back_in_time_flies_on() -> None:
    flying = Commander().arm("one", 0.0).alive("one", 0.9, 0.8)
    assert flying.duty == "flying"
    assert flying.alive("one", 2.0, 2.0).duty == "descending"


@pytest.mark.parametrize(("now", "duty"), [(0.2, "flying"), (0.35, "holding"), (1.1, "descending")])
def test_a_page_whose_pictures_stand_still_is_silent(now: float, duty: Duty) -> None:
    painted = -0.45
    assert Commander().arm("one", 0.0).alive("one", now, painted).duty == duty


def test_silence_has_an_order() -> None:
    with pytest.raises(ValueError, match="0 < hold < descend"):
        SilenceParameters(hold=1.0, descend=0.5)
    with pytest.raises(ValueError, match="blind must be positive"):
        SilenceParameters(blind=math.nan)
