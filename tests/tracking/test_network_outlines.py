"""When the network of discs is believed, and what it changes in a track."""

import copy
import math
from unittest.mock import patch

import cv2
import numpy as np
import numpy.typing as npt
import pytest
from hidden_ball import Picture, picture

import matchset as ms
from matchset.fitting.soft_region import SoftRegion
from matchset.fitting.validation import ValidationParameters
from matchset.image.circle_score import Sample
from matchset.image.color_learning import ColorParameters
from matchset.image.disc_network.click_discs import BallAtClickParameters
from matchset.image.disc_network.network import Disc, DiscNetwork
from matchset.image.disc_network.polar_patch import colors_of
from matchset.tracking.ball.disc_detector import DiscDetector, DiscDetectorParameters
from matchset.tracking.ball.discs import middle_pixels
from matchset.tracking.ball.judge import (
    Judge,
    NetworkParameters,
    covariance_of,
    likeliest,
    squared_distances,
)
from matchset.tracking.compiled_step import tracking_fitter
from matchset.tracking.constants import TrackerConstants
from matchset.tracking.parameters import TrackerParameters
from matchset.tracking.track_step import TrackStep

PRECISION = np.array(((1.0, 0.2, 0.1), (0.2, 0.8, 0.0), (0.1, 0.0, 0.5)))
DISC = Disc((50.0, 40.0, 12.0), PRECISION, 3.0)


def test_distances_and_the_likeliest_disc() -> None:
    apart = np.array((1.0, -2.0, 3.0))
    assert float(squared_distances(DISC, np.array(DISC.circle) + apart)) == pytest.approx(apart @ PRECISION @ apart)
    assert covariance_of(DISC) @ PRECISION == pytest.approx(np.eye(3), abs=1e-12)
    weak = DISC._replace(log_odds=1.0)
    best = likeliest([weak, DISC], 2.0, 0.5)
    assert best is not None
    assert best.circle == pytest.approx(DISC.circle)
    assert best.log_odds == DISC.log_odds
    assert likeliest([weak], 2.0, 0.5) is None
    assert likeliest([], 2.0, 0.5) is None


@pytest.mark.parametrize("circle", [(20.0, 15.0, 9.0), (2.0, 1.0, 9.0), (39.0, 29.0, 6.0), (-50.0, 10.0, 5.0)])
def test_the_middle_of_a_disc_is_what_lies_within_a_share_of_its_radius(circle: tuple[float, float, float]) -> None:
    image = np.arange(30 * 40 * 3, dtype=np.int64).reshape(30, 40, 3).astype(np.uint8)
    rows, columns = np.indices(image.shape[:2])
    inside = np.hypot(columns - circle[0], rows - circle[1]) <= 0.7 * circle[2] + 0.71  # they are rounded
    expected = {tuple(pixel) for pixel in image[inside].tolist()}
    found = [tuple(pixel) for pixel in middle_pixels(image, circle, 0.7).tolist()]
    assert set(found) <= expected
    assert bool(found) is bool(expected)


def test_two_measurements_of_a_circle_are_weighed_by_their_inverse_covariances() -> None:
    limits, circle, sigma = NetworkParameters(), (54.0, 38.0, 13.0), 2.0
    found = Judge(limits).weighed(DISC, circle, sigma)
    ours, other = limits.inflation * covariance_of(DISC), sigma**2 * np.eye(3)
    gain = ours @ np.linalg.inv(ours + other)  # Kalman's
    assert found.circle == pytest.approx(np.array(DISC.circle) + gain @ np.subtract(circle, DISC.circle))
    assert covariance_of(found) == pytest.approx((np.eye(3) - gain) @ ours)
    assert found.log_odds == DISC.log_odds


@pytest.mark.parametrize(("off", "counts"), [(9.0, True), (30.0, False)])
def test_a_measurement_that_is_of_something_else_does_not_count(off: float, counts: bool) -> None:
    found = Judge(NetworkParameters()).weighed(DISC, (DISC.circle[0] + off, *DISC.circle[1:]), 2.0)
    assert (found is not DISC) is counts


