"""Which page commands, and what its silence does, walked exhaustively."""

import itertools
import math

import pytest

from matchset.app.live.piloting.commander import Commander, SilenceParameters
from walks import walk_all

STEP = 0.1


class Walked:
    """A commander after something happened, with times relative to now."""

    def __init__(self, before: Commander, happening: tuple[str, str, bool]) -> None:
        what, page, time = happening
        now = STEP if time else math.nan
        after = before.at(now)
        if what == "arm":
            after = after.arm(page, now)
        elif what == "alive":
            after = after.alive(page, now)
        elif what == "land":
            after = after.land(page)
        elif what == "kill":
            after = after.kill()
        self.before, self.happening, self.now = before, happening, after
        heard = after.heard if math.isinf(after.heard) else max(round(after.heard - STEP, 6), -2.0)
        self.after = Commander(duty=after.duty, page=after.page, heard=heard)


HAPPENINGS = list(itertools.product(("", "arm", "alive", "land", "kill"), ("one", "other"), (True, False)))
WALK = walk_all(Commander(), HAPPENINGS, Walked)


def test_the_walk_sees_every_duty() -> None:
    assert {each.after.duty for each in WALK} == {"idle", "flying", "holding", "descending", "stopped"}


def test_only_arming_begins_a_flight() -> None:
    for each in WALK:
        if each.before.duty in ("idle", "stopped") and each.after.duty not in ("idle", "stopped"):
            assert each.happening[0] == "arm"
        if each.before.duty == "descending":
            assert each.after.duty in ("descending", "stopped")


def test_a_page_that_does_not_command_keeps_nothing_alive() -> None:
    for each in WALK:
        what, page, _ = each.happening
        if what == "alive" and page != each.before.page:
            assert each.after == Walked(each.before, ("", page, each.happening[2])).after


def test_any_page_stops_the_motors() -> None:
    for each in WALK:
        if each.happening[0] == "kill":
            assert each.after.duty == "stopped"


def test_silence_holds_then_descends() -> None:
    flying = Commander().arm("one", 10.0)
    duties = [flying.at(10.0 + silent).duty for silent in (0.0, 0.29, 0.31, 0.99, 1.01, math.nan, -1.0)]
    assert duties == ["flying", "flying", "holding", "holding", "descending", "descending", "descending"]


def test_who_comes_back_in_time_flies_on() -> None:
    flying = Commander().arm("one", 0.0).alive("one", 0.9)
    assert flying.duty == "flying"
    assert flying.alive("one", 2.0).duty == "descending"


def test_silence_has_an_order() -> None:
    with pytest.raises(ValueError, match="0 < hold < descend"):
        SilenceParameters(hold=1.0, descend=0.5)
