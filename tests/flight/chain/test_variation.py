"""What is varied: from the words of the command line to the parameters of each flight, the table and the picture."""

import csv
import math
from pathlib import Path

import pytest

from blue_ball import Matchset
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.chain.score import FlightScore
from matchset.flight.simulate.picture import survival_figure
from matchset.flight.simulate.table import Flown, RowLimits, cells, csv_header, csv_line, rows_of, sweep_verdict
from matchset.flight.simulate.variation import (
    Axis,
    FlightCase,
    changed,
    names_table,
    parse_sweep,
    parse_vary,
    plan,
    variable,
)
from matchset.sim.vehicle import VehicleParameters
from plot_layout import faults


def test_a_range_is_a_name_and_two_ends() -> None:
    axes = parse_vary("thrust=0.8..1.2, latency_ms=33..200,mass=1.1,yaw_trim_deg_s=-10..10")
    assert [axis.name for axis in axes] == ["thrust", "latency_ms", "mass", "yaw_trim_deg_s"]
    assert [(axis.low, axis.high) for axis in axes[2:]] == [(1.1, 1.1), (-10.0, 10.0)]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("thurst=0.8..1.2", "no 'thurst'; there are thrust, mass"),
        ("thrust", "NAME=LOW..HIGH"),
        ("thrust=1.2..0.8", "must go up"),
        ("thrust=nan..1", "needs numbers"),
        ("thrust=0.8..inf", "needs numbers"),
        ("thrust=0.8..", "needs numbers"),
        ("thrust=1,thrust=1.1", "twice"),
        ("vehicles=3..5", "no 'vehicles'"),
        ("", "NAME=LOW..HIGH"),
    ],
)
def test_what_is_no_range_is_refused_in_one_line(text: str, words: str) -> None:
    with pytest.raises(ValueError, match=words) as error:
        parse_vary(text)
    assert "\n" not in str(error.value)


def test_draws_follow_from_seed_and_name_and_fill_the_range() -> None:
    axis, other = parse_vary("thrust=0.8..1.2,mass=0.8..1.2")
    values = [axis.drawn(seed) for seed in range(200)]
    assert 0.8 < min(values) < 0.82
    assert 1.18 < max(values) < 1.2
    assert values == [axis.drawn(seed) for seed in range(200)]
    assert values[:5] != [other.drawn(seed) for seed in range(5)]


def test_a_plan_flies_each_alone_and_then_all_at_once() -> None:
    axes = parse_vary("thrust=0.8..1.2,mass=1.1")
    joint = plan(axes, 0, range(3))
    assert [case.alone for case in joint] == ["", "", ""]
    assert {case.values["mass"] for case in joint} == {1.1}
    cases = plan(axes, 3, range(2))
    assert {case.alone for case in cases[:6]} == {"thrust"}
    assert [case.values["thrust"] for case in cases[:6:2]] == pytest.approx([0.8, 1.0, 1.2])
    assert len(cases) == (3 + 1 + 1) * 2
    assert len(plan([parse_sweep("swing=0,0.1")], 0, range(2))) == 4


def test_the_simulated_side_alone_is_changed() -> None:
    told = FlightParameters()
    flight = changed(told, {"thrust": 0.8, "latency_ms": 133.0, "vehicle.mass": 0.12, "swing": 0.2})
    assert flight.pilot == told.pilot
    assert (flight.world.conditions.thrust, flight.world.swing, flight.world.vehicle.mass) == (0.8, 0.2, 0.12)
    assert (flight.world.latency_ms, flight.world.conditions.told_latency_ms) == (133.0, 67.0)
    assert changed(told, {"latency_ms": 133.0}, told=True).world.conditions.told_latency_ms is None
    assert changed(told, {"vehicles": 5.0}, told=True).world.vehicles == 5
    for name, value in (("thrust", 9.0), ("latency_ms", 900.0), ("vehicle.mass", -1.0)):
        with pytest.raises(ValueError, match=name.removeprefix("vehicle.")):
            changed(told, {name: value})


def test_every_name_is_in_the_table_of_names_and_in_the_page() -> None:
    table = names_table()
    assert all(f"| `{name}` |" in table for name in variable())
    page = Path(__file__).resolve().parents[3] / "docs" / "flight.md"
    assert table in page.read_text(encoding="utf-8"), "matchset simulate --print-names writes it"


def score(seed: int, survived: bool = True, spread: float = 0.04) -> FlightScore:
    return FlightScore(
        seed=seed,
        duration=60.0,
        end=60.0 if survived else 2.0,
        crash="" if survived else "vehicle 1 hit the floor, at 2.0 s",
        landing_reason="",
        in_view=(1.0,),
        found=(1.0,),
        losses=(0,),
        spread=((spread, 0.02, 0.03),) if survived else (),
        settling_time=1.0,
        descent_time=math.inf,
        processing=2e-4,
        age=0.067,
    )


