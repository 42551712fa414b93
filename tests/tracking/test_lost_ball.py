"""What is asked of a lost ball: by its place, size and color, and at a click. Whole films are in `test_found_again`."""

import copy
from contextlib import ExitStack
from unittest.mock import patch

import numpy as np
import pytest
from hidden_ball import Picture, picture

import matchset as ms
from matchset.image.disc_network.network import Disc
from matchset.tracking.ball.belief import Belief
from matchset.tracking.ball.judge import Judge, NetworkParameters
from matchset.tracking.ball.parameters import BallSearchParameters
from matchset.tracking.ball.places.color_places import ColorPlaceParameters
from matchset.tracking.constants import TrackerConstants
from matchset.tracking.motion import Gate
from matchset.tracking.outlines.outline_choice import OutlineChoice
from matchset.tracking.parameters import TrackerParameters
from matchset.tracking.tracker import Tracker

STILL = TrackerParameters(moves=False)
LAST = Gate(60.0, 90.0, 26.0)
NEXT = 1.0 / 30.0, 1.0 / 30.0


def seen(x: float = 60.0, parameters: TrackerParameters | None = None) -> Tracker[ms.Circle]:
    """Tracker that has seen a ball of 26 px in one picture."""
    image = picture(x)
    tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(image, x, 90.0), start=(x, 90.0), parameters=parameters)
    assert tracker.update(image)
    return tracker


def sees(disc: Disc, *, confirmed: bool | None = None) -> ExitStack:
    """Have the network see one disc, wherever it is led from; and edge points confirm it, not, or as they do."""
    stack = ExitStack()
    stack.enter_context(patch.object(Judge, "discs", return_value=[disc]))
    stack.enter_context(patch.object(Judge, "seen", return_value=[disc]))
    if confirmed is not None:
        stack.enter_context(patch.object(OutlineChoice, "fit_lost", return_value=confirmed))
    return stack


def belief_of(tracker: Tracker[ms.Circle]) -> Belief:
    assert tracker._ball.belief is not None
    return tracker._ball.belief


@pytest.mark.parametrize(("beyond", "taken"), [(0.1, True), (-0.1, False)])
def test_a_disc_at_a_click_that_is_sure_is_taken_whatever_its_region(beyond: float, taken: bool) -> None:
    image = picture(160.0)
    tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(image, 160, 90), start=(160.0, 90.0))
    disc = Disc((160.0, 90.0, 26.0), np.eye(3), NetworkParameters().sure + beyond)
    with sees(disc, confirmed=False):
        assert tracker._ball.begin(image, tracker.color, ms.Circle(*disc.circle), 0.0) is taken
    assert (tracker._ball.belief is not None) is taken


def asked(away: float, missed: float, sightings: int = 1) -> float:
    """Least log-odds of the network of a ball so far from where it was, so many pictures later; 9 for none."""
    shown = picture(60.0 + away)
    tracker = seen(parameters=STILL)
    for k in range(1, sightings):
        assert tracker.update(picture(60.0, seed=k))
    when = (sightings - 1 + missed) / 30.0, 1.0 / 30.0
    low, high = -9.0, 9.0
    while high - low > 0.1:
        middle = 0.5 * (low + high)
        other = copy.deepcopy(tracker)
        with sees(Disc((60.0 + away, 90.0, 26.0), np.eye(3), middle), confirmed=False):
            found = other._ball.find(shown, other.color, LAST, None, when)
        low, high = (low, middle) if found else (middle, high)
    return high


def test_the_farther_off_the_more_is_asked_and_the_longer_ago_the_less_the_place_says() -> None:
    here, near, far = (asked(away, 1.0, 2) for away in (0.0, 26.0, 150.0))
    assert 0.0 < here < 2.0
    assert here < near < far
    here_later, near_later, far_later = (asked(away, 30.0, 2) for away in (0.0, 26.0, 150.0))
    assert here_later < here + 0.1
    assert near_later < near
    assert far_later < far
    assert here_later <= near_later < far_later


def test_a_ball_whose_motion_is_known_does_not_jump_without_more_proof() -> None:
    assert asked(0.0, 1.0, 6) == pytest.approx(asked(0.0, 1.0), abs=0.5)
    assert asked(150.0, 1.0, 6) == 9.0, "however sure the network is"
    assert asked(150.0, 30.0, 6) < 9.0, "it was gone for long"


