"""Scores, rows, limits, verdicts, and `matchset simulate` itself on flights of half a second."""

import math
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest

from blue_ball import Matchset
from chain_flight import Flown as Steps
from chain_flight import with_crash
from matchset.flight.chain.flight import Flight
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.chain.score import FlightScore, FlightScorer, settling_time
from matchset.flight.simulate.table import Flown, RowLimits, markdown_table, rows_of, sweep_verdict
from matchset.flight.simulate.variation import Axis, FlightCase, parse_sweep
from matchset.links.simulation_parameters import SimulationParameters

GOOD = FlightScore(
    seed=1,
    duration=60.0,
    end=60.0,
    crash="",
    landing_reason="",
    in_view=(1.0, 1.0),
    found=(1.0, 1.0),
    losses=(0, 0),
    spread=((0.03, 0.02, 0.04), (0.05, 0.01, 0.02)),
    settling_time=1.0,
    descent_time=math.inf,
    processing=2e-4,
    age=0.067,
)


def of(latency: float, score: FlightScore = GOOD) -> Flown:
    return Flown(FlightCase("latency_ms", {"latency_ms": latency}, score.seed), score)


def test_who_comes_near_and_leaves_again_has_not_settled() -> None:
    time = np.arange(0.0, 10.0, 0.1)
    off = np.zeros((100, 2, 3))
    off[time < 2.0, 0, 1] = 0.5
    off[time < 3.0, 1, 2] = -0.3
    off[5, 1, 2] = 0.0
    assert settling_time(time, off) == pytest.approx(3.0)
    off[:, 0, 0] = 0.2
    assert settling_time(time, off) == math.inf


def test_of_a_long_chain_one_begins_after_the_other() -> None:
    three, five = (
        FlightParameters(world=SimulationParameters(vehicles=count), stagger=1.5, stagger_delays=0.0)
        for count in (3, 5)
    )
    assert [three.arming_time(who) for who in range(2)] == [1.5, 0.0]
    assert [five.arming_time(who) for who in range(4)] == [4.5, 3.0, 1.5, 0.0]
    two = msgspec.structs.replace(five, together=2)
    assert [two.arming_time(who) for who in range(4)] == [3.0, 1.5, 0.0, 0.0]
    bads: tuple[dict[str, Any], ...] = (
        {"together": 0},
        {"stagger": -1.0},
        {"stagger": math.nan},
        {"stagger_delays": -1.0},
        {"sight_ahead": -1.0},
        {"sight_ahead": math.nan},
        {"sight_margin": -1.0},
    )
    for bad in bads:
        with pytest.raises(ValueError, match=next(iter(bad))):
            FlightParameters(**bad)


@pytest.mark.parametrize(("latency_ms", "apart"), [(67.0, 1.73), (133.0, 2.22)])
def test_the_longer_the_delay_the_longer_each_waits(latency_ms: float, apart: float) -> None:
    flight = FlightParameters(world=SimulationParameters(vehicles=5, latency_ms=latency_ms))
    assert [flight.arming_time(who) for who in range(4)] == pytest.approx([3 * apart, 2 * apart, apart, 0.0], abs=0.03)
    conditions = msgspec.structs.replace(flight.world.conditions, told_latency_ms=67.0)
    late = msgspec.structs.replace(flight, world=msgspec.structs.replace(flight.world, conditions=conditions))
    assert late.arming_time(2) == pytest.approx(1.73, abs=0.01)


class Waiting:
    """A pilot that waits, and says of its ball what it was told to."""

    def __init__(self, armed: bool = False, losing: bool = False, killed: str = "", landing: str = "") -> None:
        self.armed, self.losing, self.killed, self.landing = armed, losing, killed, landing

    def is_losing_sight(self, ahead: float, margin: float) -> bool:
        assert (ahead, margin) == (0.6, 2.0)
        return self.losing


def test_one_that_loses_sight_of_a_neighbor_in_the_air_is_armed_at_once() -> None:
    flight = FlightParameters(world=SimulationParameters(vehicles=4))
    cases = [
        ([Waiting(), Waiting(), Waiting()], 0.0, [2]),
        ([Waiting(), Waiting(), Waiting(armed=True)], 1.0, []),
        ([Waiting(), Waiting(losing=True), Waiting(armed=True)], 1.0, [1]),
        ([Waiting(losing=True), Waiting(), Waiting(armed=True)], 1.0, []),  # its neighbor is in a hand still
        ([Waiting(), Waiting(), Waiting(armed=True)], 1.8, [1]),
        ([Waiting(), Waiting(losing=True, landing="q"), Waiting(armed=True)], 60.0, [0]),
        ([Waiting(landing="q"), Waiting(killed="space"), Waiting(killed="space")], 60.0, []),
    ]
    for pilots, time, expected in cases:
        due = [pilots.index(pilot) for pilot in flight.due(pilots, time)]  # type: ignore[arg-type]
        assert due == expected


