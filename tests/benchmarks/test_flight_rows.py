"""The kept list of flights: every row can be flown, says what it flies, and is judged by its bar."""

import math

import msgspec
import pytest
from benchmarks.flight.flown import Flown
from benchmarks.flight.page import judge, line_of, remarks
from benchmarks.flight.rows import Row, chosen, flight_list, parse_share, rows, share_of

from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.chain.score import FlightScore


def flown(seed: int, spread: float = 0.04, crash: str = "", **other: float) -> Flown:
    score = FlightScore(
        seed=seed,
        duration=60.0,
        end=60.0,
        crash=crash,
        landing_reason="",
        in_view=(other.get("in_view", 1.0),),
        found=(1.0,),
        losses=(0,),
        spread=((spread, 0.02, 0.03),),
        settling_time=other.get("settling_time", 1.0),
        descent_time=other.get("descent_time", math.inf),
        processing=2e-4,
        age=0.067,
    )
    return Flown(score=score, noticed=other.get("noticed", math.inf))


def test_every_row_differs_from_the_nominal_flight_where_it_says() -> None:
    listed = rows()
    assert len({row.words for row in listed}) == len({row.name for row in listed}) == len(listed) > 40
    assert listed[0].name == "nominal"
    for row in listed:
        flight, nominal = row.flight(1000), FlightParameters(duration=row.duration)
        nominal_world = msgspec.structs.replace(nominal.world, seed=1000)
        assert (flight.pilot != nominal.pilot) == bool(row.told or row.mount or row.level_gains != 1.0), row.name
        assert not (row.told and row.vary), row.words
        assert (flight.world != nominal_world) == bool(row.vary or row.world), row.name
        assert not flight.world.quick
        assert row.flight(1000, quick=True).world.quick


def test_gains_set_too_high_are_those_of_the_level_loop_high_and_low() -> None:
    row = next(row for row in rows() if row.level_gains != 1.0)
    found, nominal = row.flight(1000).pilot.follower, FlightParameters().pilot.follower
    assert found.horizontal.proportional == pytest.approx(1.5 * nominal.horizontal.proportional)
    assert found.gain_schedule.derivative == pytest.approx(1.5 * nominal.gain_schedule.derivative)
    assert found.vertical == nominal.vertical


def test_rows_are_chosen_by_name_or_else_by_their_words() -> None:
    every = rows()
    assert chosen(every, "") == every
    assert [row.name for row in chosen(every, "hidden")] == ["hidden"]  # and not hidden1
    assert [row.name for row in chosen(every, "ten, gusts")] == ["gusts0.5", "gusts1", "ten"]
    with pytest.raises(ValueError, match="no row 'gust3'; there are nominal, "):
        chosen(every, "nominal,gust3")


def test_the_order_is_by_seed_or_by_row() -> None:
    two = chosen(rows(), "nominal,wind")
    assert [(each.row.name, each.seed) for each in flight_list(two, (5, 6))] == [
        *(("nominal", 5), ("wind", 5)),
        *(("nominal", 6), ("wind", 6)),
    ]
    assert [each.seed for each in flight_list(two, (5, 6), order="rows")] == [5, 6, 5, 6]
    assert {each.flight.duration for each in flight_list(two, (5,), duration=3.0)} == {3.0}


def test_without_pictures_rows_that_only_pictures_show_are_left_out() -> None:
    assert not [each for each in flight_list(rows(), (5,), quick=True) if each.row.pictures]
    assert [each for each in flight_list(rows(), (5,)) if each.row.pictures]


def test_shares_cover_the_list_without_overlap() -> None:
    listed = flight_list(rows(), (1000, 1001, 1002))
    shares = [share_of(listed, parse_share(f"{k}/4")) for k in (1, 2, 3, 4)]
    names = [(each.row.name, each.seed) for share in shares for each in share]
    assert sorted(names) == sorted((each.row.name, each.seed) for each in listed)
    assert len(set(names)) == len(names)
    assert max(map(len, shares)) - min(map(len, shares)) <= 1


@pytest.mark.parametrize("text", ["", "2", "0/3", "4/3", "-1/3", "a/b", "1/"])
def test_what_is_no_share_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="a share is I/N"):
        parse_share(text)


@pytest.mark.parametrize(
    ("spread", "survived", "reached"), [(0.04, 20, True), (0.12, 20, False), (0.04, 19, True), (0.04, 18, False)]
)
def test_a_row_is_judged_by_its_bar(spread: float, survived: int, reached: bool) -> None:
    flights = [flown(seed, spread, "" if seed < survived else "vehicle 1 hit the floor") for seed in range(20)]
    row = Row(name="thrust-20", words="thrust -20 %")
    assert judge(row, flights) == reached
    line = line_of(row, flights, 20, math.inf)
    assert line.startswith(f"| thrust -20 % | 19 of 20, 10 cm | 20 of 20 | {survived} of 20 | {100 * spread:.1f} cm |")
    assert ("**no**" in line) == (not reached)
    assert ("crashed: 18, 19" in line) == (survived == 18)


def test_other_bars() -> None:
    start = Row(name="start", words="", kind="settle", limit=6.0)
    assert judge(start, [flown(0, settling_time=5.9)])
    assert not judge(start, [flown(0), flown(1, settling_time=6.1)])
    assert not judge(start, [flown(0), flown(1, crash="vehicle 1 hit the floor")])
    cable = Row(name="cable", words="", kind="descent", limit=0.5, world={"cable": 2.0})
    assert judge(cable, [flown(0, descent_time=2.4)])
    assert not judge(cable, [flown(0, descent_time=2.6)])
    hidden = Row(name="hidden", words="", kind="crash")
    assert judge(hidden, [flown(0, spread=9.0)])
    assert not judge(hidden, [flown(0, crash="vehicle 1 hit the floor")])
    seen = Row(name="nominal", words="", in_view=0.99)
    assert not judge(seen, [flown(0, in_view=0.98)])


def test_noticed_swings_are_told() -> None:
    row = Row(name="gains", words="", level_gains=1.5)
    assert remarks(row, [flown(0, noticed=8.0), flown(1)]) == ["swings noticed in 1 of 2, after 8 s (median)"]
    assert remarks(row, [flown(0)]) == ["swings noticed in 0 of 1"]
    assert not remarks(Row(name="nominal", words=""), [flown(0)])


def test_what_is_missing_of_a_row_is_said() -> None:
    row = Row(name="wind", words="wind 1 m/s")
    assert "| 12 of 20 |" in line_of(row, [flown(seed) for seed in range(12)], 20, math.inf)
    assert "| yes so far |" in line_of(row, [flown(seed) for seed in range(12)], 20, math.inf)
    assert "| 0 of 20 |" in line_of(row, [], 20, math.inf)
    assert "too short" in line_of(row, [flown(0, spread=math.inf)], 1, 3.0)
    assert "too short" not in line_of(Row(name="ten", words="", rms=math.inf), [flown(0, spread=math.inf)], 1, 3.0)
    cells = [line_of(row, flights, 20, math.inf).count("|") for flights in ([], [flown(0)])]
    assert cells[0] == cells[1]
