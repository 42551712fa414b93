"""The kept list of mismatches: every row can be flown, and says what it flies."""

import math

import msgspec
import pytest
from benchmarks.flight.mismatch import Row, rows

from matchset.app.flight.flight import FlightParameters
from matchset.app.flight.score import FlightScore


def test_every_row_differs_from_the_nominal_flight_on_one_side() -> None:
    listed = rows()
    assert len({row.words for row in listed}) == len(listed) > 20
    for row in listed:
        flight = row.flight(110, 60.0, rendered=False)
        told = flight.pilot != FlightParameters().pilot
        assert told == bool(row.told or row.mount)  # what was measured before is told rightly
        assert not (row.told and row.vary), row.words
        nominal = msgspec.structs.replace(FlightParameters().world, seed=110, quick=not row.pictures)
        assert (flight.world != nominal) == bool(row.vary), row.words
    assert not rows()[0].flight(110, 60.0, rendered=True).world.quick


@pytest.mark.parametrize(("spread", "survived", "bold"), [(0.04, 20, 0), (0.12, 20, 1), (0.04, 18, 1), (0.12, 18, 2)])
def test_what_misses_its_bar_is_bold(spread: float, survived: int, bold: int) -> None:
    scores = [
        FlightScore(
            seed=seed,
            duration=60.0,
            end=60.0,
            crash="" if seed < survived else "vehicle 1 hit the floor",
            landing_reason="",
            in_view=(1.0,),
            found=(1.0,),
            losses=(0,),
            spread=((spread, 0.02, 0.03),),
            settling_time=1.0,
            descent_time=math.inf,
            processing=2e-4,
            age=0.067,
        )
        for seed in range(20)
    ]
    words = Row(words="thrust -20 %").in_words(scores)
    assert words.startswith("| thrust -20 % |")
    assert words.count("**") == 2 * bold