def test_a_region_that_is_less_sure_counts_less() -> None:
    image, disc = streak(40.0), Disc((166.0, 90.0, 26.0), np.diag((0.5, 0.5, 0.5)), 4.0)
    tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(image, 160.0, 90.0), start=(160.0, 90.0), fps=30.0)
    tracker.update(image)
    outlines = tracker.step.outlines
    moved = []
    for share in (1.0, 0.6):
        with patch.object(SoftRegion, "worth", lambda _, limits, share=share: share * limits.worth):
            moved.append(166.0 - outlines._with_region(image, disc, np.array(disc.circle)).circle[0])
    assert moved[0] > 1.3 * moved[1] > 0.0


def streak(length: float) -> Picture:
    """A dark ball before a wall, r = 26 at (160, 90), that moves while the picture is taken."""
    rows, columns = np.indices((180, 320), np.float64)
    shares = [
        np.clip(26.5 - np.hypot(columns - 160.0 - along, rows - 90.0), 0.0, 1.0)
        for along in np.linspace(-0.5 * length, 0.5 * length, 65)
    ]
    share = np.mean(shares, axis=0)[..., np.newaxis]
    image = np.array((150.0, 155.0, 165.0)) * (1.0 - share) + np.array((60.0, 110.0, 60.0)) * share
    noisy = cv2.GaussianBlur(image, (0, 0), 2.5) + np.random.default_rng(0).normal(0.0, 2.0, image.shape)
    return np.asarray(np.clip(noisy, 0, 255), np.uint8)


@pytest.mark.parametrize(("length", "weighed"), [(40.0, True), (0.0, False)])
def test_the_region_of_a_streak_is_weighed_with_the_disc(length: float, weighed: bool) -> None:
    image = streak(length)
    tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(image, 160.0, 90.0), start=(160.0, 90.0), fps=30.0)
    tracker.update(image)
    disc = Disc((166.0, 90.0, 26.0), np.diag((0.05, 0.5, 0.5)), 4.0)
    found = tracker.step.outlines._with_region(image, disc, np.array(disc.circle))
    assert (found is not disc) is weighed
    if weighed:
        assert found.circle[:2] == pytest.approx((160.0, 90.0), abs=0.5)
        assert 26.0 < found.circle[2] < 1.1 * 26.0  # up to a tenth too large


def test_the_color_of_a_disc_is_compared() -> None:
    image, outlines = picture(100.0), Judge(NetworkParameters())
    color = ms.ColorModel.pick(image, 100.0, 90.0)
    assert outlines.has_color(image, color, (100.0, 90.0, 26.0))
    assert not outlines.has_color(image, color, (200.0, 90.0, 26.0))
    assert not outlines.has_color(image, color, (900.0, 90.0, 26.0))


def test_discs_are_in_the_picture_and_near_to_where_they_began() -> None:
    image, outlines = picture(100.0), Judge(NetworkParameters())
    (disc,) = outlines.discs(image, [np.array((104.0, 88.0, 24.0))])
    assert np.abs(np.subtract(disc.circle, (100.0, 90.0, 26.0))).sum() < 3.0
    (gray,) = outlines.discs(np.ascontiguousarray(image[:, :, 2:]), [np.array((104.0, 88.0, 24.0))])
    assert np.abs(np.subtract(gray.circle, (100.0, 90.0, 26.0))).sum() < 3.0
    assert Judge(NetworkParameters(used=False)).discs(image, [np.array((104.0, 88.0, 24.0))]) == []
    cut = np.ascontiguousarray(image[:, 112:])
    assert outlines.discs(cut, [np.array((-12.0, 90.0, 26.0))]) == []


def colors_asked(network: Judge, image: Picture) -> npt.NDArray[np.float32]:
    """Colors that the network is told to look for; none of them where it is told nothing."""
    network.begin_picture()
    with patch.object(DiscNetwork, "lead", return_value=([None], 1)) as lead:
        network.discs(image, [np.array((160.0, 90.0, 26.0))])
    known = lead.call_args.args[3]
    return np.empty(0, np.float32) if known is None else np.asarray(known, np.float32)


def colors_in(image: Picture, circle: tuple[float, float, float]) -> npt.NDArray[np.float32]:
    """Colors of a circle that is in the picture."""
    colors = colors_of(image, circle)
    assert colors is not None
    return colors


