"""The rivals of the other shapes find what is plain to see; where EdgeDrawing is missing, it is said."""

import math

import cv2
import numpy as np
import pytest
from benchmarks.shapes import ellipses as shapes_ellipses
from benchmarks.shapes.accuracy import against_edge_drawing, peers_of
from benchmarks.shapes.cases import ellipse_errors, overlap
from benchmarks.shapes.contours import contour_method
from benchmarks.shapes.trial import CONTOUR, EDGE_DRAWING, ShapeTrial, scalar

import matchset as ms
from matchset.shapes.shape import outline
from matchset.sim.rendering.coverage import draw_polygon

TRUTH = ms.Ellipse(160.0, 120.0, 60.0 * math.sqrt(1.5), 60.0 / math.sqrt(1.5), 0.4)


def picture() -> np.ndarray:
    image = np.full((240, 320, 3), (120, 140, 150), np.float32)
    draw_polygon(image, [outline(TRUTH, 360)], (200, 70, 30))
    return np.rint(image).astype(np.uint8)


def test_the_contour_of_a_plain_ellipse() -> None:
    find = contour_method("ellipse", picture(), outline(TRUTH, 360))
    assert scalar(ellipse_errors(find(picture()), (160.0, 120.0, 60.0, 0.4))) < 1.0
    hull = contour_method("egg", picture(), outline(TRUTH, 360))(picture())
    assert overlap(hull, outline(TRUTH, 360)) > 0.97


@pytest.mark.skipif(not hasattr(cv2, "ximgproc"), reason="this OpenCV has no EdgeDrawing")
def test_edge_drawing_of_a_plain_ellipse() -> None:
    find = shapes_ellipses.ellipse_method("ellipse", picture(), outline(TRUTH, 360))
    assert scalar(ellipse_errors(find(picture()), (160.0, 120.0, 60.0, 0.4))) < 1.0
    assert find(np.full((240, 320, 3), 100, np.uint8)) is None


def test_without_edge_drawing_its_row_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("benchmarks.shapes.accuracy.missing", lambda: "this OpenCV has none")
    assert peers_of("ellipse") == (CONTOUR,)
    finding = against_edge_drawing("typical", [ShapeTrial([None], {CONTOUR: [None]})])
    assert finding.figures == ()
    assert "this OpenCV has none" in finding.what


def test_who_does_not_answer_loses_the_frame() -> None:
    right = {"center": 0.1, "axes": 0.1, "angle": 0.1}
    finding = against_edge_drawing("bad", [ShapeTrial([right, right, None], {EDGE_DRAWING: [None, None, right]})])
    assert [figure.value for figure in finding.figures] == [
        pytest.approx(100.0 * 2 / 3),
        None,
        None,
        pytest.approx(100.0 * 2 / 3),
    ]
    both = against_edge_drawing("bad", [ShapeTrial([right, right], {EDGE_DRAWING: [right, None]})])
    assert [figure.value for figure in both.figures] == pytest.approx([50.0, 0.2, 0.2, 50.0])
