"""What a page may tell of the camera: a file, a board, a ball at a known distance."""

import math
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pytest

import matchset as ms
from asgi_client import AsgiClient
from boards import BoardCamera, poses
from matchset.camera.board import Board
from matchset.live.camera.ball_distance import BallDistance, BallDistanceParameters
from matchset.live.camera.board_calibration import BoardCalibration
from matchset.live.camera.camera_files import CameraFileParameters, find_camera_files, read_camera_file
from matchset.live.camera.camera_panel import CameraPanel, describe
from matchset.live.camera.messages import BallAt, CalibrateBoard, EndBoard, LookForCameraFiles, UseCamera
from matchset.live.feed import Feed, StreamPicture
from matchset.live.known_messages import READER
from matchset.live.session import Session
from matchset.live.web.application import UPLOAD, make_application
from matchset.live.web.security import Guard
from matchset.live.web.session_report import SessionReport
from matchset.live.web.viewer import ViewerContext, Viewers
from matchset.live.wire.pictures import PictureEncoder
from matchset.live.wire.state import State, TargetState

CAMERA = ms.CameraModel.from_fov(320, 240, math.radians(60.0))
BOARD = Board(columns=7, rows=5, square=0.03)
PATIENCE = 60.0  # s; only ever spent where a test fails


def wait_for(condition: Callable[[], object]) -> None:
    """Wait until something holds."""
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.01)


class Source:
    """A source whose pictures the test sets."""

    def __init__(self) -> None:
        self.seen, self.number = StreamPicture(None, State(0, 0, 0.0, 0, 0)), 0
        self.used: list[ms.CameraModel | None] = []

    def use(self, camera: ms.CameraModel | None) -> None:
        self.used.append(camera)
        self.seen = self.seen._replace(camera=camera)

    def show(self, image: Any, *targets: TargetState) -> None:
        self.number += 1
        height, width = image.shape[:2]
        state = State(self.number, self.number, self.number / 30.0, width, height, list(targets))
        self.seen = StreamPicture(ms.Frame(image, self.number / 30.0, self.number), state, camera=self.seen.camera)


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture(scope="module")
def pictures() -> list[Any]:
    """A board held before the camera, all over the picture."""
    camera = BoardCamera(CAMERA, BOARD)
    return [camera.picture(*pose, seed=seed) for seed, pose in enumerate(poses(CAMERA, BOARD, 30, 4))]


def test_camera_files_are_found_and_others_left_out(folder: Path) -> None:
    CAMERA.save(folder / "camera.toml")
    CAMERA.save(folder / "my-camera-2.toml")
    CAMERA.save(folder / "flight.toml")
    (folder / "runs" / "0001-calibrate").mkdir(parents=True)
    CAMERA.save(folder / "runs" / "0001-calibrate" / "camera.toml")
    (folder / "camera-broken.yaml").write_text("no: camera")
    (folder / "camera.yaml").mkdir()
    found = {file.path.relative_to(folder).as_posix() for file in find_camera_files(folder)}
    assert found == {"camera.toml", "my-camera-2.toml", "runs/0001-calibrate/camera.toml"}
    (folder / "camera-broken.yaml").unlink()
    assert len(find_camera_files(folder, CameraFileParameters(files=1))) == 1
    assert find_camera_files(folder / "gone") == []


@pytest.mark.parametrize(
    ("name", "data", "words"),
    [
        ("camera.txt", b"", "ends in .toml"),
        ("camera.toml", b"width = 320", "camera.toml"),
        ("camera.yaml", b"\xff\xfe\x00", "camera.yaml"),
        ("../../etc/camera.toml", b"= = =", "camera.toml"),
        ("", b"", "ends in .toml"),
    ],
)
def test_an_upload_that_is_no_camera_is_refused_with_its_name(name: str, data: bytes, words: str) -> None:
    with pytest.raises(ValueError, match=words) as refused:
        read_camera_file(name, data)
    assert "matchset-" not in str(refused.value)


def test_an_uploaded_file_is_the_camera(folder: Path) -> None:
    CAMERA.save(folder / "any.toml")
    assert read_camera_file("any.toml", (folder / "any.toml").read_bytes()) == CAMERA


@pytest.fixture
def panel() -> Iterator[tuple[CameraPanel, Source, list[str]]]:
    source, notes = Source(), list[str]()
    with CameraPanel(source, notes.append) as made:
        yield made, source, notes


def test_a_file_is_used_by_its_key_alone(folder: Path, panel: tuple[CameraPanel, Source, list[str]]) -> None:
    made, source, _ = panel
    assert made.state().files == []
    CAMERA.save(folder / "camera.toml")
    made.take(LookForCameraFiles(), "")
    wait_for(lambda: made.state().files)
    (entry,) = made.state().files
    with pytest.raises(ValueError, match="not there any more"):
        made.take(UseCamera("camera.toml"), "")
    made.take(UseCamera(entry.key), "")
    assert source.used == [CAMERA]
    assert made.state().fov == pytest.approx(60.0)
    assert made.state().words == describe(CAMERA)
    made.look()
    assert made.state().files == [entry]


