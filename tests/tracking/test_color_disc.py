"""A ball whose outline no edge confirms is followed as the disc of its color, and nothing else is taken for it."""

import cv2
import msgspec
import numpy as np
import numpy.typing as npt
import pytest

import matchset as ms
from matchset.image.color_learning import ColorParameters
from matchset.image.disc_network.at_click import BallAtClickParameters
from matchset.tracking.motion import Gate
from matchset.tracking.outlines.network_outlines import NetworkParameters
from matchset.tracking.parameters import TrackerParameters
from matchset.tracking.search.color_disc import ColorDiscParameters, ColorDiscs, disc_filter, find_color_disc
from matchset.tracking.search.prominence import Prominence, ProminenceParameters
from matchset.tracking.search.template import TemplateParameters
from matchset.tracking.search.voting import SearchParameters

Picture = npt.NDArray[np.uint8]
Places = tuple[tuple[float, float], ...]
GREEN = (70.0, 150.0, 60.0)
BEGIN, RADIUS = (60.0, 90.0), 12.0
BY_COLOR_ALONE = TrackerParameters(template=TemplateParameters(largest_px=0.0), network=NetworkParameters(used=False))


def picture(balls: Places, blur: float = 1.0, seed: int = 0, other: bool = False) -> Picture:
    """Balls before a gray wall, or in another room, blurred and coded as JPEG."""
    rows, columns = np.indices((180, 320))
    image = np.full((180, 320, 3), (140.0, 140.0, 150.0)) + (columns if other else rows)[:, :, np.newaxis] * 0.3
    for x, y in balls:
        image[np.hypot(columns - x, rows - y) < RADIUS] = GREEN
    soft = cv2.GaussianBlur(image, (0, 0), blur) + np.random.default_rng(seed).normal(0.0, 3.0, image.shape)
    coded = cv2.imencode(".jpg", np.clip(soft, 0, 255).astype(np.uint8), (cv2.IMWRITE_JPEG_QUALITY, 12))[1]
    return np.asarray(cv2.imdecode(coded, cv2.IMREAD_COLOR), np.uint8)


def place(frame: int) -> tuple[float, float]:
    return BEGIN[0] + 5.0 * frame, BEGIN[1] + 12.0 * float(np.sin(0.3 * frame))


def follow(pictures: list[Picture], parameters: TrackerParameters = BY_COLOR_ALONE) -> list[ms.Track[ms.Circle] | None]:
    color = ms.ColorModel.pick(pictures[0], *BEGIN, ColorParameters(ball=BallAtClickParameters(used=False)))
    tracker = ms.Tracker(ms.Circle, color, start=BEGIN, parameters=parameters)
    answers = [tracker.update(image) for image in pictures]
    return [answer if isinstance(answer, ms.Track) else None for answer in answers]


def off(answer: ms.Track[ms.Circle] | None, at: tuple[float, float]) -> float:
    return 99.0 if answer is None else float(np.hypot(answer.shape.x - at[0], answer.shape.y - at[1]))


def test_a_ball_that_is_all_blur_is_followed_by_its_color() -> None:
    shown = [picture((place(k),), 1.0 if k < 4 else 6.0, k) for k in range(24)]
    answers = follow(shown)
    assert max(off(answer, place(k)) for k, answer in enumerate(answers) if answer) < 5.0
    outline_alone = msgspec.structs.replace(BY_COLOR_ALONE, color_disc=ColorDiscParameters(least=9.0))
    unaided = follow(shown, outline_alone)
    assert unaided.count(None) > 12
    assert answers.count(None) <= unaided.count(None) // 2
    assert off(answers[-1], place(23)) < 5.0


def test_the_uncertainty_of_a_disc_is_told() -> None:
    answers = follow([picture((place(k),), 1.0 if k < 4 else 6.0, k) for k in range(24)])
    covariances = [answer.covariance for answer in answers if answer]
    largest = max(float(np.sqrt(covariance[0, 0])) for covariance in covariances)
    assert largest == pytest.approx(ColorDiscParameters().sigma * RADIUS, rel=0.3)
    assert all(np.all(np.linalg.eigvalsh(covariance) > 0.0) for covariance in covariances)


def test_nothing_is_taken_where_the_ball_has_left() -> None:
    here = [picture((BEGIN,), 1.0, k) for k in range(3)]
    assert not any(follow([*here, *(picture((), 1.0, k) for k in range(10))])[3:])


@pytest.mark.parametrize("other", [False, True])
def test_a_rival_that_stays_in_its_place_does_not_hide_the_ball_but_another_room_does(other: bool) -> None:
    rival, again = (250.0, 40.0), (200.0, 140.0)
    here = [picture((BEGIN, rival), 1.0, k) for k in range(3)]
    gone = [picture((rival,), 1.0, k) for k in range(15)]
    back = [picture((again, rival), 3.5, k, other) for k in range(3)]
    answers = follow([*here, *gone, *back])
    assert not any(answers[3:18])
    assert (off(answers[-1], again) < 5.0) is not other


def test_a_rival_that_has_moved_is_not_taken() -> None:
    here = [picture((BEGIN, (250.0, 40.0)), 1.0, k) for k in range(3)]
    gone = [picture(((250.0, 40.0),), 1.0, k) for k in range(15)]
    assert not any(follow([*here, *gone, *(picture(((200.0, 140.0),), 3.5, k) for k in range(3))])[3:])


def test_a_disc_is_found_to_a_cell_and_its_step_is_that_of_its_color() -> None:
    image, limits = picture((BEGIN,), 0.5), ColorDiscParameters()
    color = ms.ColorModel.pick(image, *BEGIN)
    found = find_color_disc(image, color, Gate(BEGIN[0] + 5.0, BEGIN[1] - 4.0, 1.1 * RADIUS), 1.2, limits)
    assert found is not None
    assert np.hypot(found.x - BEGIN[0], found.y - BEGIN[1]) < 2.0
    assert found.half_width == pytest.approx(RADIUS, rel=0.12)
    assert found.step > 1.0 > found.rival + 0.5
    assert find_color_disc(image, color, Gate(-90.0, 20.0, RADIUS), 1.2, limits) is None


def test_what_was_never_measured_and_what_the_border_cuts_is_no_disc() -> None:
    image, cut = picture((BEGIN,)), picture(((4.0, 90.0),))
    color, prominence = ms.ColorModel.pick(image, *BEGIN), Prominence(ProminenceParameters(), SearchParameters())
    discs = ColorDiscs(ColorDiscParameters(), prominence)
    here = Gate(*BEGIN, RADIUS)
    assert discs.find(image, color, here, 1.0) is None
    assert discs.find_anywhere(image, color, RADIUS) is None
    discs.measure(image, color, here)
    assert discs.find(image, color, here, 1.0) is not None
    assert discs.find(cut, color, Gate(8.0, 90.0, RADIUS), 1.0) is None


def test_the_filter_of_a_disc_is_a_difference_of_two_means() -> None:
    kernel = disc_filter(6.0, 1.3)
    assert float(kernel.sum()) == pytest.approx(0.0, abs=1e-5)
    assert float(kernel[kernel > 0.0].sum()) == pytest.approx(1.0, abs=0.15)
