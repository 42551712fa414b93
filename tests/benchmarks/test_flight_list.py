"""The list of flights goes on where it was stopped, and its page says what it is of."""

import math
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import msgspec
import pytest
from benchmarks.flight import flown as flown_module
from benchmarks.flight import fly as fly_module
from benchmarks.flight.flown import Flown, KeptFlights, checksum, flier, fly_missing, sources
from benchmarks.flight.fly import Run, main
from benchmarks.flight.rows import Listed, Row, chosen, flight_list, rows
from typer import BadParameter, Exit

import matchset
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.chain.score import FlightScore
from matchset.flight.simulate.flights import in_processes

CODE = sources()


def never() -> bool:
    return False


def pretended(flight: FlightParameters) -> Flown:
    score = FlightScore(
        seed=flight.world.seed,
        duration=flight.duration,
        end=flight.duration,
        crash="",
        landing_reason="",
        in_view=(1.0,),
        found=(1.0,),
        losses=(0,),
        spread=((0.04, 0.02, 0.03),) * (flight.world.vehicles - 1),
        settling_time=1.0,
        descent_time=2.2 if math.isfinite(flight.world.cable) else math.inf,
        processing=2e-4,
        age=0.067,
    )
    return Flown(score=score)


def pretend(
    flights: Sequence[FlightParameters], stop: Callable[[], bool], most: int = 10**6
) -> Iterator[tuple[int, Flown]]:
    for number, flight in enumerate(flights[:most]):
        if stop():
            return
        yield number, pretended(flight)


def fly(listed: Sequence[Listed], path: Path, most: int = 10**6) -> list[Listed]:
    """Fly what is missing, at most so many."""
    kept = KeptFlights([path], CODE)
    return list(fly_missing(listed, kept, lambda flights, stop: pretend(flights, stop, most), never, "a machine"))


@pytest.fixture
def listed() -> list[Listed]:
    return flight_list(chosen(rows(), "nominal,wind,cable"), (1000, 1001))


def test_a_run_that_was_stopped_flies_only_what_is_missing(listed: list[Listed], tmp_path: Path) -> None:
    path = tmp_path / "flights.kept"
    first = fly(listed, path, most=4)
    rest = fly(listed, path)
    assert [*first, *rest] == listed
    assert len(first) == 4
    assert not fly(listed, path)
    kept = KeptFlights([path], CODE)
    found = [kept.get(each.flight) for each in listed]
    assert [each and each.flown for each in found] == [pretended(each.flight) for each in listed]


def test_each_flight_is_kept_as_soon_as_it_is_flown(listed: list[Listed], tmp_path: Path) -> None:
    path = tmp_path / "flights.kept"
    for number, _ in enumerate(fly_missing(listed, KeptFlights([path], CODE), pretend, never, "a machine"), 1):
        assert len(path.read_bytes().splitlines()) == number


@pytest.mark.parametrize("cut", [1, 2, 101])
def test_a_torn_last_line_is_flown_again(listed: list[Listed], tmp_path: Path, cut: int) -> None:
    path = tmp_path / "flights.kept"
    fly(listed, path, most=3)
    path.write_bytes(path.read_bytes()[:-cut])
    missing = 3 if cut == 1 else 4  # without its end alone a line is whole
    assert KeptFlights([path], CODE).torn == (cut > 1)
    assert fly(listed, path) == listed[-missing:]
    assert not fly(listed, path)


def test_several_files_are_read_and_the_first_is_added_to(listed: list[Listed], tmp_path: Path) -> None:
    here, there = tmp_path / "here.kept", tmp_path / "there.kept"
    fly(listed[::2], here)
    fly(listed[1::2], there)
    sizes = here.stat().st_size, there.stat().st_size
    kept = KeptFlights([here, there], CODE)
    assert not list(fly_missing(listed, kept, pretend, never, "a machine"))
    kept.add(FlightParameters(), pretended(FlightParameters()), "a machine")
    assert (here.stat().st_size > sizes[0], there.stat().st_size) == (True, sizes[1])
    joined = tmp_path / "joined.kept"
    joined.write_bytes(here.read_bytes() + there.read_bytes())
    assert not fly(listed, joined)


def test_flights_of_other_sources_do_not_count(listed: list[Listed], tmp_path: Path) -> None:
    path = tmp_path / "flights.kept"
    fly(listed, path)
    other = KeptFlights([path], "other")
    assert other.left_out == len(listed)
    assert other.get(listed[0].flight) is None
    page = Run([listed[0].row], (1000, 1001), other, math.inf, quick=False).page(None)
    assert f"{len(listed)} kept flights of other sources of matchset are left out." in page
    assert "| 0 of 2 |" in page


