"""Misuse of every public name: a clear ValueError or TypeError that shows the value, never an error from inside."""

import math
import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import matchset as ms

IMAGE = np.full((48, 64, 3), 90, np.uint8)
COLOR = ms.ColorModel.hsv((95, 120, 20), (119, 255, 255))
CAMERA, TARGET = ms.CameraModel.from_fov(64, 48, 1.0), ms.BallTarget(diameter=0.28, markers=((0, 0, 1),))
FRAME = ms.Frame(IMAGE)
LOST: ms.Lost[ms.Circle] = ms.Lost("gone", 0.0)
make: Any = ms  # so that a type checker lets wrong types pass


def track_at(x: float) -> "ms.Track[ms.Circle]":
    """A ball that was found at x, 20 px, with a radius of 9 px."""
    return ms.Track(ms.Circle(x, 20.0, 9.0), np.diag((0.01, 0.01, 0.01)), 1.0, np.empty((0, 2)), 0.0)


MISUSE: dict[str, tuple[Callable[[], object], str]] = {
    "points, a fraction": (lambda: make.Tracker(ms.Circle, COLOR, points=64.5), "points must be a whole number.*64.5"),
    "points, not a number": (lambda: make.Tracker(ms.Circle, COLOR, points=math.nan), "points must be .*nan"),
    "points, a word": (lambda: make.Tracker(ms.Circle, COLOR, points="64"), "points must be a whole number.*'64'"),
    "points, too few": (lambda: make.Tracker(ms.Circle, COLOR, points=15), "points must be .*16 to 4096, got 15"),
    "points, too many": (lambda: make.Tracker(ms.Circle, COLOR, points=4097), "points must be .*16 to 4096, got 4097"),
    "points, a truth": (lambda: make.Tracker(ms.Circle, COLOR, points=True), "points must be .*True"),
    "start, a word": (lambda: make.Tracker(ms.Circle, COLOR, start="ab"), "start must be finite.*'ab'"),
    "start, digits": (lambda: make.Tracker(ms.Circle, COLOR, start="12"), "start must be finite.*'12'"),
    "start, one number": (lambda: make.Tracker(ms.Circle, COLOR, start=3.0), "start must be finite.*3.0"),
    "start, three": (lambda: make.Tracker(ms.Circle, COLOR, start=(1, 2, 3)), r"start must be finite.*\(1, 2, 3\)"),
    "start, infinite": (lambda: make.Tracker(ms.Circle, COLOR, start=(1, math.inf)), "start must be finite.*inf"),
    "start, outside": (
        lambda: make.Tracker(ms.Circle, COLOR, start=(3000, 4000)).update(FRAME),
        r"start \(3000.0, 4000.0\) does not lie in the 64 x 48 picture",
    ),
    "family, a number": (lambda: make.Tracker(3, COLOR), "3 is no family of shapes"),
    "family, a shape": (lambda: make.Tracker(ms.Circle(1, 2, 3), COLOR), "no family of shapes"),
    "color, a word": (lambda: make.Tracker(ms.Circle, "blue"), "color must be a ColorModel, got str 'blue'.*pick"),
    "color, a class": (lambda: make.Tracker(ms.Circle, ms.ColorModel), "color must be a ColorModel, got type"),
    "parameters": (lambda: make.Tracker(ms.Circle, COLOR, parameters=3), "parameters must be a TrackerParameters.*3"),
    "update, nothing": (
        lambda: make.Tracker(ms.Circle, COLOR).update(None),
        r"a picture must be an array .*ms.Frame\(image, time\), got NoneType",
    ),
    "update, a name": (
        lambda: make.Tracker(ms.Circle, COLOR).update("a.png"),
        r"must be .*ms.Frame\(image, time\), got str",
    ),
    "update, floats": (
        lambda: make.Tracker(ms.Circle, COLOR).update(IMAGE / 2.0),
        r"array of uint8, got float64.*ms.Frame\(image, time\)",
    ),
    "update, 4 channels": (
        lambda: make.Tracker(ms.Circle, COLOR).update(np.zeros((4, 4, 4), np.uint8)),
        r"shape \(h, w, 3\) or \(h, w\), got \(4, 4, 4\).*ms.Frame",
    ),
    "update, gray for color": (lambda: make.Tracker(ms.Circle, COLOR).update(IMAGE[..., 0]), "learned on color"),
    "rate, zero": (lambda: make.Tracker(ms.Circle, COLOR, fps=0), "fps must be positive, or None.*got 0"),
    "rate, nan": (lambda: make.Tracker(ms.Circle, COLOR, fps=math.nan), "fps must be positive.*got nan"),
    "rate, a word": (lambda: make.Tracker(ms.Circle, COLOR, fps="30"), "fps must be a number, got '30'"),
    "start at a tuple": (lambda: make.Tracker(ms.Circle, COLOR).start((1, 2, 3)), r"follows Circle, got \(1, 2, 3\)"),
    "restart at a word": (lambda: make.Tracker(ms.Circle, COLOR).restart("here"), "follows Circle.*'here'"),
    "restart elsewhere": (
        lambda: make.Tracker(ms.Circle, COLOR).restart((1, math.nan)),
        "hint must be finite.*nan",
    ),
    "detect, a list": (lambda: make.detect([IMAGE], ms.Circle, COLOR), r"must be .*ms.Frame\(image, time\), got list"),
    "detect, no color": (lambda: make.detect(FRAME, ms.Circle, None), "color must be a ColorModel, got NoneType"),
    "detect, limit 0": (lambda: make.detect(FRAME, ms.Circle, COLOR, 0), "limit must be a whole number.*got 0"),
    "detect, limit 1.5": (lambda: make.detect(FRAME, ms.Circle, COLOR, 1.5), "limit must be a whole number.*1.5"),
    "detect, family": (lambda: make.detect(FRAME, "Circle", COLOR), "no family of shapes"),
    "frame, a list": (lambda: make.Frame([[1]]), "a picture must be an array of uint8, got list"),
    "frame, floats": (lambda: make.Frame(IMAGE / 2.0), "a picture must be an array of uint8, got float64"),
    "frame, empty": (lambda: make.Frame(IMAGE[:0]), r"a picture must have shape .*\(0, 64, 3\)"),
    "frame, 4 channels": (lambda: make.Frame(np.zeros((4, 4, 4), np.uint8)), r"shape .*\(4, 4, 4\)"),
    "frame, time a word": (lambda: make.Frame(IMAGE, "1"), "the time of frame 0 must be a number, got '1'"),
    "frame, time nan": (lambda: make.Frame(IMAGE, math.nan), "must be finite, got nan"),
    "table, size": (lambda: make.ColorModel(np.zeros(5, np.float32)), r"32768 or 256 finite numbers, got shape \(5,\)"),
    "table, nan": (lambda: make.ColorModel(np.full(256, np.nan, np.float32)), "finite numbers"),
    "pick outside": (lambda: make.ColorModel.pick(IMAGE, 64, 3), r"pick \(64, 3\) does not lie in the 64 x 48 picture"),
    "pick at nan": (lambda: make.ColorModel.pick(IMAGE, math.nan, 3), r"pick \(nan, 3\) does not lie"),
    "pick, no picture": (lambda: make.ColorModel.pick("a.png", 3, 3), "a picture must be an array of uint8, got str"),
    "learn, no area": (lambda: make.ColorModel.learn(IMAGE, (3, 3, 0, 4)), r"region \(3, 3, 0, 4\) does not lie"),
    "localizer, camera": (lambda: make.Localizer(None, TARGET), "camera must be a CameraModel, got NoneType"),
    "localizer, target": (lambda: make.Localizer(CAMERA, 0.28), "target must be a BallTarget, got float 0.28"),
    "localizer, a frame": (
        lambda: make.Localizer(CAMERA, TARGET).update(FRAME),
        "ball must be a Track or Lost, got Frame: Tracker.update",
    ),
    "localizer, a track of larger pictures": (
        lambda: make.Localizer(CAMERA, TARGET).update(track_at(200.0)),
        r"camera's pictures are 64 x 48 px, the ball is at \(200, 20\): .*resized",
    ),
    "draw, nothing": (lambda: make.draw(FRAME, None), "what is drawn must be a Track or Lost, got NoneType: Tracker"),
    "draw, a word": (lambda: make.draw(FRAME, "ab"), "what is drawn must be a Track or Lost, got str 'ab'"),
    "draw, a pose": (
        lambda: make.draw(FRAME, make.Localizer(CAMERA, TARGET).update(track_at(32.0))),
        "what is drawn must be a Track or Lost, got Pose: draw_pose",
    ),
    "write_video, tracks and frames exchanged": (
        lambda: make.write_video("found.avi", [LOST], [FRAME]),
        "what is drawn must be a Track or Lost, got Frame: Tracker.update",
    ),
    "markers, color": (lambda: make.MarkerTracker("red", TARGET), "color must be a ColorModel, got str 'red'"),
    "markers, nothing": (
        lambda: make.MarkerTracker(COLOR, TARGET).update(None, LOST),
        r"must be .*ms.Frame\(image, time\), got NoneType",
    ),
    "neighbors, color": (
        lambda: make.Neighbors(CAMERA, TARGET, COLOR, None),
        "marker_color must be a ColorModel, got NoneType",
    ),
    "neighbors, nothing": (
        lambda: make.Neighbors(CAMERA, TARGET, COLOR, COLOR).update(None),
        r"must be .*ms.Frame\(image, time\), got NoneType",
    ),
    "filter, parameters": (lambda: make.PoseFilter(0.5), "parameters must be a FilterParameters .*float 0.5"),
    "filter, a track": (lambda: make.PoseFilter().update(FRAME), "pose must be a Pose or Lost, got Frame: Localizer"),
    "filter, a word": (lambda: make.PoseFilter().predict("a"), "prediction is for .*got 'a' s"),
    "filter, time": (lambda: make.PoseFilter().predict(math.nan), "got nan s"),
    "circle, nan": (lambda: make.Circle(1.0, math.nan, 3.0), "nan"),
    "circle, a word": (lambda: make.Circle("a", 2.0, 3.0), "finite numbers.*x='a'"),
    "ellipse, nothing": (lambda: make.Ellipse(1.0, 2.0, None, 1.0, 0.0), "finite numbers.*None"),
    "rectangle, a word": (lambda: make.Rectangle(1.0, 2.0, 3.0, "4", 0.0), "finite numbers.*'4'"),
    "template, a word": (lambda: make.Polygon.of([(0, 0), (1, 0), (0, 1)])("a", 1.0, 2.0, 3.0), "numbers.*x='a'"),
    "affine template": (
        lambda: make.Polygon.of([(0, 0), (1, 0), (0, 1)], "affine")("a", 1.0, 2.0, 3.0, 4.0, 5.0),
        "numbers.*x='a'",
    ),
    "table, a word": (lambda: make.ColorModel("x"), "finite numbers, got 'x'"),
    "hsv, a word": (lambda: make.ColorModel.hsv("abc", (1, 2, 3)), "HSV values run .*'abc'"),
    "hsv, nothing": (lambda: make.ColorModel.hsv((1, 2, 3), None), "HSV values run .*None"),
    "pick at a word": (lambda: make.ColorModel.pick(IMAGE, "a", 3), "x of the pick must be a number, got 'a'"),
    "pick, parameters": (lambda: make.ColorModel.pick(IMAGE, 3, 3, "x"), "must be a ColorParameters, got str 'x'"),
    "learn, a word": (lambda: make.ColorModel.learn(IMAGE, "abcd"), "region must be four numbers.*'abcd'"),
    "learn, three": (lambda: make.ColorModel.learn(IMAGE, (1, 2, 3)), r"region must be four numbers.*\(1, 2, 3\)"),
    "learn, nan": (lambda: make.ColorModel.learn(IMAGE, (1, 1, math.nan, 4)), "region must be four numbers.*nan"),
    "circle, negative": (lambda: make.Circle(1.0, 2.0, -3.0), "-3.0"),
    "ellipse, zero": (lambda: make.Ellipse(1.0, 2.0, 0.0, 0.0, 0.0), "0.0"),
    "rectangle, negative": (lambda: make.Rectangle(1.0, 2.0, -4.0, 2.0, 0.0), "-4.0"),
    "quadrilateral, three": (lambda: make.Quadrilateral([(0, 0), (1, 0), (1, 1)]), r"\(3, 2\)"),
    "polygon, a line": (lambda: make.Polygon.of([(0, 0), (1, 0)]), r"at least 3 points.*\(2, 2\)"),
    "polygon, a word": (lambda: make.Polygon.of("abc"), "vertices must be an array.*'abc'"),
    "polygon, motion": (lambda: make.Polygon.of([(0, 0), (1, 0), (0, 1)], "wild"), "got 'wild'"),
    "convex, a word": (lambda: make.Convex.of("abc"), "'abc'"),
    "target, negative": (lambda: make.BallTarget(diameter=-1.0), "-1.0"),
    "target, a word": (lambda: make.BallTarget(diameter="0.28"), "ball's diameter must be a number, got '0.28'"),
    "target, marker": (lambda: make.BallTarget(marker_diameter=None), "marker's diameter must be a number, got None"),
    "markers of a lost ball, a word": (
        lambda: make.Localizer(CAMERA, TARGET).update(LOST, markers="abc"),
        "a marker must be a Track or Lost, got str 'a': MarkerTracker",
    ),
    "markers of a lost ball, a number": (
        lambda: make.Localizer(CAMERA, TARGET).update(LOST, markers=3),
        "markers must be several of Track and Lost, got int 3",
    ),
    "markers of a lost ball, poses": (
        lambda: make.Localizer(CAMERA, TARGET).update(LOST, markers=[None]),
        "a marker must be a Track or Lost, got NoneType",
    ),
    "target, markers": (lambda: make.BallTarget(markers=3), "markers must be unit vectors of 3 numbers, got 3"),
    "target, a marker": (lambda: make.BallTarget(markers=(("a", 0, 0),)), "markers must be unit vectors.*'a'"),
    "camera, a word": (lambda: make.CameraModel.from_fov("640", 480, 1.0), "width must be a number, got '640'"),
    "camera, fov": (lambda: make.CameraModel.from_fov(640, 480, None), "fov must be a number, got None"),
    "camera, nan": (lambda: make.CameraModel.from_fov(640, 480, math.nan), "nan"),
    "video, nothing": (lambda: make.Video(""), "a video is a path, a camera number or a URL, got ''"),
    "video, none": (lambda: make.Video(None), "a video is a path, a camera number or a URL, got None"),
    "video, timeout": (lambda: make.Video("a.mp4", timeout=-1.0), "timeout must be positive, got -1.0"),
    "video, patience": (lambda: make.Video("a.mp4", timeout="x"), "timeout must be a number, got 'x'"),
}


@pytest.mark.parametrize("name", MISUSE)
def test_misuse_is_told_in_words_that_show_the_value(name: str) -> None:
    call, words = MISUSE[name]
    with pytest.raises((ValueError, TypeError)) as caught:
        call()
    assert re.search(words, str(caught.value)), str(caught.value)


def test_a_ball_half_out_of_the_picture_is_no_misuse() -> None:
    assert ms.Localizer(CAMERA, TARGET).update(track_at(71.0))


def test_exchanged_blue_and_red_are_told_where_the_ball_is_clicked() -> None:
    image = IMAGE.copy()
    image[10:31, 20:41] = (200, 60, 30)  # blue, BGR
    color = ms.ColorModel.learn(image, (22, 12, 16, 16))
    ms.Tracker(ms.Circle, color, start=(30, 20)).update(image)  # a warning would fail
    with pytest.warns(UserWarning, match=r"at the start \(30.0, 20.0\) blue and red seem to be exchanged.*BGR"):
        ms.Tracker(ms.Circle, color, start=(30, 20)).update(image[..., ::-1])
