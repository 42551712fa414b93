"""The pages of tasks: their Python runs as it stands, with stand-ins for a camera and for ROS, tables as they are."""

import csv
import importlib.util
import itertools
import math
import os
import re
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
import pytest

import matchset as ms
from matchset.app.films.clip_export import write_clip
from matchset.sim.clips.clip import Clip
from test_docs_commands import Shell, lines_of

ROOT = Path(__file__).resolve().parents[1]
BLOCKS = re.compile(r"```python\n(.*?)```", re.DOTALL)
WIDTH, HEIGHT = 320, 240
BLUE, RED = (200, 60, 30), (40, 40, 210)
STEPS = 24

Picture = npt.NDArray[np.uint8]


def programs(page: str) -> list[Any]:
    text = (ROOT / "docs" / page).read_text(encoding="utf-8")
    return [compile(block, page, "exec") for block in BLOCKS.findall(text)]


def picture(*balls: tuple[float, float, tuple[int, int, int]]) -> Picture:
    image = np.full((HEIGHT, WIDTH, 3), 90, np.uint8)
    for x, y, color in balls:
        cv2.circle(image, (round(16 * x), round(16 * y)), 16 * 25, color, -1, cv2.LINE_AA, 4)
    return cv2.GaussianBlur(image, (0, 0), 0.8).astype(np.uint8)


def crossing(second: tuple[int, int, int]) -> None:
    """Write a video of two balls, one of which crosses before the other."""
    writer = cv2.VideoWriter("balls.mp4", cv2.VideoWriter.fourcc(*"mp4v"), 30.0, (WIDTH, HEIGHT))
    for k in range(STEPS):
        writer.write(picture((240 - 6 * k, 120, second), (80 + 6 * k, 120, BLUE)))
    writer.release()