def drawn(axes: list[Axis], count: int = 30) -> list[Flown]:
    return [
        Flown(case, score(case.seed, case.values["thrust"] > 0.9, 0.05 * case.values["thrust"]))
        for case in plan(axes, 0, range(count))
    ]


def test_rows_say_where_in_the_range_it_flies_and_limits_count_once() -> None:
    axes = parse_vary("thrust=0.8..1.2,mass=1.1")
    flown = drawn(axes)
    rows = rows_of(flown, axes)
    assert [row.name for row in rows] == ["thrust"] * 3 + ["all at once"]
    assert sum(len(row.scores) for row in rows[:3]) == len(rows[3].scores) == 30
    assert rows[0].survived < len(rows[0].scores)
    assert rows[2].survived == len(rows[2].scores)
    assert cells(rows[0])[:2] == ["thrust", "0.8 to 0.933"]
    holds, words = sweep_verdict(rows, FlightParameters(), RowLimits(survival=0.5, in_view=0.0, spread=math.inf))
    assert holds
    assert words.startswith("Limits hold: of 30 flights")
    assert not sweep_verdict(rows, FlightParameters(), RowLimits(survival=0.99, in_view=0.0, spread=math.inf))[0]


def test_a_line_of_csv_has_every_constant() -> None:
    axes = parse_vary("thrust=0.8..1.2,radio_delay_ms=20..40,mass=1")
    header, case = csv_header(axes).split(","), FlightCase("thrust", {"thrust": 0.8}, 5)
    row = dict(zip(header, next(csv.reader([csv_line(axes, Flown(case, score(5)))])), strict=True))
    assert (row["thrust"], row["radio_delay_ms"], row["mass"], row["varied"]) == ("0.8", "", "1", "thrust")
    assert (row["side_rms"], row["height_rms"], row["heading_rms"]) == ("0.0400", "0.0200", "0.0300")
    fallen = csv_line(axes, Flown(case, score(5, survived=False)))
    assert len(fallen.split(",")) == len(header)


@pytest.mark.parametrize("grid", [0, 3])
def test_the_picture_can_be_read(grid: int) -> None:
    axes = parse_vary("thrust=0.8..1.2,yaw_trim_deg_s=-10..10,latency_ms=33..200")
    cases = plan(axes, grid, range(20))
    flown = [Flown(case, score(case.seed, case.values.get("thrust", 1.0) > 0.9, 0.05)) for case in cases]
    assert not faults(survival_figure(axes, flown))
    assert not faults(survival_figure(axes[:1], [each for each in flown if not each.score.survived]))


def test_simulate_varies_draws_and_judges(
    matchset: Matchset, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = "simulate", "--vary", "thrust=0.4..0.45,mass=0.9..1.1", "--quick", "--seeds", 3, "--duration", 3
    assert matchset(*words, "--vehicles", 2, "--jobs", 1, "-o", "out") == 1
    assert "only 0 of 3 flights survive" in capsys.readouterr().out.strip().splitlines()[-1]
    assert matchset(*words, "--vehicles", 2, "--jobs", 1, "-o", "again", "--fly-at-least", 0) == 0
    rows = list(csv.DictReader((tmp_path / "out" / "flights.csv").read_text().splitlines()))
    assert [row["seed"] for row in rows] == ["100", "101", "102"]
    assert all(0.4 <= float(row["thrust"]) <= 0.45 and "floor" in row["reason"] for row in rows)
    assert (tmp_path / "again" / "flights.csv").read_text() != ""
    assert (tmp_path / "out" / "flights.svg").read_text().startswith("<svg")


def test_simulate_prints_the_names(matchset: Matchset, capsys: pytest.CaptureFixture[str]) -> None:
    assert matchset("simulate", "--print-names") == 0
    assert "`gust_m_s`" in capsys.readouterr().out


@pytest.mark.parametrize(
    "words",
    [
        ("--vary", "thurst=1..2"),
        ("--vary", "thrust=2..1"),
        ("--vary", "thrust=1..99"),
        ("--vary", "thrust=1..1.1", "--sweep", "swing=0"),
        ("--grid", "3"),
        ("--vary", "vehicle.mass=-1..1"),
        ("--vary", "rope_length_m=0.2..1", "--config", "swing.toml"),
    ],
)
def test_simulate_refuses_what_cannot_be_varied(
    matchset: Matchset, tmp_path: Path, capsys: pytest.CaptureFixture[str], words: tuple[str, ...]
) -> None:
    (tmp_path / "swing.toml").write_text("[flight.world]\nswing = 0.5\n")
    assert matchset("simulate", *words) == 2
    error = capsys.readouterr().err
    assert error.startswith("error: ")
    assert len(error.strip().splitlines()) == 1


def test_any_number_of_the_vehicle_can_be_varied() -> None:
    for key in VehicleParameters.__struct_fields__:
        assert parse_vary(f"vehicle.{key}=1")[0].name == f"vehicle.{key}"