def test_who_waits_is_held_and_flies_when_its_time_has_come() -> None:
    world = SimulationParameters(vehicles=4, pal="clean")
    parameters = FlightParameters(duration=0.5, together=2, stagger=0.2, stagger_delays=0.0, world=world)
    with Flight(parameters) as flight:
        armed, throttles = [], []
        for chain_step in flight:
            armed.append([pilot.armed for pilot in flight.pilots])
            throttles.append([step.command.throttle for step in chain_step.steps])
    assert armed[0] == [False, True, True]
    assert [each[0] for each in armed].index(True) == 6
    assert max(each[0] for each in throttles[:6]) == 0.0
    assert min(throttles[-1]) > 0.3


def test_ten_take_off_one_after_the_other_at_a_long_latency() -> None:
    world = SimulationParameters(vehicles=10, seed=1, latency_ms=133.0, quick=True)
    with Flight(FlightParameters(duration=19.3, world=world)) as flight:
        for chain_step in flight:
            assert not chain_step.crashes
    assert all(step.safety.phase == "flying" for step in chain_step.steps)


def test_a_flight_is_scored_by_its_steps(flown: Steps) -> None:
    scorer = FlightScorer(flown.setup.parameters)
    for chain_step in flown.chain_steps:
        scorer.add(chain_step)
    score = scorer.score()
    assert score.survived
    assert score.spread == ()
    assert score.worst_spread == math.inf
    assert score.losses == (1, 1)
    assert 0.5 < min(score.found) < 1.0
    scorer.add(with_crash(flown.chain_steps[-1]))
    assert scorer.crashed
    assert scorer.score().crash == f"vehicle 1 hit the floor at {flown.chain_steps[-1].time:.1f} s"
    assert not scorer.score().survived


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"crash": "vehicle 1 hit the floor at 3.0 s"}, "only 1 of 2 flights survive"),
        ({"landing_reason": "vehicle 1: no new frame"}, "only 1 of 2 flights survive"),
        ({"in_view": (1.0, 0.98)}, "in view for only 98.0 %"),
        ({"spread": ((0.03, 0.02, 0.13),)}, "held to 13.0 cm"),
    ],
)
def test_the_verdict_says_what_breaks_first(change: dict[str, object], words: str) -> None:
    bad = msgspec.structs.replace(GOOD, **change)
    rows = rows_of([of(67.0), of(67.0), of(133.0), of(133.0, bad)])
    holds, sentence = sweep_verdict(rows, FlightParameters(), RowLimits())
    assert not holds
    assert "with latency_ms 133" in sentence
    assert words in sentence


def test_the_verdict_is_good_when_all_limits_hold() -> None:
    rows = rows_of([of(67.0), of(133.0)])
    holds, sentence = sweep_verdict(rows, FlightParameters(), RowLimits())
    assert holds
    assert "\n" not in sentence
    assert "2 flights of 60 s" in sentence
    table = markdown_table(rows)
    assert "| latency_ms | 133 | 1 of 1 | 100.0 % |" in table
    assert not sweep_verdict([], FlightParameters(), RowLimits())[0]


def test_a_sweep_is_a_name_and_numbers() -> None:
    assert parse_sweep("latency_ms=0,33") == Axis("latency_ms", 0.0, 33.0, (0.0, 33.0), told=True)
    assert parse_sweep("vehicles=3,10").values == (3.0, 10.0)
    assert parse_sweep("thrust=0.8,1").values == (0.8, 1.0)
    for wrong in ("latency_ms", "colour=1", "swing=a", "pal=1"):
        with pytest.raises(ValueError, match="--sweep"):
            parse_sweep(wrong)


def test_simulate_writes_a_table_and_ends_with_the_verdict(
    matchset: Matchset, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = "simulate", "--sweep", "swing=0,0.1", "--seeds", 1, "--duration", 0.4, "--vehicles", 2, "--jobs", 1
    assert matchset(*words, "-o", "out", "--spread", 10) == 1  # too short for a spread
    last = capsys.readouterr().out.strip().splitlines()[-1]
    assert last.startswith("Limits do not hold: in 2 flights of 0.4 s")
    lines = (tmp_path / "out" / "flights.csv").read_text().splitlines()
    assert [line.split(",")[:2] for line in lines] == [["swing", "seed"], ["0", "100"], ["0.1", "100"]]


@pytest.mark.parametrize(
    "words",
    [
        ("simulate", "--world", "ring"),
        ("simulate", "--pal", "awful"),
        ("simulate", "--sweep", "latency_ms=0,5000"),
        ("simulate", "--survival", "2"),
        ("fly", "sim://chain?vehicles=1"),
        ("fly", "sim://chain", "--latency-ms", "-1"),
        ("fly", "sim://chain", "--duration", "0"),
        ("fly", "tello://"),
    ],
)
def test_what_is_wrong_is_refused_before_anything_moves(
    matchset: Matchset, capsys: pytest.CaptureFixture[str], words: tuple[str, ...]
) -> None:
    assert matchset(*words) == 2
    assert capsys.readouterr().err.startswith("error: ")


def test_fly_flies_and_prints_its_settings(matchset: Matchset, capsys: pytest.CaptureFixture[str]) -> None:
    assert matchset("fly", "sim://chain?vehicles=2&seed=7", "--duration", 0.3, "--quiet") == 0
    assert capsys.readouterr().out.startswith("flight: ")
    assert matchset("fly", "--print-config") == 0
    assert "[flight.pilot.safety]" in capsys.readouterr().out