def test_the_colors_of_the_target_are_known_from_another_picture_and_in_another_light() -> None:
    network, image, ball = Judge(NetworkParameters()), picture(160.0), (160.0, 90.0, 26.0)
    assert not colors_asked(network, image).size
    network.relight(np.ones(3))  # of nothing
    assert not colors_asked(network, image).size
    network.know(Sample(image, ball, ball[2]))
    assert np.array_equal(colors_asked(network, image), colors_in(image, ball))
    gains = np.array((0.8, 1.1, 0.9))
    network.relight(gains)
    relit = np.asarray(np.clip(np.rint(image * gains), 0.0, 255.0), np.uint8)
    assert np.array_equal(colors_asked(network, image), colors_in(relit, ball))
    network.relight(np.array((1.25, 2.0, 1.5)))  # brighter than can be told
    network.relight(1.0 / (gains * np.array((1.25, 2.0, 1.5))))
    assert np.array_equal(colors_asked(network, image), colors_in(image, ball))
    network.know(None)
    assert not colors_asked(network, image).size


def test_of_a_gray_picture_the_levels_are_known() -> None:
    network, gray, ball = Judge(NetworkParameters()), picture(160.0)[..., :1], (160.0, 90.0, 26.0)
    network.know(Sample(gray, ball, ball[2]))
    assert np.array_equal(colors_asked(network, gray), colors_in(gray, ball))
    network.relight(np.array((0.8,)))
    relit = np.asarray(np.rint(gray * 0.8), np.uint8)
    assert np.array_equal(colors_asked(network, gray), colors_in(relit, ball))


def test_colors_are_kept_while_the_network_is_not_asked() -> None:
    network = Judge(NetworkParameters(used=False))
    image = picture(160.0)
    ball = (160.0, 90.0, 26.0)
    network.know(Sample(image, ball, ball[2]))
    network.limits = NetworkParameters()
    assert np.array_equal(colors_asked(network, image), colors_in(image, ball))


def test_a_tracker_knows_the_colors_that_were_clicked_and_after_a_restart_too() -> None:
    image = picture(160.0)
    color = ms.ColorModel.pick(image, 160, 90)
    assert color.sample is not None
    tracker = ms.Tracker(ms.Circle, color, start=(160.0, 90.0))
    expected = colors_in(color.sample.image, color.sample.circle)
    assert np.array_equal(colors_asked(tracker.step.outlines.network, image), expected)
    tracker.update(image)
    tracker._ball.relight(np.array((0.5, 1.0, 1.5)))
    assert not np.array_equal(colors_asked(tracker.step.outlines.network, image), expected)
    tracker.restart((160.0, 90.0))
    assert np.array_equal(colors_asked(tracker.step.outlines.network, image), expected)


def test_a_tracker_that_did_not_ask_the_network_asks_it_after_a_restart_and_knows_the_colors() -> None:
    image = picture(160.0)
    color = ms.ColorModel.pick(image, 160, 90)
    assert color.sample is not None
    tracker = ms.Tracker(ms.Circle, color)
    tracker.step.crowded = True
    tracker.update(image)
    tracker.restart()
    assert tracker.step.outlines.network.limits.used
    expected = colors_in(color.sample.image, color.sample.circle)
    assert np.array_equal(colors_asked(tracker.step.outlines.network, image), expected)


def test_a_tracker_whose_parameters_say_so_does_not_ask_the_network_after_a_restart_either() -> None:
    image = picture(160.0)
    parameters = TrackerParameters(asks_network=False)
    tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(image, 160, 90), parameters=parameters)
    tracker.restart()
    assert not tracker.step.outlines.network.limits.used


def test_a_search_knows_the_colors_that_were_clicked() -> None:
    image = picture(160.0)
    color = ms.ColorModel.pick(image, 160, 90)
    with patch.object(Judge, "know", autospec=True) as know:
        DiscDetector(tracking_fitter(ms.Circle, 64), color, DiscDetectorParameters())
    assert color.sample is not None
    assert know.call_args.args[1] is color.sample


def test_a_shaded_ball_as_bright_as_the_wall_is_followed_in_gray_pictures() -> None:
    shown = [np.ascontiguousarray(picture(60.0 + 3.0 * k, 0.0 if k < 5 else 12.0, k)[..., 1]) for k in range(25)]
    tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(shown[0], 60.0, 90.0), start=(60.0, 90.0), fps=30.0)
    for k, answer in enumerate(map(tracker.update, shown)):
        assert isinstance(answer, ms.Track)
        found = answer.shape.x, answer.shape.y, answer.shape.radius
        assert np.abs(np.subtract(found, (60.0 + 3.0 * k, 90.0, 26.0))).sum() < 5.0


