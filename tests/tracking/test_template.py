"""A small ball that stands out from an even background is followed by its looks, for a while, and nothing else is."""

import cv2
import numpy as np
import numpy.typing as npt
import pytest

import matchset as ms
from matchset.tracking.motion import Gate
from matchset.tracking.outlines.network_outlines import NetworkParameters
from matchset.tracking.parameters import TrackerParameters
from matchset.tracking.search.color_disc import ColorDiscParameters
from matchset.tracking.search.template import Template, TemplateParameters

Picture = npt.NDArray[np.uint8]
BEGIN, RADIUS = (60.0, 90.0), 9.0
FPS = 30.0
NO_COLOR = ColorDiscParameters(least=9.0)
NO_NETWORK = NetworkParameters(used=False)
BY_LOOKS = TrackerParameters(color_disc=NO_COLOR, network=NO_NETWORK)
NEVER = TrackerParameters(color_disc=NO_COLOR, network=NO_NETWORK, template=TemplateParameters(largest_px=0.0))


def picture(ball: tuple[float, float] | None, blur: float = 1.0, seed: int = 0, clutter: float = 0.0) -> Picture:
    """A dim ball before a gray wall, or before clutter, blurred, with noise."""
    rows, columns = np.indices((180, 320))
    image = np.full((180, 320, 3), (150.0, 150.0, 155.0)) + rows[:, :, np.newaxis] * 0.1
    if clutter:
        spots = np.random.default_rng(99).normal(0.0, 1.0, (180, 320, 3))
        image += clutter * cv2.GaussianBlur(spots, (0, 0), 2.0) / 0.14
    if ball is not None:
        image[np.hypot(columns - ball[0], rows - ball[1]) < RADIUS] = (95.0, 110.0, 95.0)
    soft = cv2.GaussianBlur(image, (0, 0), blur) + np.random.default_rng(seed).normal(0.0, 2.0, image.shape)
    return np.asarray(np.clip(soft, 0, 255), np.uint8)


def place(frame: int) -> tuple[float, float]:
    return BEGIN[0] + 5.0 * frame, BEGIN[1] + 12.0 * float(np.sin(0.3 * frame))


def follow(pictures: list[Picture], parameters: TrackerParameters) -> list[ms.Track[ms.Circle] | ms.Lost[ms.Circle]]:
    tracker = ms.Tracker(
        ms.Circle, ms.ColorModel.pick(pictures[0], *BEGIN), start=BEGIN, parameters=parameters, fps=FPS
    )
    return [tracker.update(image) for image in pictures]


def learned(image: Picture, limits: TemplateParameters | None = None) -> Template:
    template = Template(limits or TemplateParameters())
    template.learn(image, Gate(*BEGIN, RADIUS), 0.0)
    return template


def test_a_ball_that_is_all_blur_is_followed_by_its_looks_and_says_how_well() -> None:
    shown = [picture(place(k), 1.0 if k < 4 else min(float(k), 7.0), k) for k in range(24)]
    answers, unaided = follow(shown, BY_LOOKS), follow(shown, NEVER)
    lost = [sum(isinstance(each, ms.Lost) for each in every) for every in (answers, unaided)]
    assert lost[0] == 0 < 8 < lost[1]
    for k, answer in enumerate(answers):
        if isinstance(answer, ms.Track):
            assert np.hypot(answer.shape.x - place(k)[0], answer.shape.y - place(k)[1]) < 5.0
            assert np.all(np.linalg.eigvalsh(answer.covariance) > 0.0)


@pytest.mark.parametrize("offset", [(0.0, 0.0), (11.0, -7.0), (-4.0, 15.0)])
@pytest.mark.parametrize("channels", [1, 3])
def test_the_place_is_found_to_a_cell(offset: tuple[float, float], channels: int) -> None:
    at = BEGIN[0] + offset[0], BEGIN[1] + offset[1]
    before, now = (np.ascontiguousarray(picture(each, 1.0, 1)[:, :, :channels]) for each in (BEGIN, at))
    found = learned(before).find(now, Gate(*BEGIN, RADIUS), 2.0, 0.1)
    assert found is not None
    assert np.hypot(found.x - at[0], found.y - at[1]) < 2.6 * RADIUS / 16
    assert found.half_width == pytest.approx(RADIUS, rel=0.08)
    assert found.correlation > 0.9 > found.rival


def test_what_does_not_stand_out_is_no_template() -> None:
    here = Gate(*BEGIN, RADIUS)
    assert learned(picture(BEGIN, clutter=1.0)).find(picture(BEGIN, seed=1), here, 1.0, 0.1) is not None
    assert learned(picture(BEGIN, clutter=40.0)).find(picture(BEGIN, seed=1, clutter=40.0), here, 1.0, 0.1) is None
    assert learned(picture(None)).find(picture(None, seed=1), here, 1.0, 0.1) is None


def test_it_is_found_for_a_limited_time_where_it_is_whole_and_small() -> None:
    limits, here = TemplateParameters(longest=0.5), Gate(*BEGIN, RADIUS)
    shown = picture(BEGIN, seed=1)
    assert learned(shown, limits).find(shown, here, 1.0, 0.4) is not None
    assert learned(shown, limits).find(shown, here, 1.0, 0.6) is None
    assert learned(shown).find(shown, here._replace(half_width=25.0), 1.0, 0.1) is None
    assert learned(shown).find(picture((5.0, 90.0)), Gate(9.0, 90.0, RADIUS), 1.0, 0.1) is None
    assert Template(limits).find(shown, here, 1.0, 0.1) is None
    forgotten = learned(shown)
    forgotten.forget()
    assert forgotten.find(shown, here, 1.0, 0.1) is None


def test_nothing_is_taken_where_the_ball_has_left_or_a_twin_is_beside_it() -> None:
    template, here = learned(picture(BEGIN)), Gate(*BEGIN, RADIUS)
    assert template.find(picture(None, seed=1), here, 1.0, 0.1) is None
    twin = np.minimum(picture(BEGIN, seed=1), picture((BEGIN[0] + 22.0, BEGIN[1]), seed=2))
    assert template.find(twin, here._replace(x=BEGIN[0] + 11.0), 2.0, 0.1) is None


def test_a_click_on_a_ball_that_no_edge_confirms_begins() -> None:
    shown = [picture(place(k), 7.0, k) for k in range(8)]
    assert not any(isinstance(each, ms.Track) for each in follow(shown, NEVER))
    for k, answer in enumerate(follow(shown, BY_LOOKS)):
        assert isinstance(answer, ms.Track)
        assert np.hypot(answer.shape.x - place(k)[0], answer.shape.y - place(k)[1]) < 0.3 * RADIUS
