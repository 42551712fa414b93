from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import matchset as ms

KNOWN: dict[str, Any] = {"width": 640, "height": 480, "fx": 451.25, "fy": 450.5, "cx": 321.0, "cy": 238.0}
LENS = (-0.3, 0.1, 0.001, -0.002, 1e-05)
CAMERA = ms.CameraModel(**KNOWN, distortion=LENS)
ROS = """
image_width: 640
image_height: 480
camera_name: narrow_stereo
camera_matrix:
  rows: 3
  cols: 3
  data: [451.25, 0.000000, 321,
         0, 450.5, 238.0, 0, 0, 1]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.3, 0.1, 0.001, -2e-3, 1e-05]
rectification_matrix:
  rows: 3
  cols: 3
  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]
projection_matrix:
  rows: 3
  cols: 4
  data: [400, 0, 321, 0, 0, 400, 238, 0, 0, 0, 1, 0]
"""
MESSAGE = """
header:
  stamp: {secs: 12, nsecs: 5}
  frame_id: "camera"
height: 480
width: 640
distortion_model: "plumb_bob"
D: [-0.3, 0.1, 0.001, -0.002, 0.00001]
K: [451.25, 0.0, 321.0, 0.0, 450.5, 238.0, 0.0, 0.0, 1.0]
R: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
binning_x: 0
binning_y: 0
roi:
  x_offset: 0
  y_offset: 0
  do_rectify: False
---
height: 1
"""


def uncertain() -> ms.CameraModel:
    half = np.random.default_rng(0).normal(0.0, 1.0, (9, 9)) * np.array([3, 3, 2, 2, 0.1, 0.1, 0.01, 0.01, 0.1])
    rows = tuple(tuple(row) for row in (half.T @ half).tolist())
    return ms.CameraModel(**KNOWN, distortion=LENS, intrinsics_covariance=rows)


def written(tmp_path: Path, text: str, name: str = "camera.yaml") -> Path:
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    return path


def test_toml_there_and_back(tmp_path: Path) -> None:
    CAMERA.save(tmp_path / "camera.toml")
    assert ms.CameraModel.load(tmp_path / "camera.toml") == CAMERA
    uncertain().save(str(tmp_path / "camera.toml"))
    back = ms.CameraModel.load(str(tmp_path / "camera.toml"))
    assert back.intrinsics.tolist() == CAMERA.intrinsics.tolist()
    assert back.covariance == pytest.approx(uncertain().covariance, rel=1e-6, abs=1e-7)
    assert [path.name for path in tmp_path.iterdir()] == ["camera.toml"]


def test_every_line_has_a_unit(tmp_path: Path) -> None:
    uncertain().save(tmp_path / "camera.toml")
    lines = [line for line in (tmp_path / "camera.toml").read_text().splitlines() if "=" in line]
    assert len(lines) == 12 + 9 + 9
    assert all("# px" in line or "# no unit" in line for line in lines)


def test_standard_deviations_alone_will_do(tmp_path: Path) -> None:
    uncertain().save(tmp_path / "camera.toml")
    text = (tmp_path / "camera.toml").read_text().partition("[correlation]")[0]
    covariance = ms.CameraModel.load(written(tmp_path, text, "camera.toml")).covariance
    wanted = uncertain().covariance
    assert covariance is not None
    assert wanted is not None
    assert covariance == pytest.approx(np.diag(np.diag(wanted)), rel=1e-9)


@pytest.mark.parametrize("text", [ROS, MESSAGE, ROS.replace("distortion_model", "camera_model"), "%YAML:1.0\n" + ROS])
@pytest.mark.parametrize("name", ["camera.yaml", "camera.YML"])
def test_ros(tmp_path: Path, text: str, name: str) -> None:
    assert ms.CameraModel.load(written(tmp_path, text, name)) == CAMERA


@pytest.mark.parametrize("column", [True, False])
def test_opencv(tmp_path: Path, column: bool) -> None:
    lens = np.array(LENS).reshape((5, 1) if column else (1, 5))
    storage = cv2.FileStorage(str(tmp_path / "camera.yml"), cv2.FILE_STORAGE_WRITE)
    storage.write("calibration_time", "Thu Sep 23 23:42:14 2021")
    for name in ("width", "height"):
        storage.write(f"image_{name}", KNOWN[name])
    storage.write("camera_matrix", np.array([[451.25, 0.0, 321.0], [0.0, 450.5, 238.0], [0.0, 0.0, 1.0]]))
    storage.write("distortion_coefficients", lens)
    storage.write("avg_reprojection_error", 0.2)
    storage.release()
    assert ms.CameraModel.load(tmp_path / "camera.yml") == CAMERA