def test_a_ball_that_a_hand_hides_step_by_step_keeps_its_outline() -> None:
    shown = [(60.0 + 3.0 * k, 0.0 if k < 5 else 12.0) for k in range(25)]
    errors = {}
    for used in (True, False):
        color = ms.ColorModel.pick(picture(60.0), 60.0, 90.0, ColorParameters(ball=BallAtClickParameters(used=used)))
        parameters = TrackerParameters(asks_network=used)
        tracker = ms.Tracker(ms.Circle, color, start=(60.0, 90.0), parameters=parameters, fps=30.0)
        answers = [(x, tracker.update(picture(x, hidden, k))) for k, (x, hidden) in enumerate(shown)]
        errors[used] = [
            abs(a.shape.x - x) + abs(a.shape.y - 90.0) + abs(a.shape.radius - 26.0) if isinstance(a, ms.Track) else 99.0
            for x, a in answers
        ]
    assert max(errors[True]) < 4.0
    assert float(np.mean(errors[True])) <= float(np.mean(errors[False])) + 0.2


def followed(moved: float, known: float, log_odds: float) -> tuple[float, bool]:
    """Where an ambiguous ball is, beside the truth along x, if the network sees it moved; whether others were tried.

    `known` is the inverse variance of each number that it says; the others are the hypotheses around the fit.
    """
    color, always = ms.ColorModel.pick(picture(60.0), 60.0, 90.0), 2.0
    constants = TrackerConstants(
        validation=ValidationParameters(ambiguous_msac_score=always), network=NetworkParameters(sharp=always)
    )
    parameters = TrackerParameters(constants=constants)
    tracker = ms.Tracker(ms.Circle, color, start=(60.0, 90.0), parameters=parameters, fps=30.0)
    for k in range(6):
        tracker.update(picture(60.0 + 3.0 * k, 12.0 if k > 3 else 0.0, k))
    disc = Disc((78.0 + moved, 90.0, 26.0), known * np.eye(3), log_odds)
    with (
        patch.object(Judge, "discs", return_value=[disc]),
        patch.object(TrackStep, "_test_hypotheses", autospec=True, side_effect=TrackStep._test_hypotheses) as tested,
    ):
        answer = tracker.update(picture(78.0, 12.0, 6))
    assert isinstance(answer, ms.Track)
    return answer.shape.x - 78.0, tested.called


def test_a_disc_that_is_sure_is_the_prior_of_an_ambiguous_fit() -> None:
    vague, weighed, sure = (followed(0.8, known, 4.0)[0] for known in (1e-3, 30.0, 1e4))
    assert abs(vague) < 0.3
    assert vague < weighed < sure
    assert sure == pytest.approx(0.8, abs=0.1)


def test_the_network_alone_tells_which_outline_is_the_balls() -> None:
    for log_odds in (-4.0, 0.0, 4.0):
        assert not followed(0.0, 1.0, log_odds)[1], "no hypotheses beside it"


def test_a_picture_costs_no_more_than_its_looks_and_nothing_is_looked_at_twice() -> None:
    image, ball = picture(160.0), np.array((160.0, 90.0, 26.0))
    outlines = Judge(NetworkParameters(looks=7))
    starts = [ball + k * np.array((3.0, 2.0, 0.5)) for k in range(-2, 3)]
    with patch.object(DiscNetwork, "lead", autospec=True, side_effect=DiscNetwork.lead) as lead:
        first = outlines.discs(image, starts)
        assert outlines.left == 0
        again, other = outlines.discs(image, starts), outlines.discs(image, [ball + np.array((0.0, 1.0, 0.0))])
    assert [len(call.args[2]) for call in lead.call_args_list] == [5, 0, 1]
    assert [disc.circle for disc in first] == [disc.circle for disc in again]
    assert first
    assert other == []
    outlines.begin_picture()
    assert outlines.left == 7
    assert outlines.discs(image, [ball + np.array((0.0, 1.0, 0.0))])


def test_copies_of_a_tracker_go_on_alike() -> None:
    tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(picture(60.0), 60.0, 90.0), start=(60.0, 90.0), fps=30.0)
    for k in range(6):
        tracker.update(picture(60.0 + 3.0 * k, 12.0 if k > 3 else 0.0, k))
    other = copy.deepcopy(tracker)
    one, two = (each.update(picture(78.0, 12.0, 6)) for each in (tracker, other))
    assert isinstance(one, ms.Track)
    assert isinstance(two, ms.Track)
    assert one.shape == two.shape
    assert math.isfinite(one.shape.x)