def test_a_board_calibrates_and_the_file_is_used_and_offered(
    panel: tuple[CameraPanel, Source, list[str]], pictures: list[Any]
) -> None:
    made, source, notes = panel
    made.take(CalibrateBoard(7, 5, 0.03), "")
    shown, shares = 0, [0.0]
    while (state := made.state().board) is not None and state.phase == "looking" and shown < 300:
        views = state.views
        source.show(pictures[shown % len(pictures)])
        shown += 1
        end = time.monotonic() + 0.1
        while time.monotonic() < end and made.state().board.views == views:  # type: ignore[union-attr]
            time.sleep(0.005)
        shares.append(made.state().board.share)  # type: ignore[union-attr]
        if shown == len(pictures):
            made.take(EndBoard(use=True), "")
    wait_for(lambda: made.state().board.phase in ("done", "refused"))  # type: ignore[union-attr]
    board = made.state().board
    assert board is not None
    assert board.phase == "done", board.words
    assert max(shares) > 0.5
    assert board.grade in board.words
    assert {line.name for line in board.lines} == {"error", "views", "coverage", "tilt", "numbers"}
    files = made.downloads()
    camera = ms.CameraModel.load(files[board.file])
    assert source.used == [camera]
    assert camera.fx == pytest.approx(CAMERA.fx, rel=0.01)
    assert files[board.picture].is_file()
    assert files[board.file].as_posix() == "runs/0001-calibrate/camera.toml"
    assert "camera.toml" in notes[-1]


def test_a_calibration_without_a_board_is_refused_in_words(panel: tuple[CameraPanel, Source, list[str]]) -> None:
    made, source, _ = panel
    with pytest.raises(ValueError, match="no calibration"):
        made.take(EndBoard(), "")
    made.take(CalibrateBoard(7, 5, 0.03), "")
    source.show(np.full((240, 320, 3), 90, np.uint8))
    made.take(EndBoard(use=True), "")
    wait_for(lambda: made.state().board.phase == "refused")  # type: ignore[union-attr]
    assert "Inner corners are counted" in made.state().board.words  # type: ignore[union-attr]
    made.take(EndBoard(use=False), "")
    assert made.state().board is None
    assert not Path("runs").exists()


def test_too_few_views_are_refused_with_the_reason(pictures: list[Any]) -> None:
    source = Source()
    with BoardCalibration(source, BOARD, print) as calibration:
        for image in pictures[:2]:
            source.show(image)
            wanted = calibration.state.views + 1
            wait_for(lambda: calibration.state.views == wanted)  # noqa: B023 - called at once
        assert len(calibration.downloads()) == 2
        calibration.end()
        wait_for(lambda: calibration.state.phase == "refused")
        assert "views" in calibration.state.words
    assert not source.used


def test_pictures_of_another_size_end_it(pictures: list[Any]) -> None:
    source = Source()
    with BoardCalibration(source, BOARD, print) as calibration:
        source.show(pictures[0])
        wait_for(lambda: calibration.state.views)
        source.show(np.repeat(np.repeat(pictures[1], 2, axis=0), 2, axis=1))
        wait_for(lambda: calibration.state.phase == "refused")
        assert "another size" in calibration.state.words


def test_boards_to_print_are_offered(panel: tuple[CameraPanel, Source, list[str]], client: AsgiClient) -> None:
    sheets = panel[0].state().sheets
    assert [(sheet.paper, sheet.columns, sheet.rows) for sheet in sheets] == [("a4", 9, 6), ("letter", 9, 6)]
    for sheet in sheets:
        answer = client.get(f"/download/{sheet.name}")
        assert answer.content.startswith(b"%PDF")
        assert 0.02 < sheet.square <= 0.025
    assert client.get("/download/camera.toml").status_code == 404


def ball(number: int, distance: float, radius: float, x: float = 160.0) -> TargetState:
    """What pages are told of a ball on the axis, in the middle of the picture."""
    angle = np.linspace(0.0, 2.0 * math.pi, 60, endpoint=False)
    size = CAMERA.fx * math.tan(math.asin(radius / distance))
    points = np.column_stack((159.5 + size * np.cos(angle), 119.5 + size * np.sin(angle))).round(1)
    values: dict[str, tuple[float, float | None]] = {"x": (x, 0.1), "y": (119.5, 0.1), "radius": (size, 0.1)}
    return TargetState(number, "circle 1", True, values, match_set=points.ravel().tolist(), diameter=2.0 * radius)


