"""However often partners come and go, few lines are said; how many were left out is one more."""

from hypothesis import given
from hypothesis import strategies as st

from matchset.sharing.lines import LONGEST_LINE, LineParameters, Lines

FEW = LineParameters(period=60.0, partner=3, together=5)


def test_one_that_comes_and_goes_does_not_hide_what_others_do() -> None:
    lines = Lines(FEW)
    for number in range(1000):
        lines.say("left", [f"left: {number}"], 1.0 + 0.001 * number)
    lines.say("right", ["right: here"], 3.0)
    assert lines.take(4.0) == ["left: 0", "left: 1", "left: 2", "right: here"]
    assert lines.take(60.0) == []
    assert lines.take(61.1) == ["others: 997 more lines in 60 s"]
    lines.say("left", ["left: gone"], 62.0)
    assert lines.take(200.0) == ["left: gone"]


def test_what_is_said_once_is_always_said() -> None:
    lines = Lines(FEW)
    for number in range(20):
        lines.say(str(number), [f"{number}: here"], 1.0)
        lines.say_once("many", "many are here")
    assert [*lines.take(2.0)].count("many are here") == 1
    lines.say_once("many", "many are here")
    assert lines.take(3.0) == []


@given(st.lists(st.tuples(st.integers(0, 30), st.floats(0.0, 20.0), st.booleans()), max_size=200))
def test_a_period_has_few_lines_and_none_is_lost_uncounted(said: list[tuple[int, float, bool]]) -> None:
    lines, now, heard, told = Lines(FEW), 0.0, list[str](), 0
    for partner, later, looks in said:
        now += later
        lines.say(str(partner), [f"{partner}: here"], now)
        if looks:
            heard += lines.take(now)
    heard += [*lines.take(now), *lines.take(now + 2.0 * FEW.period)]
    told = sum(int(line.split()[1]) for line in heard if line.startswith("others: "))
    plain = [line for line in heard if not line.startswith("others: ")]
    assert len(plain) + told == len(said)
    assert len(plain) <= FEW.together * (2 + now // FEW.period)


def test_who_never_asks_does_not_keep_them_all() -> None:
    lines = Lines(FEW)
    for number in range(10_000):
        lines.say(str(number), ["here"], 20.0 * number)
    assert lines.take(2e5) == [*["here"] * FEW.together, "others: 9995 more lines in 199900 s"]


def test_a_line_is_short_whatever_it_quotes() -> None:
    lines = Lines(FEW)
    lines.say("left", ["left: " + 50_000 * "x"], 1.0)
    lines.say_once("many", 50_000 * "x")
    assert [len(line) for line in lines.take(1.0)] == [LONGEST_LINE, LONGEST_LINE]
