"""One line for every public object, whole or half built; dictionaries for JSON; pictures and tables for notebooks."""

import copy
import json
import math
import re
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

import cv2
import msgspec
import numpy as np
import pytest

import matchset as ms
from matchset.app.locate.rows import pose_columns, pose_row
from matchset.app.track.rows import track_columns, track_row
from matchset.sharing.shared_target import Age

SLOWEST = 0.1  # s of processor time: a fraction of what a person notices
IMAGE = np.full((120, 160, 3), 90, np.uint8)
cv2.circle(IMAGE, (70, 50), 25, (200, 60, 30), -1, cv2.LINE_AA)
FRAME, COLOR = ms.Frame(IMAGE, 1 / 30, 1), ms.ColorModel.pick(IMAGE, 70, 50)
CAMERA, TARGET = ms.CameraModel.from_fov(160, 120, 1.07), ms.BallTarget(diameter=0.28)
MARKED = ms.BallTarget(diameter=0.28, markers=((0.0, 0.0, 1.0),))
TRACKER = ms.Tracker(ms.Circle, COLOR)
TRACK: Any = TRACKER.update(FRAME)
LOCALIZER = ms.Localizer(CAMERA, TARGET)
POSE: Any = LOCALIZER.update(TRACK)
LEVEL = ms.Pose(
    position=np.array((0.1, -0.2, 1.9)),
    rotation_matrix=np.eye(3),
    covariance=np.eye(6) * 1e-4,
    observed="level",
    time=2.0,
)
LOST: ms.Lost[ms.Circle] = ms.Lost("<hidden> & gone", 0.5, ms.Circle(1.0, 2.0, 3.0))
NUMBER = r"-?\d+(\.\d+)?"

LINES: dict[str, tuple[Any, str]] = {
    "frame": (FRAME, r"Frame\(160 x 120 BGR, 0\.0333\d* s, index 1\)"),
    "gray frame": (ms.Frame(IMAGE[..., 0]), r"Frame\(160 x 120 gray, 0\.0 s, index 0\)"),
    "color": (COLOR, rf"ColorModel\({NUMBER} % of all colors, around BGR \d+ \d+ \d+\)"),
    "gray color": (
        ms.ColorModel.pick(IMAGE[..., 0], 70, 50),
        rf"ColorModel\({NUMBER} % of all gray levels, around.*\)",
    ),
    "no color": (ms.ColorModel(np.full(256, -1.0, np.float32)), r"ColorModel\(0\.0 % of all gray levels\)"),
    "dark": (ms.ColorModel.dark(), r"ColorModel\.dark\(\)"),
    "tracker": (TRACKER, r"Tracker\(Circle, 64 points, tracking, 1 frames\)"),
    "track": (
        TRACK,
        rf"Track\(Circle x 70\.\d+ ±0\.\d+ px, .* ±{NUMBER} px, support 100 %, \d+ points, 0\.03333 s\)",
    ),
    "lost": (LOST, r"Lost\('<hidden> & gone', 0\.5 s, expected at Circle\(x=1\.0, y=2\.0, radius=3\.0\)\)"),
    "lost for good": (ms.Lost("gone", 0.5), r"Lost\('gone', 0\.5 s\)"),
    "camera": (CAMERA, r"CameraModel\(160 x 120, fx \d+\.\d+, fy .*, 61\.3° wide, no distortion\)"),
    "target": (TARGET, r"BallTarget\(diameter=0\.28, .*\)"),
    "localizer": (LOCALIZER, r"Localizer\(ball of 0\.28 m without marker, 160 x 120 camera\)"),
    "localizer, one marker": (ms.Localizer(CAMERA, MARKED), r"Localizer\(ball of 0\.28 m with 1 marker, .*\)"),
    "localizer, two markers": (
        ms.Localizer(CAMERA, ms.BallTarget(0.28, ((0.0, 0.0, 1.0), (0.6, 0.0, 0.8)), diameter_sigma=0.002)),
        r"Localizer\(ball of 0\.2800 ±0\.0020 m with 2 markers, .*\)",
    ),
    "pose": (
        POSE,
        rf"Pose\(x [+-]{NUMBER} ±{NUMBER} m, y {NUMBER} ±{NUMBER} m, z \+{NUMBER} ±{NUMBER} m, observed position, "
        r"0\.0333\d* s; ± leaves out camera and diameter\)",
    ),
    "level pose": (
        LEVEL,
        r"Pose\(x \+0\.100 ±0\.010 m, .* heading -1\.900 ±.*, yaw \+3\.01 ±.*°, observed level, .*\)",
    ),
    "pose of a camera that is known": (
        ms.Localizer(ms.CameraModel.from_fov(160, 120, 1.07, 0.02), TARGET).update(TRACK),
        r"Pose\(x .* observed position, 0\.0333\d* s\)",
    ),
    "markers": (ms.MarkerTracker(COLOR, MARKED), r"MarkerTracker\(0 of 1 markers in sight\)"),
    "filter": (ms.PoseFilter(), r"PoseFilter\(no pose yet\)"),
    "several targets": (
        ms.MultiTracker(ms.Circle, COLOR),
        r"MultiTracker\(0 targets followed, 0 found, 0 frames\)",
    ),
    "one of several": (
        ms.Target(3, "blue", TRACK, 0.5, (4,)),
        r"Target\(3 'blue', since 0\.5 s, or 4: Track\(Circle .*\)",
    ),
    "target of another computer": (
        ms.SharedTarget(
            partner="left", name="ball", identity=0, pose=LEVEL, shape="", values={}, age=Age(0.05, 0.002), reason=""
        ),
        r"SharedTarget\(left 'ball', 0\.0500 ±0\.0020 s old: Pose\(.*\)\)",
    ),
    "neighbors": (ms.Neighbors(CAMERA, MARKED, COLOR, COLOR), r"Neighbors\(0 balls followed, 0 frames\)"),
    "neighbor": (ms.Neighbor(3, POSE, TRACK, (), False), r"Neighbor\(.*"),
    "parameters": (ms.TrackerParameters(coast=0.1), r"TrackerParameters\(coast=0\.1\)"),
    "constants": (ms.TrackerConstants(coast=0.1), r"TrackerConstants\(coast=0\.1\)"),
}


