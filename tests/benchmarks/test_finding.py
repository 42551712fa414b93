import math

import pytest
from benchmarks.results import Figure, Finding, Goal, Verdict, quantity, table


def finding(value: float | None) -> Finding:
    return Finding(
        name="row",
        what="a row",
        figures=(Figure("mean", value, "px", 2), Figure("frames", 7, "", 0, aside=True)),
        bar=(Goal("mean", high=1.5),),
        prize=(Goal("mean", high=0.8),),
    )


@pytest.mark.parametrize(
    ("value", "verdict"),
    [(0.8, "prize"), (1.5, "bar"), (1.51, "missed"), (None, "missed"), (math.nan, "missed")],
)
def test_a_verdict_is_the_best_that_is_true(value: float | None, verdict: Verdict) -> None:
    assert finding(value).verdict == verdict


def test_the_prize_needs_the_bar() -> None:
    row = Finding(
        name="row",
        what="a row",
        figures=(Figure("a", 0.0), Figure("b", 2.0)),
        bar=(Goal("a", high=1.0), Goal("b", high=1.0)),
        prize=(Goal("a", high=0.5),),
    )
    assert row.verdict == "missed"


def test_without_goals_there_is_no_verdict() -> None:
    assert Finding(name="row", what="a row", figures=(Figure("a", 1.0),)).verdict == "-"


def test_a_goal_for_a_figure_that_does_not_exist_is_refused() -> None:
    with pytest.raises(ValueError, match="speed"):
        Finding(name="row", what="a row", figures=(Figure("a", 1.0),), bar=(Goal("speed", high=1.0),))


def test_figures_and_goals_in_words() -> None:
    row = finding(1.234)
    assert row.measured() == "mean 1.23 px"
    assert row.goals(row.bar) == "mean ≤ 1.5 px"
    assert Goal("valid", low=98.0).words("%") == "valid ≥ 98 %"
    assert Goal("below", low=88.0, high=99.0).words("%") == "below 88 … 99 %"


@pytest.mark.parametrize(("value", "text"), [(None, "-"), (math.nan, "-"), (math.inf, "inf µs"), (2.0, "2.0 µs")])
def test_a_quantity_in_words(value: float | None, text: str) -> None:
    assert quantity(value, "µs", 1) == text


def test_a_table_in_markdown() -> None:
    assert table(["a", "b"], [["x", "1"]]) == "| a | b |\n| --- | ---: |\n| x | 1 |\n"