@pytest.mark.parametrize(("factor", "possible"), [(1.3, True), (1.0 / 1.3, True), (1.6, False), (1.0 / 1.6, False)])
def test_a_lost_ball_has_about_the_size_that_it_had(factor: float, possible: bool) -> None:
    tracker = seen()
    with sees(Disc((60.0, 90.0, factor * 26.0), np.eye(3), 9.0), confirmed=False):
        assert tracker._ball.find(picture(60.0), tracker.color, LAST, LAST, NEXT) is possible


def test_a_disc_of_another_color_is_not_taken() -> None:
    tracker = seen()
    with sees(Disc((60.0, 90.0, 26.0), np.eye(3), 9.0)):
        assert not tracker._ball.find(picture(250.0), tracker.color, LAST, LAST, NEXT)


def test_edge_points_decide_where_they_confirm_a_disc() -> None:
    tracker = seen()
    with sees(Disc((61.0, 90.0, 26.0), 0.3 * np.eye(3), 3.0)):
        assert tracker._ball.find(picture(60.0), tracker.color, LAST, LAST, NEXT)
    assert not tracker.step.without_outline
    assert tracker.step.fitter.state[:3] == pytest.approx((60.0, 90.0, 26.0), abs=0.7)


def test_edge_points_that_confirm_a_disc_add_to_its_log_odds() -> None:
    weak = asked(0.0, 1.0) - 0.5 * BallSearchParameters().weights.edges
    for confirmed in (True, False):
        tracker = seen(parameters=STILL)
        with sees(Disc((60.0, 90.0, 26.0), np.eye(3), weak), confirmed=confirmed):
            assert tracker._ball.find(picture(60.0), tracker.color, LAST, None, NEXT) is confirmed


def test_the_size_is_that_of_the_last_outline() -> None:
    tracker = seen(160.0)
    assert np.exp(belief_of(tracker).size[0]) == pytest.approx(26.0, abs=0.7)
    for k in range(1, 4):
        assert tracker.update(picture(160.0, seed=k))
    last = Gate(160.0, 90.0, 30.0)
    with sees(Disc((160.0, 90.0, 34.0), np.eye(3), 4.0), confirmed=False):
        assert tracker._ball.find(picture(160.0), tracker.color, last, last, (4.0 / 30.0, 1.0 / 30.0))
        assert np.exp(belief_of(tracker).size[0]) == pytest.approx(30.0)
        assert tracker.step.without_outline  # what was taken since has no say
        tracker._ball.find(picture(160.0), tracker.color, last._replace(half_width=34.0), last, (0.2, 1.0 / 30.0))
    assert np.exp(belief_of(tracker).size[0]) == pytest.approx(30.0)


def test_the_size_does_not_follow_an_outline_faster_than_a_ball_grows() -> None:
    tracker = seen(160.0)
    assert tracker.update(picture(160.0, seed=1))
    before = belief_of(tracker).size[0]
    last = Gate(160.0, 90.0, 60.0)
    with sees(Disc((160.0, 90.0, 26.0), np.eye(3), 4.0), confirmed=False):
        tracker._ball.find(picture(160.0), tracker.color, last, last, (2.0 / 30.0, 1.0 / 30.0))
    assert belief_of(tracker).size[0] - before == pytest.approx(BallSearchParameters().grows)


def test_places_where_no_ball_is_seen_are_noted_and_forgotten_later() -> None:
    tracker = seen()
    places = [(200.0, 50.0, 26.0), (64.0, 90.0, 26.0)]
    where = "matchset.tracking.ball.propose.places_of_color"
    with sees(Disc((60.0, 90.0, 26.0), np.eye(3), -9.0), confirmed=False):
        with patch(where, return_value=places):
            tracker._ball.find(picture(60.0), tracker.color, LAST, None, NEXT)
        assert [each[:2] for each in belief_of(tracker).in_vain] == [(200.0, 50.0)]
        for k in range(BallSearchParameters().again):
            with patch(where, return_value=[]) as asked_for:
                tracker._ball.find(picture(60.0), tracker.color, LAST, None, ((k + 2) / 30.0, 1.0 / 30.0))
            assert (200.0, 50.0, 0.0) in asked_for.call_args.args[4]
        tracker._ball.find(picture(60.0), tracker.color, LAST, None, (0.5, 1.0 / 30.0))
    assert (200.0, 50.0) not in [each[:2] for each in belief_of(tracker).in_vain]


