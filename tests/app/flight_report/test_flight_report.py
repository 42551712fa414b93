"""The report: figures that can be checked by hand, pictures that open, names that are refused."""

import base64
import re
from pathlib import Path

import cv2
import numpy as np
import pytest
from chain_flight import Flown, descending, lost, with_crash, with_step

from matchset.app.flight.log import HEADINGS, PHASES, FlightLog, flight_summary, follower_row
from matchset.app.flight.output_files import check_report
from matchset.app.flight_report.report import write_report


def log_of(flown: Flown) -> FlightLog:
    log = FlightLog(flown.setup)
    for chain_step in flown.chain_steps:
        log.add(chain_step)
    return log


def test_the_log_holds_the_numbers_of_the_steps(flown: Flown) -> None:
    log = log_of(flown)
    first = log.followers[0]
    steps = [chain_step.steps[0] for chain_step in flown.chain_steps]
    np.testing.assert_array_equal(first.time, [step.now for step in steps])
    np.testing.assert_array_equal(
        first.true_position, [chain_step.true_positions[0] for chain_step in flown.chain_steps]
    )
    control = steps[4].control
    assert control is not None
    assert first.estimated_position[4].tolist() == [control.side, control.height, control.heading]
    assert [PHASES[k] for k in first.phase] == [step.safety.phase for step in steps]
    np.testing.assert_array_equal(np.isnan(first.processing), [step.frame is None for step in steps])
    assert log.balls_in_room.shape == (len(steps), 3, 3)
    assert np.abs(first.estimated_in_chain - first.true_in_chain)[:10].max() < 0.3
    assert np.isnan(first.estimated_in_chain[-1]).all()
    assert float(np.nanmedian(first.circle_error_px)) < 1.5


def test_the_figures_are_in_the_order_of_their_headings(flown: Flown) -> None:
    log = log_of(flown)
    figures = dict(zip(HEADINGS, follower_row(log, 0), strict=True))
    assert figures[""] == "1 watches 2"
    assert figures["pictures"] == str(sum(chain_step.steps[0].frame is not None for chain_step in flown.chain_steps))
    assert figures["ball found where it was to be seen"].endswith("%")
    assert figures["losses"] == "1"
    assert figures["at the end"] == flown.chain_steps[-1].steps[0].safety.phase
    off = "off the set place, cm rms, from 5 s after its start on (side, height, heading)"
    assert figures[off] == "-"  # it is too short
    assert "nobody crashed" in flight_summary(log)


def test_the_verdict_names_who_crashed_or_came_down(flown: Flown) -> None:
    log = log_of(flown)
    log.add(with_crash(flown.chain_steps[-1]))
    assert "vehicle 1 hit the floor at 0.8 s" in flight_summary(log)
    assert follower_row(log, 0)[-1] == "hit the floor at 0.8 s"
    assert flight_summary(FlightLog(flown.setup)) == "nothing was flown"


def test_a_report_is_one_file_with_its_pictures_in_it(flown: Flown, tmp_path: Path) -> None:
    log, path = log_of(flown), tmp_path / "flight.html"
    chain_step = flown.chain_steps[3]
    log.add(with_step(chain_step, 0, descending(lost(chain_step.steps[0]))))
    write_report(log, path)
    page = path.read_text(encoding="utf-8")
    pictures = re.findall(r"data:image/png;base64,([^\"]+)", page)
    assert len(pictures) == 5  # paths, two followers, errors, times
    for each in pictures:
        image = cv2.imdecode(np.frombuffer(base64.b64decode(each), np.uint8), cv2.IMREAD_COLOR)
        assert image is not None
        assert image.shape[1] == 1480
        assert image.std() > 5.0
    assert "1 watches 2" in page
    assert "world.seed" in page
    assert "http" not in page  # nothing is fetched
    assert list(tmp_path.iterdir()) == [path]


def test_a_flight_that_never_began_has_a_report_too(flown: Flown, tmp_path: Path) -> None:
    write_report(FlightLog(flown.setup), tmp_path / "flight.html")
    assert "nothing was flown" in (tmp_path / "flight.html").read_text(encoding="utf-8")


def test_other_names_are_refused() -> None:
    check_report(Path("a.HTML"))
    with pytest.raises(ValueError, match=r"must end in \.html, got 'flight\.pdf'"):
        check_report(Path("flight.pdf"))
