"""A recording holds every picture with what was found in it, ends whole on a full disk, and makes no loop wait."""

import contextlib
import csv
import json
import resource
import shutil
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import cv2
import msgspec
import numpy as np
import pytest
from benchmarks.lost.full_disk import small_disk

import bags
from live_feeds import CAMERA, MadeUpFeed, seen_of, shown, with_image
from matchset.app.disk import SpaceParameters
from matchset.app.locate.rows import read_poses
from matchset.app.track.rows import read_tracks
from matchset.camera.camera_model import CameraModel
from matchset.flight.recording.mcap_file import McapReader
from matchset.live.feed import StreamPicture
from matchset.live.known_messages import READER
from matchset.live.record.panel import RecordPanel
from matchset.live.record.recorder import PageRecorder, PageRecorderParameters
from matchset.live.record.recording import RecordingParameters
from matchset.live.record.state import FinishedRecording
from matchset.live.record.stream_files import FileParameters, StreamFiles
from matchset.live.session import Session
from matchset.live.wire.state import State
from matchset.media.video import Video

NO_GUARD = SpaceParameters(keep_free=0.0)
PATIENCE = 60.0  # s; only ever spent where a test fails
ON, OFF = (READER.read(f'{{"type": "record", "on": {word}}}') for word in ("true", "false"))


class Recorded:
    """A session with a recorder, and a feed that shows made-up pictures."""

    def __init__(self, parameters: RecordingParameters, streams: int = 1) -> None:
        self.recorder = PageRecorder(PageRecorderParameters(recording=parameters))
        self.panel = RecordPanel(self.recorder)
        self.session = Session((self.panel,), (self.recorder,))
        self.feed = shown(MadeUpFeed(streams), self.session)

    def show(self, numbers: range, targets: int = 1) -> None:
        """Show pictures, none faster than the recording takes them."""
        for number in numbers:
            self.feed.show(seen_of(number, targets=targets))
            self.wait(lambda count=number - numbers.start: self.panel.state().frames > count or not self.running)  # type: ignore[misc]

    @property
    def running(self) -> bool:
        """Whether it records."""
        return self.panel.state().on

    def wait(self, done: Callable[[], bool]) -> None:
        """Wait for something, 20 s at most."""
        until = time.monotonic() + PATIENCE
        while not done():
            assert time.monotonic() < until
            time.sleep(0.002)

    def finished(self) -> FinishedRecording:
        """The last recording, when its files are closed."""
        self.wait(lambda: not self.panel.state().on and not self.panel.state().finishing)
        return self.panel.state().finished[0]


@pytest.fixture
def recorded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Recorded]:
    monkeypatch.chdir(tmp_path)
    made = Recorded(RecordingParameters())
    with made.recorder, made.session:
        yield made


def renamed(seen: StreamPicture, number: int, name: str) -> StreamPicture:
    """The same, with another name for a target."""
    targets = [
        msgspec.structs.replace(each, name=name if each.id == number else each.name) for each in seen.state.targets
    ]
    return seen._replace(state=msgspec.structs.replace(seen.state, targets=targets))