def test_as_the_older_opencv_wrote(tmp_path: Path) -> None:
    text = """%YAML:1.0
---
image_width: 640
image_height: 480
flags: 0
fisheye_model: 0
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 4.5125e+02, 0., 321., 0., 450.5,
       2.38e+02, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -3.0e-01, .1, 1.0e-03, -2.0e-03, 1.0e-05 ]
"""
    assert ms.CameraModel.load(written(tmp_path, text)) == CAMERA


def test_four_coefficients_leave_the_fifth_zero(tmp_path: Path) -> None:
    camera = ms.CameraModel.load(written(tmp_path, ROS.replace(", 1e-05]", "]")))
    assert camera.distortion == (*LENS[:4], 0.0)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("image_width: 640", "", "image_width is missing"),
        ("image_width: 640", "image_width: 0", "image_width: width must be a whole number"),
        ("image_width: 640", "image_width: 640.5", "image_width must be a whole number"),
        ("image_width: 640", "image_width: [640]", "image_width must hold finite numbers"),
        ("camera_matrix:", "camera_matricks:", "camera_matrix is missing"),
        ("451.25", ".nan", "camera_matrix.data must hold finite numbers"),
        ("451.25", "-451.25", "camera_matrix: fx must be a positive number"),
        ("451.25", "x", "camera_matrix.data must hold finite numbers, got 'x'"),
        ("238.0, 0, 0, 1", "238.0, 0, 0, 2", "camera_matrix must be fx 0 cx"),
        ("238.0, 0, 0, 1", "238.0, 0, 0", "camera_matrix.data must have 9 numbers, got 8"),
        ("data: [451", "dato: [451", "camera_matrix.data is missing"),
        ("321", "99999", "camera_matrix: cx must lie in or near"),
        ("plumb_bob", "equidistant", "distortion_model must be plumb_bob"),
        ("plumb_bob", "[plumb_bob, 1]", "distortion_model must be plumb_bob"),
        ("plumb_bob", '"\\UFFFFFFFF"', "not YAML: an escape"),
        ("plumb_bob", "fisheye", "distortion_model must be plumb_bob"),
        ("distortion_coefficients:", "distortion_coefficents:", "distortion_coefficients is missing"),
        ("1e-05]", "1e-05, 0, 0, 2]", "distortion_coefficients has more than"),
        ("1e-05]", "1e-05, 3, 4]", "distortion_coefficients.data must have 0 or 4 or 5"),
        ("-0.3", "-3e22", "distortion_coefficients: k1 must lie between"),
        ("-0.3", "one", "distortion_coefficients.data must hold finite numbers"),
        ("camera_name: n", "fisheye_model: 1\nx: n", "fisheye_model must be 0"),
        ("camera_name: n", "binning_x: 2\nx: n", "binning_x must be 0 or 1"),
        ("camera_name: n", "roi: {x_offset: 8}\nx: n", "roi.x_offset must be 0"),
        ("camera_name: n", "[", "not YAML in line"),
        (ROS, "", "holds no keys"),
        (ROS, "[" * 5000, "not"),
    ],
)
def test_bad_yaml_is_told_with_file_and_key(tmp_path: Path, old: str, new: str, words: str) -> None:
    assert old in ROS
    with pytest.raises(ValueError, match=r"camera\.yaml: ") as caught:
        ms.CameraModel.load(written(tmp_path, ROS.replace(old, new)))
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("width = 640", "", "width is missing"),
        ("width = 640", "width = 640.0", "width must be a whole number"),
        ("width = 640", "width = 1" + "0" * 400, "width must be a whole number"),
        ("fx = 451.25", "", "fx is missing"),
        ("fx = 451.25", "fx = nan", "fx must be finite"),
        ("fx = 451.25", "fx = 1" + "0" * 400, "fx must be finite"),
        ("fx = 451.25", "fx = 0", "fx must be a positive number"),
        ("fx = 451.25", 'fx = "451"', "fx must be a number"),
        ("k1 = -0.3", "k1 = inf", "k1 must be finite"),
        ("k1 = -0.3", "k4 = 0.1\nk1 = -0.3", "k4 is not a key"),
        ('"plumb_bob"', '"fisheye"', "distortion_model must be"),
        ("distortion_model", "distortion", "distortion_model must be"),
        ("[standard_deviation]", "[deviation]", "deviation is not a key"),
        ("[standard_deviation]\n", "[[standard_deviation]]\n", "standard_deviation must be a table"),
        ("[correlation]\nfx = [1.0", "[correlation]\nfx = [2.0", "correlation must lie between"),
        ("[correlation]\nfx = [1.0", "[correlation]\nfx = [3] #", "correlation.fx must be a list of 9"),
        ("[correlation]\nfx", "[correlation]\nfz", "correlation.fz is not a key"),
        ("[standard_deviation]\n", "[standard_deviation]\nk4 = 1\n", "standard_deviation.k4 is not a key"),
        ("[standard_deviation]\nfx = ", "[standard_deviation]\nfx = -", "standard_deviation.fx must not be negative"),
        ("[standard_deviation]\nfx = ", "[standard_deviation]\nfx = inf #", "standard_deviation.fx must be a finite"),
        ("width = 640", "width = ", "line 3"),
        ("width = 640", "x = " + "[" * 5000 + "]" * 5000, "not a camera file"),
    ],
)
def test_bad_toml_is_told_with_file_and_key(tmp_path: Path, old: str, new: str, words: str) -> None:
    uncertain().save(tmp_path / "camera.toml")
    text = (tmp_path / "camera.toml").read_text()
    assert old in text
    with pytest.raises(ValueError, match=r"camera\.toml: ") as caught:
        ms.CameraModel.load(written(tmp_path, text.replace(old, new, 1), "camera.toml"))
    assert words in str(caught.value)