def feed_balls(source: Source, running: Callable[[], object], *targets: TargetState) -> None:
    """Show balls, one after the other, until it is over."""
    end, number = time.monotonic() + PATIENCE, 0
    while running():
        assert time.monotonic() < end
        source.show(np.zeros((240, 320, 3), np.uint8), targets[number % len(targets)])
        number += 1
        time.sleep(0.02)


def test_a_ball_at_a_known_distance_corrects_the_focal_length(panel: tuple[CameraPanel, Source, list[str]]) -> None:
    made, source, notes = panel
    source.use(ms.CameraModel.from_fov(320, 240, math.radians(80.0)))
    target = ball(1, 1.14, 0.14)
    source.show(np.zeros((240, 320, 3), np.uint8), target)
    with pytest.raises(ValueError, match="no such target"):
        made.take(BallAt(2, 1.0), "")
    made.take(BallAt(1, 1.0), "")
    with pytest.raises(ValueError, match="already"):
        made.take(BallAt(1, 1.0), "")
    feed_balls(source, lambda: made.state().ball, target)
    corrected = source.used[-1]
    assert corrected is not None
    assert corrected.fx == pytest.approx(CAMERA.fx, rel=0.003)
    assert "190" in notes[-1]


def test_a_ball_of_unknown_size_or_in_motion_is_refused() -> None:
    source, notes = Source(), list[str]()
    still = ball(1, 1.0, 0.14)
    unknown = msgspec.structs.replace(still, diameter=None)
    with BallDistance(source, 1, 1.0, notes.append, BallDistanceParameters(soon=0.1)) as begun:
        feed_balls(source, lambda: begun.words, unknown)
    assert "diameter first" in notes[-1]
    with BallDistance(source, 1, 1.0, notes.append, BallDistanceParameters(patience=0.3)) as moving:
        feed_balls(source, lambda: moving.words, still, ball(1, 1.0, 0.14, 190.0))
    assert "not held still" in notes[-1]
    other = TargetState(1, "square 1", True, {"x": (1.0, None)}, diameter=0.1)
    with BallDistance(source, 1, 1.0, notes.append) as wrong:
        feed_balls(source, lambda: wrong.words, other)
    assert "no ball" in notes[-1]
    assert not source.used


@pytest.fixture
def client(panel: tuple[CameraPanel, Source, list[str]]) -> AsgiClient:
    """A page's server with the camera's panel alone."""

    class One(Feed):
        kind, title, streams, panels = "camera", "a camera", (panel[1],), (panel[0],)

        def close(self) -> None:
            pass

    session = Session()
    session.show(One())
    application = make_application(
        ViewerContext(session, PictureEncoder(), READER, SessionReport(session)), Viewers(), Guard([], 80, token=False)
    )
    return AsgiClient(application)


def test_a_file_is_uploaded_and_its_size_is_bounded(
    client: AsgiClient, folder: Path, panel: tuple[CameraPanel, Source, list[str]]
) -> None:
    CAMERA.save(folder / "any.toml")
    data = (folder / "any.toml").read_bytes()
    assert client.post("/upload/camera?name=any.toml", content=data).status_code == 204
    assert panel[1].used == [CAMERA]
    assert client.get("/state.json").json()["session"]["panels"]["camera"]["fov"] == pytest.approx(60.0)
    too_long = client.post("/upload/camera?name=any.toml", content=b"#" * (UPLOAD + 1))
    assert too_long.status_code == 413
    for name, kind in (("any.toml", "other"), ("any.exe", "camera"), ("", "camera")):
        answer = client.post(f"/upload/{kind}?name={name}", content=b"x")
        assert answer.status_code == 400
        assert answer.json()["error"]
    foreign = client.post("/upload/camera?name=any.toml", content=data, headers={"Origin": "http://example.com"})
    assert foreign.status_code == 403
    assert len(panel[1].used) == 1


@pytest.mark.parametrize(
    ("type_", "fields"),
    [
        ("calibrate_board", {"columns": 2, "rows": 6, "square": 0.02}),
        ("calibrate_board", {"columns": 9, "rows": 6, "square": 0}),
        ("calibrate_board", {"columns": 9, "rows": 6, "square": 0.02, "marker": 0.03}),
        ("calibrate_board", {"columns": 9, "rows": 6, "square": 0.02, "marker": 0.01, "dictionary": "none"}),
        ("calibrate_board", {"columns": "9", "rows": 6, "square": 0.02}),
        ("ball_at", {"target": 1, "meters": 0}),
        ("ball_at", {"target": 1, "meters": 1e9}),
        ("ball_at", {"target": 1, "meters": 1.0}),
        ("use_camera", {"key": "/etc/passwd"}),
        ("end_board", {}),
    ],
)
def test_nonsense_is_refused_in_words(client: AsgiClient, type_: str, fields: dict[str, Any]) -> None:
    answer = client.post(f"/do/{type_}", json=fields)
    assert answer.status_code == 400
    assert answer.json()["error"]