def test_names_of_several_targets_are_in_tables_facts_and_topics(recorded: Recorded) -> None:
    pytest.importorskip("mcap")
    recorded.session.take(ON, "")
    recorded.show(range(2), targets=2)
    for number in (2, 3):
        recorded.feed.show(renamed(seen_of(number, targets=2), 2, "right <hand>, \u7403"))
        recorded.wait(lambda count=number: recorded.panel.state().frames > count)  # type: ignore[misc]
    recorded.session.take(OFF, "")
    folder = Path("runs") / recorded.finished().folder
    with (folder / "tracks_circle_2.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["identity"] for row in rows] == ["2"] * 4
    assert [row["label"] for row in rows] == ["circle 2"] * 2 + ["right <hand>, \u7403"] * 2
    with (folder / "poses_circle_2.csv").open(newline="", encoding="utf-8") as file:
        assert [row["label"] for row in csv.DictReader(file)][-1] == "right <hand>, \u7403"
    assert len(read_tracks(folder / "tracks_circle_2.csv")) == len(read_poses(folder / "poses_circle_2.csv")) == 4
    facts = json.loads((folder / "recording.json").read_text())
    assert [target["name"] for target in facts["streams"][0]["targets"]] == ["circle 1", "right <hand>, \u7403"]
    topics = {message.topic for message in McapReader(folder / "recording.mcap")}
    assert {"/camera_1/circle_1/pose", "/camera_1/circle_2/pose"} <= topics


def test_every_picture_is_in_every_file(recorded: Recorded) -> None:
    pytest.importorskip("mcap")
    recorded.show(range(3))  # before: not recorded
    recorded.session.take(ON, "")
    recorded.session.take(ON, "")  # again: no harm
    recorded.show(range(3, 23))
    recorded.feed.show(recorded.feed.streams[0].seen)  # the same picture again, as a fault shows it
    recorded.feed.show(seen_of(23, found=False))
    recorded.session.take(OFF, "")
    recorded.session.take(OFF, "")
    finished = recorded.finished()
    folder = Path("runs") / finished.folder
    assert finished.folder == "0001-live"
    assert (finished.frames, finished.dropped, finished.ended) == (21, 0, "")
    rows, poses = read_tracks(folder / "tracks.csv"), read_poses(folder / "poses.csv")
    assert [row.frame for row in rows] == [row.frame for row in poses] == list(range(21))
    assert rows[0].shape == {"x": 53.0, "y": 60.0, "radius": 12.5}
    assert rows[0].std == {"x": 0.1, "y": 0.2, "radius": 0.05}
    assert rows[0].time == pytest.approx(100.1)
    assert (rows[0].support, rows[20].reason) == (0.9, "too few edge points")
    assert poses[0].values == {"x": 0.1, "y": 0.2, "z": 1.5}  # without a marker there is no yaw
    assert poses[20].reason == "too few edge points"
    assert CameraModel.load(folder / "camera.toml").fx == pytest.approx(CAMERA.fx)
    for name in ("recording.mcap", *(path.name for path in folder.glob("raw.*"))):
        with Video(folder / name) as video:
            levels = [int(np.median(frame.image)) for frame in video]
        assert levels == pytest.approx([52 + 4 * number for number in range(21)], abs=7)
        assert (np.diff(levels) > 0).all()


def test_the_bag_has_detections_and_poses(recorded: Recorded) -> None:
    pytest.importorskip("mcap")
    recorded.session.take(ON, "")
    recorded.show(range(4))
    recorded.session.take(OFF, "")
    folder = Path("runs") / recorded.finished().folder
    topics = [message.topic for message in McapReader(folder / "recording.mcap")]
    for topic in ("image/compressed", "camera_info", "detections", "circle_1/pose"):
        assert topics.count(f"/camera_1/{topic}") == 4
    assert topics.count("/tf") == 4


def test_the_bag_is_one_of_ros(recorded: Recorded) -> None:
    bags.need_rosbags()
    from rosbags.highlevel import AnyReader

    recorded.session.take(ON, "")
    recorded.show(range(1))
    recorded.show(range(1, 3), targets=2)  # a topic more
    recorded.session.take(OFF, "")
    folder = Path("runs") / recorded.finished().folder
    poses = dict[str, list[float]]()
    with AnyReader([folder / "recording.mcap"]) as reader:
        for connection, _, data in reader.messages():
            if connection.topic.endswith("/pose"):
                message: Any = reader.deserialize(data, connection.msgtype)
                poses.setdefault(connection.topic, []).append(message.pose.pose.position.z)
    assert poses == {"/camera_1/circle_1/pose": [1.5] * 3, "/camera_1/circle_2/pose": [1.5] * 2}


def test_files_are_offered_when_they_are_whole(recorded: Recorded) -> None:
    recorded.session.take(ON, "")
    recorded.show(range(5))
    assert recorded.session.downloads() == {}
    recorded.session.take(OFF, "")
    names = {file.name for file in recorded.finished().files}
    assert {"tracks.csv", "poses.csv", "camera.toml", "recording.json"} < names
    offered = recorded.session.downloads()
    assert set(offered) == {f"0001-live/{name}" for name in names}
    assert all(path.is_file() for path in offered.values())
    facts = json.loads(offered["0001-live/recording.json"].read_text())
    target = {"name": "circle 1", "tracks": "tracks.csv", "poses": "poses.csv", "diameter": 0.28}
    assert facts["streams"] == [{"targets": [target], "cameras": ["camera.toml"]}]
    assert (facts["source"], facts["frames"], facts["dropped"], facts["problem"]) == ("made up", [5], 0, "")
    assert facts["computing_ms"] == [{}]  # nobody counted


def test_what_a_picture_took_is_kept_with_how_it_ended(recorded: Recorded) -> None:
    times = {"median": 0.15, "mean": 37.0, "percentile_95": 210.0, "worst": 1020.0}
    recorded.session.take(ON, "")
    recorded.show(range(2))
    last = seen_of(2)
    recorded.feed.show(last._replace(state=msgspec.structs.replace(last.state, computing=times)))
    recorded.wait(lambda: recorded.panel.state().frames == 3)
    recorded.session.take(OFF, "")
    recorded.finished()
    facts = json.loads(recorded.session.downloads()["0001-live/recording.json"].read_text())
    assert facts["computing_ms"] == [times]


def test_each_target_has_its_tables(recorded: Recorded) -> None:
    recorded.session.take(ON, "")
    recorded.show(range(2))
    recorded.show(range(2, 4), targets=2)
    recorded.session.take(OFF, "")
    folder = Path("runs") / recorded.finished().folder
    assert [row.frame for row in read_tracks(folder / "tracks.csv")] == [0, 1, 2, 3]
    assert [row.frame for row in read_tracks(folder / "tracks_circle_2.csv")] == [2, 3]
    assert [row.frame for row in read_poses(folder / "poses_circle_2.csv")] == [2, 3]


def test_a_recording_without_a_picture_says_so(recorded: Recorded) -> None:
    recorded.session.take(ON, "")
    recorded.session.take(OFF, "")
    assert (recorded.finished().frames, recorded.finished().ended) == (0, "no new picture came")


def test_each_stream_has_a_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    made = Recorded(RecordingParameters(), streams=2)
    with made.recorder, made.session:
        made.session.take(ON, "")
        for number in range(3):
            made.feed.show(seen_of(number), 0)
            made.feed.show(seen_of(number), 1)
        made.session.take(OFF, "")
        names = [file.name for file in made.finished().files]
    assert {"camera_1/tracks.csv", "camera_2/tracks.csv", "recording.json"} < set(names)


def test_another_source_ends_the_recording(recorded: Recorded) -> None:
    recorded.session.take(ON, "")
    recorded.show(range(5))
    recorded.session.show(None)
    assert recorded.finished().frames == 5
    with pytest.raises(ValueError, match="nothing is shown that could be recorded"):
        recorded.session.take(ON, "")


def test_pictures_of_another_size_end_it_and_say_so(recorded: Recorded) -> None:
    recorded.session.take(ON, "")
    recorded.show(range(3))
    other = seen_of(3)
    recorded.feed.show(with_image(other, np.zeros((50, 60, 3), np.uint8)))
    finished = recorded.finished()
    assert "must have (160, 120) px, got (60, 50)" in finished.ended
    assert finished.frames == 3


def test_gray_pictures_are_recorded(recorded: Recorded) -> None:
    recorded.session.take(ON, "")
    seen = seen_of(7)
    recorded.feed.show(with_image(seen, np.full((120, 160), 68, np.uint8)))
    recorded.session.take(OFF, "")
    folder = Path("runs") / recorded.finished().folder
    video = cv2.VideoCapture(str(next(folder.glob("raw.*"))))
    assert int(np.median(video.read()[1])) == pytest.approx(68, abs=7)


def test_a_slow_disk_makes_no_loop_wait_and_what_is_left_out_is_counted(
    recorded: Recorded, monkeypatch: pytest.MonkeyPatch
) -> None:
    held, begin_files, in_time = threading.Event(), StreamFiles._begin, list[bool]()

    def slow(*arguments: Any) -> None:
        in_time.append(held.wait(PATIENCE))
        begin_files(*arguments)

    monkeypatch.setattr(StreamFiles, "_begin", slow)
    recorded.session.take(ON, "")
    for number in range(100):
        recorded.feed.show(seen_of(number))
    state = recorded.panel.state()
    held.set()
    recorded.session.take(OFF, "")
    finished = recorded.finished()
    assert all(in_time)  # all were shown while the disk was held
    assert state.dropped == pytest.approx(70, abs=1)
    assert finished.frames + finished.dropped == 100
    folder = Path("runs") / finished.folder
    assert json.loads((folder / "recording.json").read_text())["dropped"] == finished.dropped


def test_a_disk_that_is_nearly_full_ends_it_in_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    real = shutil.disk_usage
    made = Recorded(RecordingParameters(space=SpaceParameters(keep_free=100.0, keep_share=1.0)))
    with made.recorder, made.session:
        made.session.take(ON, "")
        made.show(range(5))
        monkeypatch.setattr(shutil, "disk_usage", lambda path: real(path)._replace(free=90_000_000))
        made.feed.show(seen_of(5))
        finished = made.finished()
        assert finished.ended == "stopped, since only 90 MB are free on its disk"
        assert finished.frames == 5
        assert len(read_tracks(Path("runs") / finished.folder / "tracks.csv")) == 5
        with pytest.raises(ValueError, match="nothing can be recorded: only 90 MB are free"):
            made.session.take(ON, "")
        assert [path.name for path in Path("runs").iterdir()] == [finished.folder]


@pytest.mark.parametrize("guard", [True, False])
def test_a_small_disk_is_filled_with_whole_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, guard: bool) -> None:
    pytest.importorskip("mcap")
    disk = tmp_path / "disk"
    disk.mkdir()
    with contextlib.ExitStack() as stack:
        try:
            stack.enter_context(small_disk(disk, 700_000))
        except OSError as error:
            pytest.skip(f"a small disk cannot be mounted here: {error}")
        stack.callback(monkeypatch.chdir, tmp_path)
        monkeypatch.chdir(disk)
        space = SpaceParameters(keep_free=0.15, keep_share=1.0) if guard else NO_GUARD
        made = Recorded(RecordingParameters(space=space))
        with made.recorder, made.session:
            made.session.take(ON, "")
            made.show(range(3000))
            finished = made.finished()
        words = "MB are free on its disk" if guard else "No space left on device"
        assert words in finished.ended
        assert (shutil.disk_usage(disk).free > 50_000) == guard
        folder = Path("runs") / finished.folder
        topics = [message.topic for message in McapReader(folder / "recording.mcap")]
        assert topics.count("/camera_1/image/compressed") - finished.frames in (0, 1)
        assert len(read_tracks(folder / "tracks.csv")) - finished.frames in (0, 1)
        assert len(read_poses(folder / "poses.csv")) - finished.frames in (0, 1)