def processor_time(call: Callable[[], object]) -> float:
    begin = time.process_time()
    call()
    return time.process_time() - begin


@pytest.mark.parametrize("name", LINES)
def test_it_is_one_line(name: str) -> None:
    thing, line = LINES[name]
    assert re.fullmatch(line, repr(thing)), repr(thing)
    assert name in ("neighbor", "target of another computer") or len(repr(thing)) < 220


@pytest.mark.parametrize("name", LINES)
def test_it_is_quick(name: str) -> None:
    thing, _ = LINES[name]
    repr(thing)
    assert min(processor_time(lambda: repr(thing)) for _ in range(5)) < SLOWEST


def half_built() -> list[Any]:
    """One of each class, made without its constructor, or without its fields."""
    kinds = {type(thing) for thing, _ in LINES.values()} | {ms.Video}
    shells = [cast(Any, kind).__new__(kind) for kind in kinds if not issubclass(kind, msgspec.Struct)]
    damaged = [copy.copy(thing) for thing in (FRAME, TRACK, POSE, CAMERA)]
    for thing in damaged:
        msgspec.structs.force_setattr(thing, thing.__struct_fields__[0], None)
    return sorted(shells + damaged, key=lambda thing: type(thing).__name__)


@pytest.mark.parametrize("half", half_built(), ids=lambda half: type(half).__name__)
def test_one_that_is_half_built_has_a_line_too(half: Any) -> None:
    assert re.fullmatch(rf"<{type(half).__name__}, incomplete: (Attribute|Type)Error>", repr(half))


def test_damaged_numbers_are_shown_not_raised() -> None:
    for covariance in (np.full((3, 3), np.nan), np.zeros((3, 3)), -np.eye(3), np.eye(2), None):
        damaged: Any = msgspec.structs.replace(TRACK, covariance=covariance)
        assert "\n" not in repr(damaged)
        assert repr(damaged).startswith(("Track(Circle x 70.", "<Track, incomplete"))


def test_every_public_class_is_here() -> None:
    shapes = {ms.Circle, ms.Ellipse, ms.Rectangle, ms.Quadrilateral, ms.Polygon, ms.Convex}
    public = {value for name in ms.__all__ if isinstance(value := getattr(ms, name), type)}
    assert public - shapes - {ms.LinkError, ms.Video, ms.Share, ms.NetworkTables} == {
        type(thing) for thing, _ in LINES.values()
    }


