"""A lost ball is known again where it alone has its color, and nothing that was beside it is taken for it."""

import cv2
import numpy as np
import numpy.typing as npt
import pytest
from matchset.tracking.search.prominence import Prominence, ProminenceParameters

import matchset as ms
from matchset.tracking.motion import Gate
from matchset.tracking.parameters import TrackerParameters
from matchset.tracking.search.blobs import color_steps
from matchset.tracking.search.voting import Searcher, SearchParameters

Picture = npt.NDArray[np.uint8]
YELLOW = (40.0, 190.0, 220.0)
FIRST, AGAIN = (80.0, 90.0), (240.0, 100.0)


def picture(
    ball: tuple[float, float] | None,
    radius: float = 16.0,
    decoys: tuple[tuple[float, float], ...] = (),
    cut: float = 0.4,
) -> Picture:
    """A ball whose lower part is hidden in front of leaves, and decoys as large as it; all coded as JPEG."""
    rows, columns = np.indices((180, 320))
    image = np.random.default_rng(5).normal((60.0, 80.0, 50.0), 14.0, (180, 320, 3))
    for x, y in (*decoys, *([ball] if ball else [])):
        image[(np.hypot(columns - x, rows - y) < radius) & (rows < y + cut * radius)] = YELLOW
    soft = cv2.GaussianBlur(np.clip(image, 0, 255).astype(np.uint8), (0, 0), 1.6)
    return np.asarray(cv2.imdecode(cv2.imencode(".jpg", soft, (cv2.IMWRITE_JPEG_QUALITY, 15))[1], 1), np.uint8)


def follow(
    parameters: TrackerParameters | None, decoys: tuple[tuple[float, float], ...] = (), **again: float
) -> list[ms.Track[ms.Circle] | ms.Lost[ms.Circle]]:
    """Answers for three frames of a ball, twenty without it, and three where it is far from there."""
    first = picture(FIRST, decoys=decoys)
    tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(first, *FIRST), start=FIRST, parameters=parameters)
    shown = [*[first] * 3, *[picture(None, decoys=decoys)] * 20, *[picture(AGAIN, decoys=decoys, **again)] * 3]
    return [tracker.update(image) for image in shown]


def found(answer: ms.Track[ms.Circle] | ms.Lost[ms.Circle]) -> bool:
    return isinstance(answer, ms.Track) and bool(np.hypot(answer.shape.x - AGAIN[0], answer.shape.y - AGAIN[1]) < 4.0)


def test_a_ball_alone_with_its_color_is_found_again_anywhere() -> None:
    answers = follow(None)
    assert all(answers[:3])
    assert not any(answers[3:23])
    assert found(answers[-1])
    unaided = follow(TrackerParameters(prominence=ProminenceParameters(lead=9.0)))
    assert not any(unaided[3:])  # its outline says too little


def test_what_was_beside_the_ball_when_it_was_seen_is_not_taken_for_it() -> None:
    assert not any(follow(None, decoys=((250.0, 60.0),))[3:23])


def test_another_size_is_another_thing() -> None:
    assert not any(follow(None, radius=28.0)[3:])


def test_color_steps_are_those_of_sums_over_squares() -> None:
    grid = np.random.default_rng(2).integers(-254, 255, (24, 30)).astype(np.int16)
    ((radius, steps),) = color_steps(grid, [3.0, 20.0])  # the second does not fit
    assert radius == 3.0
    white, (row, column), inner, outer = grid / 254.0, (12, 14), 2, 5
    within = white[row - inner : row + inner + 1, column - inner : column + inner + 1]
    all_of_it = white[row - outer : row + outer + 1, column - outer : column + outer + 1]
    around = (all_of_it.sum() - within.sum()) / (all_of_it.size - within.size)
    assert steps[row, column] == pytest.approx(within.mean() - around, abs=1e-5)


def test_a_rival_counts_from_when_it_is_seen_on() -> None:
    ball, alone, both = Gate(*FIRST, 16.0), picture(FIRST), picture(FIRST, decoys=(AGAIN,))
    color = ms.ColorModel.pick(alone, *FIRST)
    prominence = Prominence(ProminenceParameters(period=7), SearchParameters())
    assert prominence.is_due(1)
    assert not prominence.recognizes(alone, color, 16.0, ball)  # it was never seen
    prominence.measure(alone, color, ball)
    assert [prominence.is_due(frames) for frames in (6, 7)] == [False, True]
    assert prominence.recognizes(alone, color, 16.0, ball)
    assert not prominence.recognizes(alone, color, 16.0, Gate(*AGAIN, 16.0))  # nothing of its color is there
    assert not prominence.recognizes(alone, color, 16.0, Gate(*FIRST, 24.0))  # another size
    assert not prominence.recognizes(both, color, 16.0, ball)
    prominence.measure(both, color, ball)
    assert not prominence.recognizes(alone, color, 16.0, ball)
    prominence.forget()
    assert prominence.is_due(1)


@pytest.mark.parametrize("place", [(-200.0, 90.0, 16.0), (80.0, 90.0, 150.0), (80.0, 900.0, 16.0)])
def test_a_place_outside_or_too_large_for_the_picture_is_nothing(place: tuple[float, float, float]) -> None:
    image = picture(FIRST)
    color = ms.ColorModel.pick(image, *FIRST)
    prominence = Prominence(ProminenceParameters(), SearchParameters())
    prominence.measure(image, color, Gate(*place))
    assert not prominence.recognizes(image, color, place[2], Gate(*place))


PICTURES = {
    "black": np.zeros((60, 80, 3), np.uint8),
    "saturated": np.full((60, 80, 3), 255, np.uint8),
    "one color": np.full((60, 80, 3), (200, 60, 20), np.uint8),
    "noise": np.random.default_rng(0).integers(0, 256, (60, 80, 3), np.uint8),
    "large": np.random.default_rng(1).integers(0, 256, (480, 1280, 3), np.uint8),
    "tiny": np.full((3, 4, 3), (200, 60, 20), np.uint8),
    "a pixel": np.full((1, 1, 3), (200, 60, 20), np.uint8),
}


@pytest.mark.parametrize("radius", [0.5, 0.8, 1.0, 1.2, 2.0, 4.0])
@pytest.mark.parametrize("name", PICTURES)
def test_a_target_of_a_pixel_in_any_picture(name: str, radius: float) -> None:
    """Discs of less than a cell once had no cells around them: the means of nothing were compared."""
    image, place = PICTURES[name], Gate(1.0, 1.0, radius)
    table = np.full((32, 32, 32), -4.0, np.float32)
    table[16:, :16, :16] = 4.0
    color = ms.ColorModel(table.ravel())
    prominence = Prominence(ProminenceParameters(), SearchParameters())
    prominence.measure(image, color, place)
    prominence.recognizes(image, color, radius, place)
    assert all(
        np.isfinite(each).all() for each in Searcher(image.shape[1], image.shape[0], radius=radius).blobs(image, color)
    )