def test_a_full_disk_leaves_whole_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (60_000, before[1]))
    try:
        made = Recorded(RecordingParameters(space=NO_GUARD))
        with made.recorder, made.session:
            made.session.take(ON, "")
            made.show(range(200))
            finished = made.finished()
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    folder = Path("runs") / finished.folder
    assert "File too large" in finished.ended
    assert 5 < finished.frames < 200
    assert len(read_tracks(folder / "tracks.csv")) - finished.frames in (0, 1)
    if (folder / "recording.mcap").exists():
        topics = [message.topic for message in McapReader(folder / "recording.mcap")]
        assert topics.count("/camera_1/image/compressed") == finished.frames


@pytest.mark.parametrize(
    ("told", "counted", "live", "rate"),
    [
        (30.0, 29.0, True, 30.0),
        (30.0, 15.0, True, 15.0),
        (None, 12.0, True, 12.0),
        (None, None, True, 30.0),
        (25.0, 80.0, False, 25.0),
    ],
)
def test_the_video_has_the_rate_at_which_pictures_come(
    told: float | None, counted: float | None, live: bool, rate: float
) -> None:
    state = State(1, 0, 0.0, *(160, 120), camera_fps=told, fps=counted, live=live)
    assert FileParameters().rate(state) == rate


def test_parameters_have_limits() -> None:
    with pytest.raises(ValueError, match="bag_quality"):
        FileParameters(bag_quality=0)
    parameters = RecordingParameters()
    assert [parameters.most_waiting(size) for size in (0, 640 * 480 * 3, 3840 * 2160 * 3, 10**9)] == [30, 30, 8, 1]
