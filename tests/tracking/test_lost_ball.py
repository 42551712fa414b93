"""What is asked of a lost ball: by its place, size and color, and at a click. Whole films are in `test_found_again`."""

import math
from unittest.mock import patch

import numpy as np
import pytest
from hidden_ball import picture

import matchset as ms
from matchset.image.disc_network.network import Disc
from matchset.tracking.ball.disc_search import DiscSearch
from matchset.tracking.ball.judge import Judge, NetworkParameters
from matchset.tracking.ball.lost_ball import _Expected
from matchset.tracking.motion import Gate
from matchset.tracking.outlines.outline_choice import OutlineChoice
from matchset.tracking.tracker import Tracker

LIMITS = NetworkParameters()
LAST = Gate(60.0, 90.0, 26.0)


def seen(x: float = 60.0) -> Tracker[ms.Circle]:
    """Tracker that has seen a ball of 26 px in one picture."""
    image = picture(x)
    tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(image, x, 90.0), start=(x, 90.0))
    assert tracker.update(image)
    return tracker


@pytest.mark.parametrize(("log_odds", "taken"), [(3.5, True), (2.5, False)])
def test_a_disc_at_a_click_that_is_sure_is_taken_whatever_its_region(log_odds: float, taken: bool) -> None:
    image = picture(160.0)
    tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(image, 160, 90), start=(160.0, 90.0))
    disc = Disc((160.0, 90.0, 26.0), np.eye(3), log_odds)
    with (
        patch.object(Judge, "discs", return_value=[disc]),
        patch.object(OutlineChoice, "is_other_shape", return_value=True),
        patch.object(OutlineChoice, "fit_lost", return_value=False),
    ):
        assert tracker._ball.begin(image, tracker.color, ms.Circle(*disc.circle), 0.0) is taken


@pytest.mark.parametrize("away", [0.0, 26.0, 70.0, 230.0])
@pytest.mark.parametrize("missed", [1.0, 5.0, 30.0])
def test_the_farther_off_and_the_longer_ago_the_more_is_asked(away: float, missed: float) -> None:
    known = _Expected(LAST, LAST.half_width, missed).log_odds(LAST._replace(x=LAST.x + away), LIMITS)
    places = 1.0 + (away / LAST.half_width) ** 2 + ((missed - 1.0) / LIMITS.forgotten) ** 2
    assert known == pytest.approx(max(-0.5 * math.log(places), -LIMITS.anywhere))


@pytest.mark.parametrize(("factor", "possible"), [(1.5, True), (1.0 / 1.5, True), (1.7, False), (1.0 / 1.7, False)])
def test_a_lost_ball_has_about_the_size_that_it_had(factor: float, possible: bool) -> None:
    found = LAST._replace(half_width=factor * LAST.half_width)
    assert (_Expected(LAST, LAST.half_width, 1.0).log_odds(found, LIMITS) is not None) is possible


@pytest.mark.parametrize(
    ("moved", "seconds", "log_odds", "taken"),
    [
        (0.0, 1.0, 1.3, True),
        (0.0, 1.0, 1.1, False),
        (0.0, 9.0, 2.1, True),  # nine frames ago: 0.8 more
        (0.0, 9.0, 1.9, False),
        (70.0, 1.0, 2.4, True),
        (70.0, 1.0, 2.1, False),
        (230.0, 1.0, 3.5, True),
        (230.0, 1.0, 3.3, False),
    ],
)
def test_a_disc_that_is_likely_enough_is_taken(moved: float, seconds: float, log_odds: float, taken: bool) -> None:
    tracker, frames = seen(), seconds
    disc = Disc((60.0 + moved, 90.0, 26.0), np.eye(3), log_odds)
    with (
        patch.object(Judge, "discs", return_value=[disc]),
        patch.object(Judge, "alike", return_value=log_odds),
        patch.object(OutlineChoice, "is_other_shape", return_value=False),
        patch.object(OutlineChoice, "fit_lost", return_value=False),
    ):
        assert tracker._ball.find(picture(60.0), tracker.color, LAST, None, frames / 30.0, 1.0 / 30.0) is taken


def test_a_disc_of_another_color_is_not_taken() -> None:
    tracker, disc = seen(), Disc((60.0, 90.0, 26.0), np.eye(3), 9.0)
    with patch.object(Judge, "discs", return_value=[disc]):
        assert not tracker._ball.find(picture(250.0), tracker.color, LAST, LAST, 1.0 / 30.0, 1.0 / 30.0)


def test_a_region_of_another_shape_is_taken_only_if_the_network_is_sure() -> None:
    for log_odds in (LIMITS.renewed - 0.1, LIMITS.renewed + 0.1):
        tracker, disc = seen(), Disc((60.0, 90.0, 26.0), np.eye(3), log_odds)
        with (
            patch.object(Judge, "discs", return_value=[disc]),
            patch.object(OutlineChoice, "is_other_shape", return_value=True),
            patch.object(OutlineChoice, "fit_lost", return_value=False),
        ):
            found = tracker._ball.find(picture(60.0), tracker.color, LAST, LAST, 1.0 / 30.0, 1.0 / 30.0)
        assert found is (log_odds > LIMITS.renewed)


def test_edge_points_decide_where_they_confirm_a_disc() -> None:
    tracker, disc = seen(), Disc((61.0, 90.0, 26.0), 0.3 * np.eye(3), 3.0)
    with patch.object(Judge, "discs", return_value=[disc]):
        assert tracker._ball.find(picture(60.0), tracker.color, LAST, LAST, 1.0 / 30.0, 1.0 / 30.0)
    assert not tracker.step.without_outline
    assert tracker.step.fitter.state[:3] == pytest.approx((60.0, 90.0, 26.0), abs=0.7)


def test_the_size_is_that_of_the_last_outline() -> None:
    tracker, disc = seen(160.0), Disc((160.0, 90.0, 44.0), np.eye(3), 4.0)
    last = Gate(160.0, 90.0, 40.0)
    with (
        patch.object(Judge, "discs", return_value=[disc]),
        patch.object(Judge, "alike", return_value=4.0),
        patch.object(OutlineChoice, "is_other_shape", return_value=False),
        patch.object(OutlineChoice, "fit_lost", return_value=False),
    ):
        assert tracker._ball.find(picture(160.0), tracker.color, last, last, 0.1, 1.0 / 30.0)
        assert tracker._ball._half_width == 40.0
        assert tracker.step.without_outline  # what was taken since has no say
        tracker._ball.find(picture(160.0), tracker.color, last._replace(half_width=50.0), last, 0.2, 1.0 / 30.0)
        assert tracker._ball._half_width == 40.0


def test_places_where_no_ball_is_seen_are_noted() -> None:
    tracker, places = seen(), [Gate(200.0, 50.0, 26.0), Gate(64.0, 90.0, 26.0)]
    disc = Disc((60.0, 90.0, 26.0), np.eye(3), 4.0)
    with (
        patch.object(DiscSearch, "about", return_value=places),
        patch.object(Judge, "discs", return_value=[disc]),
        patch.object(DiscSearch, "in_vain") as in_vain,
    ):
        tracker._ball.find(picture(60.0), tracker.color, LAST, LAST, 1.0 / 30.0, 1.0 / 30.0)
    noted = {(call.args[0].x, call.args[0].y) for call in in_vain.call_args_list}
    assert (200.0, 50.0) in noted
    assert (64.0, 90.0) not in noted