def test_a_track_has_the_columns_of_its_table() -> None:
    named, row = json.loads(json.dumps(TRACK.to_dict())), track_row(1, TRACK)
    for column in track_columns(ms.Circle.parameters):
        if column.name not in ("frame", "reason"):
            assert named[column.name] == pytest.approx(column.value(row), abs=1e-4), column.name
    assert named["found"] is True
    assert named["shape"] == "Circle"


def test_a_deviation_that_is_not_finite_is_left_out() -> None:
    named = msgspec.structs.replace(TRACK, covariance=np.diag((0.01, np.inf, np.nan))).to_dict()
    assert [name for name in named if name.endswith("_std")] == ["x_std"]
    json.dumps(named, allow_nan=False)


def test_a_lost_says_where_it_is_expected() -> None:
    named = json.loads(json.dumps(LOST.to_dict()))
    assert named == {
        "time": 0.5,
        "found": False,
        "reason": "<hidden> & gone",
        "predicted": {"x": 1.0, "y": 2.0, "radius": 3.0},
    }
    assert ms.Lost("gone", 0.0).to_dict()["predicted"] is None


@pytest.mark.parametrize("pose", [POSE, LEVEL], ids=["position", "level"])
def test_a_pose_has_the_columns_of_its_table(pose: ms.Pose) -> None:
    named, row = json.loads(json.dumps(pose.to_dict())), pose_row(1, pose)
    for column in pose_columns():
        value = column.value(row)
        if column.name not in ("frame", "reason") and value is not None:
            assert named[column.name] == (value if isinstance(value, str) else pytest.approx(value, abs=1e-6))
        elif value is None:
            assert column.name not in named
    assert (named["rotation_matrix"] is None) == (pose.observed == "position")


@pytest.mark.parametrize("thing", [FRAME, ms.Frame(IMAGE[..., 0]), COLOR, ms.ColorModel.light()], ids=repr)
def test_it_is_a_picture_in_a_notebook(thing: Any) -> None:
    shown = cv2.imdecode(np.frombuffer(thing._repr_png_(), np.uint8), cv2.IMREAD_UNCHANGED)
    if isinstance(thing, ms.Frame):
        assert np.array_equal(np.asarray(shown), thing.image)


def test_the_picture_of_a_color_shows_it_and_fades_the_others() -> None:
    shown = np.asarray(cv2.imdecode(np.frombuffer(COLOR._repr_png_(), np.uint8), cv2.IMREAD_COLOR), np.uint8)
    bright = cv2.cvtColor(shown, cv2.COLOR_BGR2HSV)[..., 1] > 120
    assert 0.005 < bright.mean() < 0.5
    assert COLOR.mask(shown)[bright].mean() > 0.95 * 255


def test_tracks_and_poses_are_tables_in_a_notebook() -> None:
    assert "radius" in TRACK._repr_html_()
    assert TRACK._repr_html_().count("<circle") == len(TRACK.match_set)
    assert "distance" in POSE._repr_html_()
    assert "&lt;hidden&gt; &amp; gone" in LOST._repr_html_()


def test_a_video_has_a_length_and_a_rate(tmp_path: Path) -> None:
    for index in range(3):
        cv2.imwrite(str(tmp_path / f"{index}.png"), IMAGE)
    video = ms.Video(tmp_path, fps=25.0)
    assert (len(video), video.fps, bool(video)) == (3, 25.0, True)
    next(video)
    assert len(video) == 3
    assert len(list(video)) == 2
    assert repr(video) == f"Video({str(tmp_path)!r}, 160 x 120 BGR, 25 fps, 3 frames)"
    video.close()
    assert repr(video).endswith("3 frames, closed)")
    video.length = None
    with pytest.raises(TypeError, match="has no known length"):
        len(video)
    assert bool(video)
    assert "length not known" in repr(video)


def test_the_package_has_a_version() -> None:
    assert re.fullmatch(r"\d+\.\d+\.\d+.*", ms.__version__)


def test_numbers_have_the_digits_they_are_worth() -> None:
    from matchset.numeric.words import measured, short

    assert measured(397.31234, 0.1034) == "397.31 ±0.10"
    assert measured(-0.00001, 0.01, "+") == "+0.000 ±0.010"
    assert measured(1234.5, 12.0) == "1234 ±12"
    assert measured(1.5, math.nan) == measured(1.5, None) == measured(1.5, 0.0) == "1.5"
    assert measured(math.inf, 1.0) == "inf"
    assert [short(each) for each in (0.0012345, 1e300, "a", True)] == ["0.001234", "1e+300", "'a'", "True"]
