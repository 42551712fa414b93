"""The Python of the pages in docs/ runs as it stands: each page in one namespace, with rendered inputs."""

import re
import runpy
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
from matchset.app.cli import app
from matchset.app.recording.encoding import to_png
from matchset.app.recording.mcap_file import McapWriter, Message, Topic
from matchset.app.recording.ros_messages import RosMessages
from matchset.camera.board import Board

ROOT = Path(__file__).resolve().parents[1]
CHECKED_ELSEWHERE = {"add_a_shape.md", "radio.md"}  # tests/shapes/families.py, tests/links/test_radio_page.py
BLOCKS = re.compile(r"```python\n(.*?)```", re.DOTALL)
FOLDERS = (".", "docs", "docs/decisions")
BALL = (200, 60, 30)


def picture() -> np.ndarray:
    image = np.full((120, 160, 3), 90, np.uint8)
    cv2.circle(image, (70, 50), 25, BALL, -1, cv2.LINE_AA)
    return image


def color_file() -> dict[str, Any]:
    ms.ColorModel.pick(picture(), 70, 50).save("ball.npz")
    return {"image": picture(), "time": 0.0, "index": 0}


def flight() -> dict[str, Any]:
    runpy.run_path(str(ROOT / "examples" / "render_flight.py"))
    return {}


def flight_and_board() -> dict[str, Any]:
    board = Board(columns=9, rows=6, square=0.025)
    camera = boards.BoardCamera(ms.CameraModel.from_fov(640, 480, 1.2), board)
    Path("pictures").mkdir()
    tilts = [(25, 0), (-25, 10), (0, 30), (10, -30), (30, 20), (-30, -20), (-20, 25), (0, -15)]
    for index, tilt in enumerate(tilts):
        place = 0.08 * (index % 3 - 1), 0.06 * (index // 3 - 1), 0.4 + 0.03 * (index % 4)
        image = camera.picture(Rotation.from_euler("xy", tilt, degrees=True), place)
        cv2.imwrite(f"pictures/{index}.png", image)
    return flight()


def recording() -> dict[str, Any]:
    ros = RosMessages(1, ms.CameraModel.from_fov(160, 120, 1.2))
    with McapWriter(Path("flight.mcap"), [*ros.topics, Topic("/follower_1/step", "step", b"{}")]) as out:
        out.write(ros.picture(ms.Frame(picture()), to_png(picture())), 0.0, 0)
        out.write(Message("/follower_1/step", msgspec.msgpack.encode({"tick": 1})), 0.0, 0)
    return {}


def nothing() -> dict[str, Any]:
    return {}


def is_found(names: dict[str, Any]) -> None:
    assert names["answer"].shape.x == pytest.approx(70.0, abs=0.5)


def is_located(names: dict[str, Any]) -> None:
    assert names["pose"].observed == "level"
    assert names["ahead"].position[2] == pytest.approx(1.6, abs=0.4)


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


PAGES: dict[str, tuple[Callable[[], dict[str, Any]], Callable[[dict[str, Any]], None]]] = {
    "getting_started.md": (color_file, is_found),
    "localization.md": (flight, is_located),
    "camera.md": (flight_and_board, is_calibrated),
    "recording.md": (recording, is_decoded),
    "finding_your_way.md": (nothing, is_blue),
    "clips.md": (nothing, is_followed),
    "simulation.md": (nothing, is_simulated),
}


def test_every_page_with_python_is_checked() -> None:
    pages = {path.name for path in (ROOT / "docs").glob("*.md") if BLOCKS.search(path.read_text(encoding="utf-8"))}
    assert pages == {*PAGES, *CHECKED_ELSEWHERE}


@pytest.mark.parametrize("page", PAGES)
def test_the_python_of_the_page_runs(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    prepare, check = PAGES[page]
    monkeypatch.chdir(tmp_path)
    names = prepare()
    for block in BLOCKS.findall((ROOT / "docs" / page).read_text(encoding="utf-8")):
        exec(compile(block, page, "exec"), names)
    check(names)


@pytest.mark.parametrize(
    "path", sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/*.md"), *ROOT.glob("docs/decisions/*.md")])
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