def test_sources_that_change_while_it_flies_end_it(
    listed: list[Listed], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    kept = KeptFlights([tmp_path / "flights.kept"], CODE)
    monkeypatch.setattr(flown_module, "sources", lambda: "changed")
    with pytest.raises(ValueError, match="a page is of one commit"):
        list(fly_missing(listed, kept, pretend, never, "a machine"))


def test_the_checksum_of_sources_is_that_of_the_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a.py").write_text("1")
    monkeypatch.setattr(matchset, "__file__", str(tmp_path / "__init__.py"))
    first = sources()
    (tmp_path / "notes.md").write_text("decides nothing")
    assert sources() == first
    (tmp_path / "a.py").write_text("2")
    assert sources() != first


def test_a_flight_is_known_by_all_that_is_flown_and_by_nothing_else() -> None:
    row, replace = Row(name="wind", words="wind", vary="wind_m_s=1"), msgspec.structs.replace
    of = checksum(row.flight(5))
    assert of == checksum(replace(row, name="breeze", words="a breeze", rms=3.0, survive=20).flight(5))
    others = [
        row.flight(6),
        row.flight(5, duration=3.0),
        row.flight(5, quick=True),
        replace(row, vary="wind_m_s=2").flight(5),
        replace(row, told={"hover_throttle": 0.5}).flight(5),
        replace(row, world={"vehicles": 4}).flight(5),
        replace(row, mount={"marker_yaw": 0.1}).flight(5),
        replace(row, level_gains=1.5).flight(5),
    ]
    assert len({of, *map(checksum, others)}) == 1 + len(others)


def test_all_flights_of_the_list_are_different() -> None:
    listed = flight_list(rows(), (1000, 1001))
    assert len({checksum(each.flight) for each in listed}) == len(listed)


def test_the_page_says_which_flights_are_missing(tmp_path: Path) -> None:
    path, seeds = tmp_path / "flights.kept", tuple(range(1000, 1020))
    asked = chosen(rows(), "nominal,wind")
    fly(flight_list([*asked, *chosen(rows(), "ten")], seeds), path, most=7)
    page = Run(asked, seeds, KeptFlights([path], CODE), math.inf, quick=False).page(None)
    assert page.startswith("# Flights\n")
    lines = {line.split(" | ")[0]: line for line in page.splitlines()}
    assert "| 3 of 20 | 3 of 3 | 4.0 cm |" in lines["| nominal: three vehicles, typical pictures, 67 ms"]
    assert "| 2 of 20 | 2 of 2 |" in lines["| wind 1 m/s"]
    assert "| 2 of 20 | 2 of 2 |" in lines["| chain of ten, 30 s"]  # nobody asked for it, but it was flown
    assert "so far" in lines["| wind 1 m/s"]
    assert "Not flown: told100, " in page
    assert "Seeds 1000-1019." in page
    assert "a machine" in page
    assert "Chain of ten, seed 1000, 30 s" in page


def test_without_pictures_the_page_says_so(tmp_path: Path) -> None:
    run = Run(chosen(rows(), "wind,blur"), (1000,), KeptFlights([tmp_path / "none"], CODE), math.inf, quick=True)
    page = run.page(None)
    assert page.startswith("# Flights without pictures\n")
    assert "blur, " in page
    assert "16 ms" not in page


def test_wrong_options_are_refused(tmp_path: Path) -> None:
    kept = [tmp_path / "none"]
    with pytest.raises(BadParameter, match="there is no row 'gust3'"):
        main(only="gust3", kept=kept)
    with pytest.raises(BadParameter, match="a share is I/N"):
        main(share="3/2", kept=kept)
    with pytest.raises(BadParameter, match="seeds are numbers"):
        main(seeds="x", kept=kept)


def test_a_trial_is_only_printed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(fly_module, "PAGES", tmp_path)
    kept = [tmp_path / "flights.kept"]
    for quick, duration in ((True, math.inf), (False, 3.0), (False, math.inf)):
        fly(flight_list(chosen(rows(), "wind"), (1000,), duration, quick), kept[0])
        with pytest.raises(Exit):
            main(only="wind", kept=kept, fly=False, quick=quick, duration=duration)
        assert "| 1 of 20 |" in capsys.readouterr().out
        assert (tmp_path / "FLIGHT.md").exists() == (not quick and duration == math.inf)


def test_a_page_without_any_flight_does_not_replace_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fly_module, "PAGES", tmp_path)
    with pytest.raises(Exit):
        main(kept=[tmp_path / "none"], fly=False)
    assert not (tmp_path / "FLIGHT.md").exists()


def test_a_flight_of_a_second_is_scored_and_a_stopped_one_is_not_kept(tmp_path: Path) -> None:
    listed = flight_list(chosen(rows(), "nominal"), (1000, 1001), duration=0.5, quick=True)
    kept = KeptFlights([tmp_path / "flights.kept"], CODE)
    flights = fly_missing(listed, kept, flier(1), lambda: kept.get(listed[0].flight) is not None, "a machine")
    assert list(flights) == listed[:1]
    found = kept.get(listed[0].flight)
    assert found is not None
    assert found.flown.score.survived
    assert found.flown.noticed == math.inf
    assert kept.get(listed[1].flight) is None


def test_work_in_processes_may_be_stopped() -> None:
    assert sorted(in_processes(abs, (-1, -2), 2, never)) == [(0, 1), (1, 2)]
    assert not list(in_processes(abs, (-1, -2), 2, lambda: True))
