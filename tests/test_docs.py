"""The Python of the pages in docs/ runs as it stands, one block after the other, beside the rendered files it names."""

import itertools
import math
import re
import shlex
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import msgspec
import numpy as np
import pytest
import typer
from scipy.spatial.transform import Rotation

import boards
import matchset as ms
from matchset.app.films.clip_export import write_clip
from matchset.camera.board import Board
from matchset.cli import app
from matchset.flight.recording.encoding import to_png
from matchset.flight.recording.mcap_file import McapWriter, RecordedMessage, Topic
from matchset.flight.recording.ros_messages import RosMessages
from matchset.sim.clips.clip import Clip
from rendered_flight import write_flight

ROOT = Path(__file__).resolve().parents[1]
# tests/shapes/families.py, tests/live/test_live_docs.py, tests/links/test_radio_page.py, test_crsf_page.py
# tests/links/mavlink/test_mavlink_docs.py, tests/links/tello/test_tello_docs.py
CHECKED_ELSEWHERE = {"add_a_shape.md", "crsf.md", "live.md", "mavlink.md", "radio.md", "tello.md"}
CHECKED_ELSEWHERE |= {"sharing.md"}  # tests/sharing/test_sharing_docs.py
CHECKED_ELSEWHERE |= {"pandas.md", "ros2.md", "two_balls.md", "webcam.md"}  # tests/test_docs_tasks.py
BLOCKS = re.compile(r"```python\n(.*?)```", re.DOTALL)
FOLDERS = (".", "docs", "docs/decisions")
BALL = (200, 60, 30)


def picture() -> np.ndarray:
    image = np.full((120, 160, 3), 90, np.uint8)
    cv2.circle(image, (70, 50), 25, BALL, -1, cv2.LINE_AA)
    return image


def clip() -> None:
    write_clip(Clip(frames=3), Path("ball.mp4"))


def flight() -> None:
    write_flight(Path())