def test_correlations_need_deviations(tmp_path: Path) -> None:
    uncertain().save(tmp_path / "camera.toml")
    head, _, rest = (tmp_path / "camera.toml").read_text().partition("[standard_deviation]")
    text = head + "[correlation]" + rest.partition("[correlation]")[2]
    with pytest.raises(ValueError, match="standard_deviation is missing"):
        ms.CameraModel.load(written(tmp_path, text, "camera.toml"))


def test_files_that_are_none(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"no such camera file: .*gone\.toml"):
        ms.CameraModel.load(tmp_path / "gone.toml")
    with pytest.raises(ValueError, match=r"a camera file is \.toml"):
        ms.CameraModel.load(tmp_path / "ball.mp4")
    (tmp_path / "folder.toml").mkdir()
    with pytest.raises(ValueError, match="cannot read the camera file"):
        ms.CameraModel.load(tmp_path / "folder.toml")
    (tmp_path / "large.toml").write_bytes(b"#" * 2_000_000)
    with pytest.raises(ValueError, match=r"large\.toml: too large"):
        ms.CameraModel.load(tmp_path / "large.toml")
    (tmp_path / "bytes.yaml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ValueError, match=r"bytes\.yaml: not a text file"):
        ms.CameraModel.load(tmp_path / "bytes.yaml")
    with pytest.raises(ValueError, match=r"must end in \.toml"):
        CAMERA.save(tmp_path / "camera.yaml")


numbers = st.one_of(st.floats(), st.integers(), st.text(max_size=5), st.sampled_from(["[1, 2]", "{a: 1}", "~", ""]))
words = st.one_of(st.text(max_size=60), st.text("[]{}:,-#!&*|>'\"%@ \n\t=.0159kfxy", max_size=80))


@pytest.mark.parametrize("suffix", ["toml", "yaml"])
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_anything_else_is_a_value_error(tmp_path: Path, suffix: str, data: st.DataObject) -> None:
    """Damaged files: numbers replaced, lines lost, text cut and inserted. A camera comes out whole or not at all."""
    uncertain().save(tmp_path / "good.toml")
    text = (tmp_path / "good.toml").read_text() if suffix == "toml" else data.draw(st.sampled_from([ROS, MESSAGE]))
    damage: list[Callable[[list[str]], None]] = [
        lambda lines: lines.__delitem__(place(lines)),
        lambda lines: lines.insert(place(lines), data.draw(words)),
        lambda lines: lines.__setitem__(slice(place(lines), None), []),
        lambda lines: replace_number(lines, place(lines)),
    ]

    def place(lines: list[str]) -> int:
        return data.draw(st.integers(0, len(lines) - 1))

    def replace_number(lines: list[str], at: int) -> None:
        head, sign, _ = lines[at].partition("=" if suffix == "toml" else ":")
        lines[at] = f"{head}{sign} {data.draw(numbers)}"

    lines = text.splitlines()
    for _ in range(data.draw(st.integers(1, 3))):
        if lines:
            data.draw(st.sampled_from(damage))(lines)
    path = tmp_path / f"bad.{suffix}"
    path.write_bytes("\n".join(lines).encode("utf-8", "surrogatepass"))
    try:
        camera = ms.CameraModel.load(path)
    except ValueError as error:
        named, camera = f"bad.{suffix}" in str(error), CAMERA
    else:
        named = True
    assert named
    assert np.isfinite(camera.rays([(0.0, 0.0), (100.0, 5.0)])).all()