def test_two_balls_of_one_color_keep_their_names_while_they_cross(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    crossing(BLUE)
    exec(programs("two_balls.md")[0], {})
    ways: dict[str, list[float]] = {}
    for line in capsys.readouterr().out.splitlines():
        if place := re.fullmatch(r"\d+ (\d+) \((?:np\.float64\()?([\d.]+).*", line):
            ways.setdefault(place[1], []).append(float(place[2]))
    assert sorted(ways) == ["0", "1"]
    steps = sorted(float(np.median(np.diff(way))) for way in ways.values())
    assert steps == pytest.approx([-6.0, 6.0], abs=0.5)
    for way in ways.values():
        assert way[-1] - way[0] == pytest.approx(6.0 * (STEPS - 1) * np.sign(way[-1] - way[0]), abs=40.0)


def test_two_balls_of_two_colors_are_told_apart(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    crossing(RED)
    names: dict[str, Any] = {}
    exec(programs("two_balls.md")[2], names)
    for name, x in (("blue", 80 + 6 * (STEPS - 1)), ("red", 240 - 6 * (STEPS - 1))):
        assert names["rows"][-1][name].shape.center == pytest.approx((x, 120), abs=1.0)


def test_before_a_webcam_the_ball_in_the_middle_is_followed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    class Camera(list[ms.Frame]):
        def __init__(self, source: int) -> None:
            assert source == 0
            super().__init__(ms.Frame(picture((160 + k - 15, 120, BLUE)), k / 30, k) for k in range(STEPS))

        def __enter__(self) -> "Camera":
            return self

        def __exit__(self, *_: object) -> None:
            pass

    monkeypatch.setattr(ms, "Video", Camera)
    (program,) = programs("webcam.md")
    exec(program, {})
    lines = capsys.readouterr().out.splitlines()
    places = [[float(number) for number in re.findall(r"[\d.]+", line)] for line in lines]
    assert places == [pytest.approx([160 + k - 15, 120], abs=1.0) for k in range(15, STEPS)]


def test_the_tables_are_read_with_pandas(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    if importlib.util.find_spec("pandas") is None and not os.environ.get("CI"):
        pytest.skip("the package pandas is missing: it is in the dependency group `test`")
    monkeypatch.setenv("MPLBACKEND", "Agg")
    monkeypatch.chdir(tmp_path)
    write_clip(Clip(frames=40), tmp_path / "ball.mp4")
    shell = Shell(monkeypatch, capfd)
    for line in lines_of(ROOT / "docs" / "pandas.md"):
        assert shell.run(line)[0] == 0
    names: dict[str, Any] = {}
    for program in programs("pandas.md"):
        exec(program, names)
    said = capfd.readouterr().out
    assert "found in 100.0% of 40 pictures" in said
    truth = [clip.circle for clip in map(Clip(frames=40).truth, range(40))]
    seen = [(circle.x, circle.y) for circle in truth if circle is not None]
    ways = [math.dist(one, other) * 30.0 for one, other in itertools.pairwise(seen)]
    assert np.nanmedian(names["tracks"]["speed"]) == pytest.approx(np.median(ways), rel=0.1)
    assert names["slope"] == pytest.approx(np.polyfit(np.arange(30) / 30.0, [x for x, _ in seen[:30]], 1)[0], rel=0.05)
    assert len(names["both"]) == 40
    assert names["made"]["x"].tolist() == pytest.approx(names["tracks"]["x"].tolist(), abs=0.5)
    assert Path("curves.png").stat().st_size > 10_000
    with Path("run/tracks.csv").open(encoding="utf-8") as file:
        assert list(csv.DictReader(file).fieldnames or []) == described("pandas.md")


def described(page: str) -> list[str]:
    """The columns that a page describes, in its order."""
    text = (ROOT / "docs" / page).read_text(encoding="utf-8").split("| column | what |")[1].split("\n\n")[0]
    names = [name for row in text.splitlines()[2:] for name in re.findall(r"`(\w+)`", row.split("|")[1])]
    return [*names, "reason"]


class Message:
    """A message of ROS: attributes that appear when they are named."""

    def __init__(self, **fields: Any) -> None:
        self.__dict__.update(fields)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        self.__dict__[name] = Message()
        return self.__dict__[name]


def ros(heard: list[Message], published: list[Any], said: list[str]) -> dict[str, ModuleType]:
    """Stand-ins for the modules that the node imports; `spin` hands it the messages."""

    class Node:
        def __init__(self, name: str) -> None:
            self.name = name

        def create_publisher(self, kind: type, topic: str, depth: int) -> Any:
            assert (kind, topic, depth) == (Message, "ball", 10)
            return SimpleNamespace(publish=published.append)

        def create_subscription(self, kind: type, topic: str, callback: Any, quality: str) -> None:
            assert (kind, topic, quality) == (Message, "image_raw", "sensor data")
            self.callback = callback

        def get_logger(self) -> Any:
            return SimpleNamespace(info=lambda words, **_: said.append(words))

    def spin(node: Any) -> None:
        for message in heard:
            node.callback(message)

    contents: dict[str, dict[str, Any]] = {
        "rclpy": {"init": lambda: None, "spin": spin},
        "rclpy.node": {"Node": Node},
        "rclpy.qos": {"qos_profile_sensor_data": "sensor data"},
        "sensor_msgs": {},
        "sensor_msgs.msg": {"Image": Message},
        "geometry_msgs": {},
        "geometry_msgs.msg": {"PointStamped": Message},
    }
    modules = {name: ModuleType(name) for name in contents}
    for name, names in contents.items():
        modules[name].__dict__.update(names)
    return modules


def image_message(image: Picture, k: int, encoding: str) -> Message:
    """A sensor_msgs/Image whose rows are longer than their pixels."""
    rows = np.hstack([image.reshape(HEIGHT, -1), np.zeros((HEIGHT, 8), np.uint8)])
    stamp = Message(sec=1_700_000_000 + k // 30, nanosec=k % 30 * 10**9 // 30)
    size = {"height": HEIGHT, "width": WIDTH, "step": rows.shape[1]}
    header = Message(stamp=stamp, frame_id="camera")
    return Message(header=header, encoding=encoding, data=rows.tobytes(), **size)


@pytest.mark.parametrize("encoding", ["bgr8", "rgb8", "mono16"])
def test_the_node_publishes_where_the_ball_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, encoding: str) -> None:
    monkeypatch.chdir(tmp_path)
    pictures = [picture((80 + 5 * k, 120, BLUE)) for k in range(STEPS)] + [picture()]
    ms.ColorModel.pick(pictures[0], 80, 120).save("ball.npz")
    shown = [each[..., ::-1] if encoding == "rgb8" else each for each in pictures]
    heard = [image_message(np.ascontiguousarray(each), k, encoding) for k, each in enumerate(shown)]
    published: list[Any] = []
    said: list[str] = []
    for name, module in ros(heard, published, said).items():
        monkeypatch.setitem(sys.modules, name, module)
    (program,) = programs("ros2.md")
    if encoding == "mono16":
        with pytest.raises(ValueError, match="not mono16"):
            exec(program, {})
        return
    exec(program, {})
    assert len(published) == STEPS
    for k, (place, message) in enumerate(zip(published, heard, strict=False)):
        assert (place.point.x, place.point.y, place.point.z) == pytest.approx((80 + 5 * k, 120, 25), abs=1.0)
        assert place.header is message.header
    assert len(said) == 1