def flight_and_board() -> None:
    board = Board(columns=9, rows=6, square=0.025)
    camera = boards.BoardCamera(ms.CameraModel.from_fov(640, 480, 1.2), board)
    Path("pictures").mkdir()
    tilts = [(25, 0), (-25, 10), (0, 30), (10, -30), (30, 20), (-30, -20), (-20, 25), (0, -15)]
    for index, tilt in enumerate(tilts):
        place = 0.08 * (index % 3 - 1), 0.06 * (index // 3 - 1), 0.4 + 0.03 * (index % 4)
        image = camera.picture(Rotation.from_euler("xy", tilt, degrees=True), place)
        cv2.imwrite(f"pictures/{index}.png", image)
    flight()


def recording() -> None:
    ros = RosMessages(1, ms.CameraModel.from_fov(160, 120, 1.2))
    with McapWriter(Path("flight.mcap"), [*ros.topics, Topic("/follower_1/step", "step", b"{}")]) as out:
        out.write(ros.picture(ms.Frame(picture()), to_png(picture())), 0.0, 0)
        out.write(RecordedMessage("/follower_1/step", msgspec.msgpack.encode({"tick": 1})), 0.0, 0)


def nothing() -> None:
    pass


def is_found(names: dict[str, Any]) -> None:
    circle = Clip(frames=3).truth(0).circle
    assert circle is not None
    assert names["answer"].shape.x == pytest.approx(circle.x, abs=1.0)
    drawn = cv2.imread("answer.png")
    assert np.array_equal(np.asarray(drawn), ms.draw(names["image"], names["answer"]))
    assert "angle" in ms.Rectangle.parameters
    assert len(names["Sign"](x=320, y=240, scale=40, angle=0).corners) == 8


def is_tracked(names: dict[str, Any]) -> None:
    assert len(names["tracks"]) == 3
    for index, track in enumerate(names["tracks"]):
        circle = Clip(frames=3).truth(index).circle
        assert circle is not None
        assert track.shape.state == pytest.approx(circle.state, abs=1.0)


def is_measured(names: dict[str, Any]) -> None:
    truth = [np.array(Clip(frames=3).truth(index).position) for index in range(3)]
    assert names["pose"].position == pytest.approx(truth[2], abs=0.02)
    ways = [math.dist(one, other) * 30.0 for one, other in itertools.pairwise(truth)]
    assert names["speeds"] == pytest.approx(ways, abs=0.1)
    sigmas = names["pose"].covariance.diagonal()[:3] ** 0.5
    assert all(0.0 < sigma < 0.02 for sigma in sigmas)


def is_located(names: dict[str, Any]) -> None:
    assert names["pose"].observed == "level"
    assert names["ahead"].position[2] == pytest.approx(1.6, abs=0.4)
    assert [each.identity for each in names["found"]] == [0, 1]


def is_calibrated(names: dict[str, Any]) -> None:
    assert names["pixels"] == pytest.approx(names["track"].match_set, abs=1e-6)
    assert len(names["views"]) == 8
    assert names["calibration"].camera.fx == pytest.approx(320.0 / np.tan(0.6), rel=0.02)


def is_decoded(names: dict[str, Any]) -> None:
    assert names["frame"].image.shape == (120, 160, 3)
    assert names["step"] == {"tick": 1}


def is_blue(names: dict[str, Any]) -> None:
    assert names["blue"].mask(picture())[50, 70] == 255
    assert names["blue"].mask(picture())[5, 5] == 0
    assert names["tracker"].parameters.coast == 0.1


def is_followed(names: dict[str, Any]) -> None:
    assert len(names["errors"]) == 5
    assert max(names["errors"]) < 1.0


def is_simulated(names: dict[str, Any]) -> None:
    assert names["world"].place(0)[2] < names["start"][2] - 0.01  # it flew forward
    assert names["world"].crashes == []
    assert names["frame"].image.shape == (480, 640, 3)
    assert names["truth"].circle is not None
    assert names["truncated"]
    assert names["picture"].shape == (120, 160, 3)


PAGES: dict[str, tuple[Callable[[], None], Callable[[dict[str, Any]], None]]] = {
    "getting_started.md": (clip, is_found),
    "localization.md": (flight, is_located),
    "camera.md": (flight_and_board, is_calibrated),
    "recording.md": (recording, is_decoded),
    "finding_your_way.md": (nothing, is_blue),
    "clips.md": (nothing, is_followed),
    "simulation.md": (nothing, is_simulated),
    "own_video.md": (clip, is_tracked),
    "meters.md": (clip, is_measured),
}


def test_every_page_with_python_is_checked() -> None:
    pages = {path.name for path in (ROOT / "docs").glob("*.md") if BLOCKS.search(path.read_text(encoding="utf-8"))}
    assert pages == {*PAGES, *CHECKED_ELSEWHERE}


@pytest.mark.parametrize("page", PAGES)
def test_the_python_of_the_page_runs(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    prepare, check = PAGES[page]
    monkeypatch.chdir(tmp_path)
    prepare()
    names: dict[str, Any] = {}
    for block in BLOCKS.findall((ROOT / "docs" / page).read_text(encoding="utf-8")):
        exec(compile(block, page, "exec"), names)
    check(names)


@pytest.mark.parametrize(
    "path",
    sorted(
        [*ROOT.glob("*.md"), *ROOT.glob("docs/*.md"), *ROOT.glob("docs/decisions/*.md"), *ROOT.glob("docs/log/*.md")]
    ),
)
def test_its_links_lead_somewhere(path: Path) -> None:
    links = re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", path.read_text(encoding="utf-8"))
    assert not [link for link in links if not (path.parent / link).exists()]


@pytest.mark.parametrize("path", [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))])
def test_its_commands_exist(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    used = re.findall(r"(?:^    (?:\$ )?|`)matchset ([a-z]+)", text, re.MULTILINE)
    command: Any = typer.main.get_command(app)
    assert set(used) <= set(command.commands)


@pytest.mark.parametrize("path", [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))])
def test_its_commands_have_only_options_that_exist(path: Path) -> None:
    """Each line is parsed as it would be typed; none is run."""
    lines = re.findall(r"^    (?:\$ )?(matchset [a-z].*)$", path.read_text(encoding="utf-8"), re.MULTILINE)
    for line in lines:
        words = shlex.split(re.split(r" +[|>] | 2> ", line)[0], comments=True)[1:]
        command: Any = typer.main.get_command(app)
        while hasattr(command, "commands"):
            command = command.commands[words.pop(0)]
        known = {option for parameter in command.params for option in parameter.opts + parameter.secondary_opts}
        used = {word.split("=")[0] for word in words if re.match(r"--?[a-z]", word)}
        assert used <= known | {"-h", "--help"}, line
