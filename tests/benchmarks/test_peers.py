import math
from collections.abc import Callable

import cv2
import numpy as np
import pytest
from benchmarks.common import contour
from benchmarks.common.region import around_the_last
from benchmarks.common.start import Circle3, Image, Start
from benchmarks.common.target_color import bgr_mask, bgr_range, hsv_mask, hsv_range, looks_right
from benchmarks.contest.field import NEEDS_WORDS, PEERS, TAGS, missing, peer
from benchmarks.contest.run import follow_with_all
from benchmarks.peers import PARAMETERS, stored
from benchmarks.peers.tags import APRIL, ARUCO, Card
from benchmarks.tracking.trial import sequence

BLUE = (200, 60, 30)


def disc(x: float, y: float, radius: float) -> Image:
    rows, columns = np.indices((240, 320))
    inside = np.clip(radius + 0.5 - np.hypot(columns - x, rows - y), 0.0, 1.0)[..., np.newaxis]
    return np.asarray(np.rint(90.0 * (1.0 - inside) + inside * np.array(BLUE)), np.uint8)


START = Start(disc(120.0, 100.0, 40.0), (120.0, 100.0, 40.0))
WITH_OPENCV = ("hobby", "contour_moments", "contour_ellipse", "region_moments", "region_ellipse", "region_bgr")


@pytest.mark.parametrize("key", [*WITH_OPENCV, "simple_blob", "paper", "cam_shift"])
def test_a_peer_follows_a_clean_disc(key: str) -> None:
    one = peer(key)
    step = one.start(START, type(one.parameters)())
    errors = []
    for k in range(1, 7):
        answer = step(disc(120.0 + 3.0 * k, 100.0 + 2.0 * k, 40.0))
        assert answer is not None
        errors.append(sum(np.abs(np.subtract(answer, (120.0 + 3.0 * k, 100.0 + 2.0 * k, 40.0)))))
    assert np.median(errors) < (8.0 if key in ("paper", "cam_shift") else 2.5)


def test_every_peer_has_what_the_tables_need() -> None:
    for key in (*PEERS, *TAGS):
        if not missing(key):
            one = peer(key)
            assert one.name
            assert one.needs in NEEDS_WORDS
            fields = type(one.parameters).__struct_fields__
            assert set(one.choices) <= set(fields)


def test_stored_parameters_are_those_of_peers() -> None:
    assert PARAMETERS.exists()
    assert set(stored()) <= {*PEERS, *TAGS}


def test_the_color_is_that_of_the_disc() -> None:
    for mask in (
        hsv_mask(START.image, hsv_range(START, 12, 0.5, 0.5), 3),
        bgr_mask(START.image, bgr_range(START, 0.6, 40), 0),
    ):
        assert mask[100, 120] == 255
        assert mask[20, 20] == 0
        assert abs(np.count_nonzero(mask) / (math.pi * 40.0**2) - 1.0) < 0.05


def test_a_candidate_of_another_color_is_refused() -> None:
    bounds = hsv_range(START, 12, 0.5, 0.5)
    assert looks_right(START.image, (120.0, 100.0, 40.0), bounds)
    assert not looks_right(START.image, (220.0, 160.0, 40.0), bounds)
    assert not looks_right(START.image, (320.0, 240.0, 40.0), bounds)


@pytest.mark.parametrize("find", [contour.moments, contour.ellipse, contour.enclosing])
def test_contours_count_whole_pixels(find: Callable[[Image], Circle3 | None]) -> None:
    mask = np.zeros((200, 200), np.uint8)
    cv2.circle(mask, (90, 110), 50, 255, -1)
    answer = find(mask)
    assert answer is not None
    assert answer == pytest.approx((90.0, 110.0, 50.5), abs=0.8)
    assert find(np.zeros_like(mask)) is None


def test_a_region_is_left_when_nothing_is_in_it() -> None:
    sizes = []

    def find(image: Image) -> Circle3 | None:
        sizes.append(image.shape[1])
        return None if len(sizes) == 2 else (5.0, 6.0, 4.0)

    step = around_the_last(find, START, 1.0, 10.0)
    image = np.zeros((240, 320, 3), np.uint8)
    first = step(image)
    assert first == (5.0 + 70.0, 6.0 + 50.0, 4.0)  # the corner of the region is added
    assert step(image) == (5.0, 6.0, 4.0)  # nothing in the region, so the whole frame
    assert sizes == [101, 29, 320]


@pytest.mark.parametrize("card", [APRIL, ARUCO])
def test_the_circle_of_a_card_is_inscribed_in_it(card: Card) -> None:
    cells = card.cells
    picture = card.picture(40 * (cells + 2))
    side = picture.shape[0]
    cell = side / (cells + 2)
    corners = [[cell, cell], [side - cell, cell], [side - cell, side - cell], [cell, side - cell]]
    assert card.circle(corners) == pytest.approx((side / 2.0, side / 2.0, side / 2.0))
    assert picture[0].min() == 255
    assert picture[int(1.5 * cell), int(1.5 * cell)] == 0


def test_nobody_learns_more_of_the_truth_than_the_first_frame() -> None:
    told = []

    def follow(start: Start, parameters: object) -> Callable[[Image], None]:
        told.append(start)
        return lambda _: None

    from benchmarks.contest.field import Peer

    blind = Peer("blind", "blind", "circle", None, {}, follow)
    trial = follow_with_all(iter(sequence("clean", 3, 4)), None, [blind], 3)["blind"]
    assert len(told) == 1
    assert trial.answers == [None, None, None]
    assert [truth.frame for truth in trial.truths] == [1, 2, 3]
