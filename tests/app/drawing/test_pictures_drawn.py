import itertools
import math

import cv2
import numpy as np
import pytest

from matchset.app.drawing.annotate import Caption, annotate, describe, draw_circle, write_captions
from matchset.app.drawing.contact_sheet import TRUTH, WIDTH_PX, SheetFrame, contact_sheet, rim_tile
from matchset.app.drawing.text import draw_text, text_width
from matchset.app.track.grid_picture import grid_picture
from matchset.app.track.rows import TrackRow, track_row
from matchset.image.candidates import Candidate
from matchset.image.frame import Frame
from matchset.shapes.circle import Circle
from matchset.tracking.track import Lost, Track
from plot_layout import faults

NAN = math.nan


def circle_track(x: float, y: float, radius: float) -> Track[Circle]:
    angles = np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False)
    points = np.column_stack([x + radius * np.cos(angles), y + radius * np.sin(angles)])
    return Track(Circle(x, y, radius), np.eye(3) * 0.01, 0.95, points, 1.0)


def test_a_circle_is_drawn_where_it_is_to_a_fraction_of_a_pixel() -> None:
    image = np.zeros((200, 200, 3), np.uint8)
    draw_circle(image, Circle(80.3, 101.7, 40.5), (255, 255, 255))
    weight = image[..., 0].astype(float)
    rows, columns = np.indices(weight.shape)
    assert (weight * columns).sum() / weight.sum() == pytest.approx(80.3, abs=0.1)
    assert (weight * rows).sum() / weight.sum() == pytest.approx(101.7, abs=0.1)
    radius = np.hypot(columns - 80.3, rows - 101.7)
    assert (weight * radius).sum() / weight.sum() == pytest.approx(40.5, abs=0.1)


@pytest.mark.parametrize("shape", [(120, 160, 3), (120, 160), (31, 40, 3), (1200, 1600, 3)])
def test_annotating_leaves_the_frame_alone(shape: tuple[int, ...]) -> None:
    frame = Frame(np.full(shape, 90, np.uint8), 1.0, 3)
    for answer in (
        circle_track(20.0, 15.0, 9.0),
        Lost("it left the picture", 1.0, Circle(5.0, 5.0, 50.0)),
        Lost("x" * 500, 1.0),
    ):
        picture = annotate(frame, answer, track_row(3, answer))
        assert picture.shape == (*shape[:2], 3)
        assert (picture != 90).any()
        assert (frame.image == 90).all()


def test_a_circle_far_outside_is_not_drawn() -> None:
    image = np.zeros((50, 50, 3), np.uint8)
    draw_circle(image, Circle(1e12, 0.0, 5.0))
    assert not image.any()


def test_a_row_reads_as_a_line() -> None:
    row = track_row(0, circle_track(12.34, 56.78, 9.0))
    assert describe(row) == "x 12.3 ±0.10   y 56.8 ±0.10   radius 9.0 ±0.10 px   support 95 %"
    assert describe(TrackRow(0, 0.0, reason="it left the picture")) == "Lost: it left the picture"


def test_text_is_cut_off_at_the_edges() -> None:
    for at in ((-30.0, 10.0), (90.0, 10.0), (10.0, -2.0), (10.0, 52.0), (500.0, 500.0), (-500.0, 10.0)):
        image = np.zeros((50, 100, 3), np.uint8)
        draw_text(image, "± 20°", at, 16)
        assert image.shape == (50, 100, 3)
    draw_text(image, "", (10.0, 10.0))
    assert text_width("±0.25", 20) > text_width("±0.25", 10) > 10


def test_the_grid_is_labelled_and_the_frame_is_inside() -> None:
    image = np.full((480, 640, 3), (10, 200, 30), np.uint8)
    picture = grid_picture(image, [])
    assert picture.shape[0] > 960
    assert picture.shape[1] > 1280
    assert (picture == (10, 200, 30)).all(axis=2).mean() > 0.6
    for odd in ((33, 21, 3), (20, 3000), (1, 1, 3)):
        grid_picture(np.zeros(odd, np.uint8), [])


def test_the_enlarged_rim_lies_where_the_ball_is() -> None:
    image = np.zeros((200, 200, 3), np.uint8)
    cv2.circle(image, (round(80.5 * 16), round(90.25 * 16)), 30 * 16, (255, 0, 0), cv2.FILLED, cv2.LINE_AA, 4)
    track = circle_track(80.5, 90.25, 30.0)
    bare = Track(track.shape, track.covariance, 1.0, np.empty((0, 2)), 0.0)
    tile = rim_tile(SheetFrame(Frame(image), bare), 400)[:400]
    blue = (tile[..., 0] > 128) & (tile[..., 2] < 60)
    rows, columns = np.nonzero(blue)
    assert columns.mean() == pytest.approx(199.5, abs=0.7)
    assert rows.mean() == pytest.approx(199.5, abs=0.7)


