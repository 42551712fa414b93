"""The live view and its plain lines, read as a person would read them."""

import io
from typing import Any

import msgspec
import pytest
from rich.console import Console

from chain_flight import Flown, descending, lost, with_crash, with_step
from matchset.control.follower import RelativeSetpoint
from matchset.control.stability.gain_limit import GainsInUse
from matchset.flight.chain.score import FlightCounters
from matchset.flight.fly.live_view import COLUMNS, LiveView, render_view, text_line
from matchset.flight.fly.log import FlightLog, flight_summary
from matchset.live.piloting.state import follower_states

PLACE = RelativeSetpoint(height=-0.19)


def told(flown: Flown, **options: Any) -> str:
    """All that a console shows of the flight, with a loss, a descent and a crash at its end."""
    out = io.StringIO()
    console = Console(file=out, width=110, highlight=False, force_terminal=options.pop("terminal"), color_system=None)
    counters = FlightCounters(2)
    chain_steps = list(flown.chain_steps)
    chain_steps[10] = with_step(chain_steps[10], 0, lost(chain_steps[10].steps[0]))
    chain_steps[11:] = [
        with_crash(with_step(chain_step, 1, descending(chain_step.steps[1]))) for chain_step in chain_steps[11:]
    ]
    with LiveView(PLACE, 60.0, console=console, **options) as screen:
        for chain_step in chain_steps:
            counters.add(chain_step)
            screen.show(chain_step, counters)
    return out.getvalue()


def test_the_view_has_a_row_for_each_follower(flown: Flown) -> None:
    out, counters = io.StringIO(), FlightCounters(2)
    for chain_step in flown.chain_steps[:9]:
        counters.add(chain_step)
    chain_step = with_step(flown.chain_steps[9], 1, lost(flown.chain_steps[9].steps[1]))
    counters.add(chain_step)
    Console(file=out, width=110).print(render_view(chain_step, counters, PLACE, 60.0, 2.04))
    head, names, first, second, reason, *_ = out.getvalue().splitlines()
    assert head.startswith("0.4 of 60 s   2 times as fast as real time")
    assert all(column.name in names for column in COLUMNS)
    assert first.split()[:4] == ["1", "→", "2", "flying"]
    assert [word for word in first.split() if word in ("67", "30.0/s", "0")] == ["67", "30.0/s", "0"]
    distance = float(first.split()[4])
    assert distance == pytest.approx(1.51, abs=0.05)
    assert second.split()[3:5] == ["holding", "-"]
    assert second.rstrip().endswith("1")
    assert reason.startswith("2 holding: the ball is not seen")


def test_gains_that_are_lowered_are_said(flown: Flown) -> None:
    words = "swings to the side: gains lowered to 70 %"
    step, counters, out = flown.chain_steps[9].steps[0], FlightCounters(2), io.StringIO()
    assert step.control is not None
    gains = GainsInUse((0.7, 1.0, 1.0), words=words)
    step = msgspec.structs.replace(step, control=step.control._replace(gains=gains))
    chain_step = with_step(flown.chain_steps[9], 0, step)
    counters.add(chain_step)
    Console(file=out, width=110).print(render_view(chain_step, counters, PLACE, 60.0, None))
    assert f"1 flying: {words}" in out.getvalue()
    assert f"1: flying: {words}, " in text_line(chain_step, counters)
    assert follower_states(chain_step.steps, counters.followers, PLACE)[0].reason == words
    log = FlightLog(flown.setup)
    log.add(chain_step)
    assert log.gains.lines() == [f"{chain_step.time:.1f} s: vehicle 1: {words}"]
    assert flight_summary(log).endswith("gains of vehicle 1 were lowered")


@pytest.mark.parametrize("width", [24, 30, 40, 60, 80, 81, 110])
def test_a_narrow_terminal_gets_fewer_columns_and_whole_numbers(flown: Flown, width: int) -> None:
    """No number, name or reason is cut: what is on the narrow one is on the wide one, word by word."""
    counters = FlightCounters(2)
    chain_step = with_step(flown.chain_steps[9], 1, descending(flown.chain_steps[9].steps[1]))
    counters.add(chain_step)
    view = render_view(chain_step, counters, PLACE, 60.0, 2.04)
    texts = {}
    for each in (width, 200):
        out = io.StringIO()
        Console(file=out, width=each).print(view)
        texts[each] = out.getvalue()
    assert all(len(line) <= width for line in texts[width].splitlines())
    assert "\u2026" not in texts[width]
    assert set(texts[width].split()) <= set(texts[200].split())
    names = next(line.split() for line in texts[width].splitlines() if "state" in line)
    assert ("distance" in names) == (width >= 30)
    assert ("off" in names) == ("lost" in names) == (width >= 40)
    assert ("age" in names) == (width >= 60)
    assert ("side," in names) == ("rate" in names) == (width >= 80)


def test_nothing_known_is_a_dash(flown: Flown) -> None:
    chain_step = with_step(flown.chain_steps[3], 0, descending(lost(flown.chain_steps[3].steps[0])))
    counters = FlightCounters(2)
    counters.add(chain_step)
    out = io.StringIO()
    Console(file=out, width=110).print(render_view(chain_step, counters, PLACE, 60.0, None))
    assert out.getvalue().splitlines()[2].split()[3:] == ["descending", *"-------", "1"]


def test_elsewhere_it_prints_plain_lines(flown: Flown) -> None:
    lines = told(flown, terminal=False).splitlines()
    assert len(lines) == 2  # one now and then, and the crash, once
    assert "1: flying, 1.5" in lines[0]
    assert "67 ms old, lost 0   2: flying" in lines[0]
    assert lines[1].endswith("vehicle 1 hit the floor")
    assert "\x1b" not in "".join(lines)


def test_a_terminal_gets_the_table_and_keeps_the_crash(flown: Flown) -> None:
    shown = told(flown, terminal=True)
    assert "state" in shown
    assert "vehicle 1 hit the floor" in shown


def test_quiet_is_quiet(flown: Flown) -> None:
    assert told(flown, terminal=False, quiet=True) == told(flown, terminal=True, quiet=True) == ""


def test_a_line_says_why(flown: Flown) -> None:
    chain_step = with_step(flown.chain_steps[3], 0, descending(lost(flown.chain_steps[3].steps[0])))
    counters = FlightCounters(2)
    counters.add(chain_step)
    assert "1: descending: no new frame for 0.3 s, -, place not known, - old, lost 1" in text_line(chain_step, counters)


def test_losses_are_counted_as_spells(flown: Flown) -> None:
    counters = FlightCounters(2)
    for index, chain_step in enumerate(flown.chain_steps):
        step = chain_step.steps[0]
        counters.add(with_step(chain_step, 0, lost(step, "hidden") if index in (3, 4, 5, 9) else step))
    first = counters.followers[0]
    with_picture = sum(chain_step.steps[0].frame is not None for chain_step in flown.chain_steps)
    assert (first.frames, first.missing) == (with_picture, len(flown.chain_steps) - with_picture)
    assert first.missing > 0
    assert first.losses == 3  # twice hidden, and when the cable was pulled
    assert first.lost == 4
    assert first.reason == "no picture came"
    assert first.longest >= 0.13
    assert first.rate == pytest.approx(30.0)
    still = msgspec.structs.replace(flown.chain_steps[0].steps[0], frame=None)
    alone = FlightCounters(1).followers[0]
    alone.add(still)
    assert alone.rate is None