@pytest.mark.parametrize("parts", [2, 3, 4])
@pytest.mark.parametrize("expected", [False, True])
def test_every_part_of_a_large_picture_is_read_for_every_size(expected: bool, parts: int) -> None:
    """A picture of many cells is read in parts by turns; what is near is read beside it in each picture."""
    places = ColorPlaceParameters(cells=1)  # any picture has more
    constants = TrackerConstants(ball=BallSearchParameters(places=places))
    tracker, read = seen(parameters=TrackerParameters(constants=constants)), set[tuple[float, int]]()
    place = LAST if expected else None
    with (
        sees(Disc((60.0, 90.0, 26.0), np.eye(3), -9.0), confirmed=False),
        patch("matchset.tracking.ball.propose.places_of_color", return_value=[]) as asked_for,
    ):
        for _ in range(24):
            asked_for.reset_mock()
            tracker._ball.find(picture(60.0), tracker.color, LAST, place, (1.0 / 30.0, 1.0 / 30.0))
            reaches = [call.args[2][1] for call in asked_for.call_args_list]
            assert min(reaches) < 320.0
            for call in asked_for.call_args_list:
                (circle, reach), turn = call.args[2:4]
                read |= {(round(circle[2], 3), turn % parts)} if reach >= 320.0 else set()
    sizes = 1 if expected else len(BallSearchParameters().spread)
    assert len(read) == sizes * parts, "some parts are never read for some size"


def lost_and_back(back: Picture, gone: Picture) -> list[ms.Track[ms.Circle]]:
    """What is found in 15 pictures once a ball that was seen five times, then gone for five pictures, is back."""
    tracker = seen()
    for k in range(1, 5):
        assert tracker.update(picture(60.0, seed=k))
    for _ in range(5):
        assert not tracker.update(gone)
    answers = [tracker.update(back) for _ in range(15)]
    return [answer for answer in answers if isinstance(answer, ms.Track)]


@pytest.mark.parametrize("x", [60.0, 100.0, 260.0])
def test_a_lost_ball_is_found_where_it_was_and_far_off(x: float) -> None:
    found = lost_and_back(picture(x), picture(-100.0))
    assert len(found) >= 13
    for track in found:
        assert track.shape.state[:3] == pytest.approx((x, 90.0, 26.0), abs=1.5)


@pytest.mark.parametrize("gain", [0.7, 1.25])
def test_a_lost_ball_is_found_in_another_light(gain: float) -> None:
    lit, empty = (np.asarray(np.clip(gain * each, 0, 255), np.uint8) for each in (picture(200.0), picture(-100.0)))
    found = lost_and_back(lit, empty)
    assert len(found) >= 10
    for track in found:
        assert track.shape.state[:3] == pytest.approx((200.0, 90.0, 26.0), abs=1.5)


def test_a_ball_of_another_color_is_not_the_lost_one() -> None:
    red = np.ascontiguousarray(picture(200.0)[:, :, [0, 2, 1]])
    empty = np.ascontiguousarray(picture(-100.0)[:, :, [0, 2, 1]])
    assert np.abs(empty.astype(int) - picture(-100.0)).max() < 40
    assert lost_and_back(red, empty) == []


def test_a_ball_that_was_there_before_is_not_the_lost_one() -> None:
    def two(x: float, seed: int) -> Picture:
        """The ball at x, and another one that rests."""
        return np.concatenate((picture(x, seed=seed)[:, :200], picture(240.0, seed=seed)[:, 200:]), axis=1)

    tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(two(60.0, 0), 60.0, 90.0), start=(60.0, 90.0))
    for k in range(5):
        assert tracker.update(two(60.0, k))
    assert not any(tracker.update(two(-100.0, k)) for k in range(5, 45))
    back = [tracker.update(two(100.0, k)) for k in range(45, 55)]
    found = [answer.shape.x for answer in back if isinstance(answer, ms.Track)]
    assert len(found) >= 8
    assert found == pytest.approx([100.0] * len(found), abs=1.5)