def test_a_sheet_takes_any_answer() -> None:
    frame = Frame(np.full((48, 64, 3), 90, np.uint8))
    shots = [SheetFrame(frame, circle_track(2.0, 15.0, 9.0), 0.5), SheetFrame(frame, Lost("gone", 0.0))] * 3
    shots.append(SheetFrame(frame, Lost("a long reason " * 9, 0.0), None, Circle(2.0, 15.0, 9.0), "the worst"))
    sheet = contact_sheet("title", "subtitle", shots, np.zeros((100, WIDTH_PX, 3), np.uint8))
    assert sheet.shape[1] == WIDTH_PX


def test_the_truth_is_drawn_beside_what_was_found() -> None:
    frame = Frame(np.full((200, 200, 3), 90, np.uint8))
    shown = SheetFrame(frame, circle_track(100.0, 100.0, 40.0), 5.0, Circle(100.0, 100.0, 45.0))
    tile = rim_tile(shown, 400)
    wide = tile.astype(int)
    assert TRUTH[2] > TRUTH[0] < TRUTH[1]
    colored = (wide[..., 2] - wide[..., 0] > 60) & (wide[..., 1] - wide[..., 0] > 60)
    rows, columns = np.nonzero(colored)
    zoom = 400 / (2.44 * 40.0)
    assert np.hypot(rows - 199.5, columns - 199.5) == pytest.approx(45.0 * zoom, abs=2.0)
    assert len(rows) > 200


CURVES = {
    "one frame lost": ([0.1, NAN, 0.3], [1]),
    "never found": ([NAN, NAN, NAN], [0, 2]),
    "no frame": ([], []),
    "many": ([0.3, 0.2, 0.1] * 100, [19, 56, 94, 131, 169, 206, 244, 270]),
    "neighbors shown": ([0.3, 0.2, 0.1, NAN] * 75, [0, 1, 2, 150, 297, 298, 299]),
}


@pytest.mark.parametrize("name", sorted(CURVES))
def test_the_error_of_a_run_is_laid_out_well(name: str) -> None:
    from matchset.app.drawing.curves import SIZE_PX, ErrorCurve, error_figure
    from matchset.app.drawing.plot_style import picture_of

    errors, shown = CURVES[name]
    figure = error_figure(ErrorCurve([index / 30.0 for index in range(len(errors))], errors, errors, shown))
    assert not faults(figure)
    written = {text.get_text() for text in figure.axes[0].texts}
    assert {str(index) for index in shown} <= written
    width, height = SIZE_PX
    assert picture_of(figure).shape == (height, width, 3)


@pytest.mark.parametrize("size", [(480, 848), (320, 240), (480, 360), (640, 480), (800, 600), (1920, 1080)])
def test_captions_are_whole_in_pictures_of_any_shape(size: tuple[int, int], monkeypatch: pytest.MonkeyPatch) -> None:
    width, height = size
    written: list[tuple[str, float, float, int]] = []

    def record(_: object, text: str, at: tuple[float, float], size: int, *__: object) -> None:
        written.append((text, *at, size))

    monkeypatch.setattr("matchset.app.drawing.annotate.draw_text", record)
    numbers = "x 219.5 ±0.32   y 246.3 ±0.37   radius 150.1 ±0.30 px   support 100 %"
    words = "Lost: nothing of this color and shape is in the picture, however long one looks at it"
    for text in (numbers, words):
        written.clear()
        captions = Caption("the one above"), Caption(text, "frame 1234   61.70 s", bad=True)
        write_captions(np.zeros((height, width, 3), np.uint8), *captions)
        assert (
            " ".join(each for each, *_ in written if each).split() == f"the one above {text} frame 1234 61.70 s".split()
        )
        for each, x, y, letters in written:
            assert letters >= 11
            assert x >= 0.0
            assert x + text_width(each, letters) <= width
            assert 0.5 * letters <= y <= height - 0.5 * letters
        for (one, x, y, letters), (_, right, level, _) in itertools.pairwise(written):
            assert level != y or x + text_width(one, letters) < right
    assert len(written) <= 6


def test_circles_and_numbers_of_candidates_stay_off_the_margin() -> None:
    bare, dark = (grid_picture(np.full((480, 640, 3), gray, np.uint8), []) for gray in (120, 60))
    inside = np.zeros(bare.shape[:2], bool)
    rows, columns = np.nonzero((bare != dark).any(axis=2))
    inside[rows.min() : rows.max() + 1, columns.min() : columns.max() + 1] = True
    found = [Candidate(x, y, radius, (0, 0), 1.0) for x, y, radius in ((630.0, 5.0, 60.0), (2.0, 470.0, 90.0))]
    drawn = grid_picture(np.full((480, 640, 3), 120, np.uint8), found)
    changed = (drawn != bare).any(axis=2)
    assert changed.any()
    assert not (changed & ~inside).any()


def test_the_first_candidate_is_drawn_strongest() -> None:
    image = np.full((480, 640, 3), 120, np.uint8)
    found = [Candidate(x, 240.0, 60.0, (0, 0), 1.0) for x in (150.0, 450.0)]
    pink = (grid_picture(image, found).astype(int)[..., 2] - 40 > 180) & (grid_picture(image, found)[..., 1] < 80)
    half = pink.shape[1] // 2
    assert pink[:, :half].sum() > 2.0 * pink[:, half:].sum() > 0.0
