"""A click in the middle of a video is followed to both ends, as trackers by hand would."""

import csv
import math
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

import matchset as ms
from matchset.app.locate.rows import read_poses
from matchset.app.track.rows import read_tracks
from matchset.live.files.exports import _Painter
from matchset.live.files.file_feed import FileFeed
from matchset.live.files.file_target import FOUND, LOST, UNKNOWN
from matchset.live.files.messages import Correct, Export, Seek, StopExport
from matchset.live.files.panel import FileState, columns, run_lengths
from matchset.live.files.series import Series, SeriesParameters
from matchset.live.targets.messages import Diameter, Drop, FieldOfView, Pick
from matchset.localization.pose import Pose
from matchset.media.frame_list import StampedVideo

FRAMES, WIDTH, HEIGHT = 60, 320, 240
GONE = range(40, 46)  # frames in which the ball is hidden
CLICK = 25


def center(index: int) -> tuple[float, float]:
    return 160.0 + 90.0 * math.sin(0.09 * (index - 30)), 120.0 + 0.5 * index


def other(index: int) -> tuple[float, float]:
    return 40.0, 60.0 + index


def picture(index: int) -> Any:
    image = np.random.default_rng(index).integers(85, 95, (HEIGHT, WIDTH, 3)).astype(np.uint8)
    balls = [(other(index), 14.0, (40, 160, 60))]
    if index not in GONE:
        balls.append((center(index), 22.0, (200, 60, 30)))
    for (x, y), radius, color in balls:
        cv2.circle(image, (round(16 * x), round(16 * y)), round(16 * radius), color, cv2.FILLED, cv2.LINE_AA, 4)
    return image


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    video = tmp_path_factory.mktemp("video") / "ball.avi"
    writer = cv2.VideoWriter(str(video), cv2.VideoWriter.fourcc(*"MJPG"), 30.0, (WIDTH, HEIGHT))
    for index in range(FRAMES):
        writer.write(picture(index))
    writer.release()
    return video


@pytest.fixture
def notes() -> list[str]:
    return []


@pytest.fixture
def feed(path: Path, notes: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[FileFeed]:
    monkeypatch.chdir(tmp_path)
    with FileFeed("ball.avi", lambda: StampedVideo(path), lambda _: None, notes.append) as made:
        wait(lambda: made.frames.complete and made.seen.frame is not None)
        yield made


def wait(condition: Callable[[], object], seconds: float = 60.0) -> None:
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "not in time"
        time.sleep(0.005)


def told(feed: FileFeed) -> FileState:
    state = feed.panel.state()
    assert state is not None
    return state


def go(feed: FileFeed, index: int) -> int:
    """Show a frame; returns the number of its picture."""
    feed.panel.take(Seek(index), "")
    wait(lambda: feed.seen.state.index == index)
    return feed.seen.state.sequence


def tracked(feed: FileFeed, count: int = 1) -> None:
    wait(lambda: len(feed.tracking.targets) == count and not feed.tracking.busy)


def by_hand(path: Path, click: int, backward: bool) -> dict[int, Any]:
    """What a tracker finds from the click on, by index."""
    with ms.Video(path) as video:
        frames = list(video)
    start = frames[click]
    tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(start.image, *center(click)), start=center(click))
    ways = frames[click::-1] if backward else frames[click:]
    mirrored = [ms.Frame(each.image, 2 * start.time - each.time, each.index) if backward else each for each in ways]
    return {frame.index: tracker.update(frame) for frame in mirrored}


def test_forward_and_backward_are_what_trackers_by_hand_find(feed: FileFeed, path: Path) -> None:
    feed.ask(Pick(go(feed, CLICK), *center(CLICK)))
    tracked(feed)
    target = feed.tracking.targets[1]
    forward, backward = by_hand(path, CLICK, False), by_hand(path, CLICK, True)
    for place in range(FRAMES):
        answer, right = target.answer(place), (backward if place < CLICK else forward)[place]
        assert answer is not None
        assert isinstance(answer, ms.Track) == isinstance(right, ms.Track)
        assert answer.time == feed.frames[place].time
        if isinstance(right, ms.Track) and isinstance(answer, ms.Track):
            assert answer.shape == right.shape
            assert math.dist((right.shape.x, right.shape.y), center(place)) < 0.5
    found = [place for place in range(FRAMES) if isinstance(target.answer(place), ms.Track)]
    assert found == [place for place in range(FRAMES) if place not in GONE]


def test_the_page_is_told_at_once_of_any_frame(feed: FileFeed) -> None:
    assert told(feed).computing == {}
    feed.ask(Pick(go(feed, CLICK), *center(CLICK)))
    tracked(feed)
    wait(lambda: told(feed).computing)
    assert 0.0 < told(feed).computing["mean"] <= told(feed).computing["worst"]
    for index in (0, 59, 12):
        go(feed, index)
        wait(lambda: feed.seen.state.targets)
        (state,) = feed.seen.state.targets
        assert state.found
        assert math.dist((state.values["x"][0], state.values["y"][0]), center(index)) < 0.5
    go(feed, GONE[2])
    (state,) = feed.seen.state.targets
    assert not state.found
    assert state.reason
    assert state.lost_for == pytest.approx(3 / 30.0, abs=1e-3)
    panel = told(feed)
    assert panel.targets[0].line == [FOUND, 40, LOST, 6, FOUND, 14]
    assert (panel.targets[0].percent, panel.targets[0].found, panel.targets[0].lost) == (100.0, 54, 6)


def test_a_correction_counts_from_its_frame_on(feed: FileFeed) -> None:
    feed.ask(Pick(go(feed, CLICK), *center(CLICK)))
    tracked(feed)
    target = feed.tracking.targets[1]
    before = [target.answer(place) for place in range(FRAMES)]
    feed.panel.take(Correct(1, go(feed, 50), *other(50)), "")
    wait(lambda: len(target.clicks) == 2 and not feed.tracking.busy)
    assert [target.answer(place) for place in range(50)] == before[:50]
    for place in range(50, FRAMES):
        answer = target.answer(place)
        assert isinstance(answer, ms.Track)
        assert math.dist((answer.shape.x, answer.shape.y), other(place)) < 0.5
    feed.panel.take(
        Correct(1, go(feed, 10), *other(10)), ""
    )  # before the first click: up to there, and back to the beginning
    wait(lambda: len(target.clicks) == 3 and not feed.tracking.busy)
    for place in range(CLICK):
        answer = target.answer(place)
        assert isinstance(answer, ms.Track)
        assert math.dist((answer.shape.x, answer.shape.y), other(place)) < 0.5
    assert [target.answer(place) for place in range(CLICK, 50)] == before[CLICK:50]


def test_several_targets_one_is_dropped(feed: FileFeed) -> None:
    sequence = go(feed, CLICK)
    feed.ask(Pick(sequence, *center(CLICK)))
    feed.ask(Pick(sequence, *other(CLICK)))
    tracked(feed, 2)
    assert [line.percent for line in told(feed).targets] == [100.0, 100.0]
    feed.ask(Drop(1))
    wait(lambda: list(feed.tracking.targets) == [2])
    wait(lambda: [state.id for state in feed.seen.state.targets] == [2])


def test_diameter_and_view_locate_what_was_found_before(feed: FileFeed, path: Path) -> None:
    feed.ask(Pick(go(feed, CLICK), *center(CLICK)))
    tracked(feed)
    feed.ask(FieldOfView(1.0))
    feed.ask(Diameter(1, 0.28))
    wait(lambda: feed.seen.state.targets and feed.seen.state.targets[0].position)
    camera = ms.CameraModel.from_fov(WIDTH, HEIGHT, 1.0)
    pose = ms.Localizer(camera, ms.BallTarget(diameter=0.28)).update(by_hand(path, CLICK, False)[CLICK])
    assert isinstance(pose, Pose)
    assert feed.seen.state.targets[0].position["z"][0] == pytest.approx(pose.position[2])
    shown = feed.seen.poses[1]
    assert isinstance(shown, Pose)
    assert shown.position == pytest.approx(pose.position)
    assert shown.yaw is None
    assert feed.seen.state.targets[0].left_out == "± leaves out errors of the camera and of the diameter"
    assert feed.seen.camera is not None
    feed.ask(Diameter(1, 0.14))
    near = 0.6 * pose.position[2]
    wait(lambda: feed.seen.state.targets[0].position["z"][0] < near)


def test_the_course_of_a_target_is_that_of_its_answers(feed: FileFeed) -> None:
    with pytest.raises(ValueError, match="no target 1"):
        feed.course(1)
    feed.ask(Pick(go(feed, CLICK), *center(CLICK)))
    tracked(feed)
    course = feed.course(1)
    assert (course.whole, course.placed, course.names) == (True, False, ["x", "y", "radius"])
    np.testing.assert_array_equal(course.low, course.high)  # a frame a column
    assert course.times == pytest.approx([index / 30.0 for index in range(FRAMES)], abs=1e-4)
    for index in range(FRAMES):
        assert course.lost[index] == (index in GONE)
        assert math.isnan(course.low[0][index]) == (index in GONE)
        assert index in GONE or math.dist((course.low[0][index], course.low[1][index]), center(index)) < 0.5
    feed.ask(FieldOfView(1.0))
    feed.ask(Diameter(1, 0.28))
    wait(lambda: feed.course(1).placed)
    pose = feed.tracking.targets[1].pose(12)
    assert isinstance(pose, Pose)
    assert feed.course(1).low[2][12] == pytest.approx(pose.position[2], abs=1e-4)
    feed.panel.take(Correct(1, go(feed, 50), *other(50)), "")
    wait(lambda: len(feed.tracking.targets[1].clicks) == 2 and not feed.tracking.busy)
    moved = feed.tracking.targets[1].pose(55)
    assert isinstance(moved, Pose)
    assert feed.course(1).low[0][55] == pytest.approx(moved.position[0], abs=1e-4)


def test_a_long_course_has_the_least_and_the_largest_of_each_column(feed: FileFeed) -> None:
    feed.ask(Pick(go(feed, CLICK), *center(CLICK)))
    tracked(feed)
    series = Series(feed.tracking.targets[1], feed.frames, SeriesParameters(columns=12))
    course = series.course()
    assert len(course.times) == len(course.low[0]) == 12
    xs = [math.nan if index in GONE else center(index)[0] for index in range(FRAMES)]
    for column in range(12):
        of = xs[5 * column : 5 * column + 5]
        assert course.lost[column] == any(math.isnan(x) for x in of)
        if not all(math.isnan(x) for x in of):
            assert course.low[0][column] == pytest.approx(np.nanmin(of), abs=0.5)
            assert course.high[0][column] == pytest.approx(np.nanmax(of), abs=0.5)


def test_a_camera_of_another_size_is_refused(feed: FileFeed) -> None:
    with pytest.raises(ValueError, match="640"):
        feed.use(ms.CameraModel.from_fov(640, 480, 1.0))
    assert feed.camera is None


def test_a_click_on_nothing_is_given_up_and_said(feed: FileFeed, notes: list[str]) -> None:
    feed.ask(Pick(go(feed, 0), 300.0, 10.0))
    wait(lambda: notes and not feed.tracking.targets)
    feed.ask(Pick(go(feed, 0), 1000.0, 10.0))
    wait(lambda: len(notes) > 1)
    assert "outside" in notes[1]
    feed.ask(Pick(10**6, 10.0, 10.0))
    wait(lambda: len(notes) > 2)
    assert "click again" in notes[2]


def test_a_thousand_clicks_do_no_harm(feed: FileFeed, notes: list[str]) -> None:
    sequence = go(feed, CLICK)
    for _ in range(1000):
        feed.ask(Pick(sequence, *center(CLICK)))
    wait(lambda: not feed.tracking.busy)
    assert len(feed.tracking.targets) == 1
    assert any("followed already" in words or "too many clicks" in words for words in notes)


def test_tables_are_those_of_the_command_line(feed: FileFeed) -> None:
    feed.ask(FieldOfView(1.0))
    feed.ask(Pick(go(feed, CLICK), *center(CLICK)))
    feed.ask(Diameter(1, 0.28))
    tracked(feed)
    feed.panel.take(Export(1, "tables"), "")
    wait(lambda: len(feed.exports.written) == 2 and feed.exports.working is None)
    files = feed.panel.downloads()
    tracks, poses = read_tracks(files["tracks-1.csv"]), read_poses(files["poses-1.csv"])
    assert [row.frame for row in tracks] == [row.frame for row in poses] == list(range(FRAMES))
    assert [row.frame for row in tracks if not row.found] == list(GONE)
    for row in tracks:
        assert row.shape is None or math.dist((row.shape["x"], row.shape["y"]), center(row.frame)) < 0.5
    with files["tracks-1.csv"].open() as file:
        header = next(csv.reader(file))
    assert header == ["frame", "time", "found", "x", "y", "radius", "x_std", "y_std", "radius_std", "support", "reason"]


def test_the_annotated_video_has_every_frame(feed: FileFeed) -> None:
    feed.ask(Pick(go(feed, CLICK), *center(CLICK)))
    feed.ask(Pick(go(feed, CLICK), *other(CLICK)))
    tracked(feed, 2)
    feed.panel.take(Export(1, "film"), "")
    with pytest.raises(ValueError, match="is being written"):
        feed.panel.take(Export(1, "tables"), "")
    wait(lambda: feed.exports.working is None)
    ((_, film),) = feed.panel.downloads().items()
    with ms.Video(film) as video:
        assert len(list(video)) == FRAMES
        assert video.height > HEIGHT


def test_a_film_that_is_stopped_leaves_nothing(feed: FileFeed, monkeypatch: pytest.MonkeyPatch) -> None:
    feed.ask(Pick(go(feed, CLICK), *center(CLICK)))
    tracked(feed)
    begun, stopped = threading.Event(), threading.Event()
    paint = _Painter.paint

    def slowly(painter: _Painter, place: int, frame: ms.Frame) -> Any:
        begun.set()
        assert stopped.wait(20.0)
        return paint(painter, place, frame)

    monkeypatch.setattr(_Painter, "paint", slowly)
    feed.panel.take(Export(1, "film"), "")
    assert begun.wait(20.0)
    working = told(feed).working
    assert working is not None
    feed.panel.take(StopExport(), "")
    stopped.set()
    wait(lambda: feed.exports.working is None)
    assert feed.panel.downloads() == {}
    assert [path.name for path in Path("runs").glob("*/*")] == []


def test_nothing_to_write_is_said(feed: FileFeed) -> None:
    with pytest.raises(ValueError, match="nothing to write of target 7"):
        feed.panel.take(Export(7, "tables"), "")


def test_a_column_of_many_frames_shows_a_loss() -> None:
    codes = np.zeros(30_000, np.uint8)
    codes[:20_000] = FOUND
    codes[777] = LOST
    reduced = columns(codes, 1500)
    assert len(reduced) == 1500
    assert reduced[777 * 1500 // 30_000] == LOST
    assert run_lengths(reduced) == [FOUND, 38, LOST, 1, FOUND, 961, UNKNOWN, 500]
    assert run_lengths(np.array([2], np.uint8)) == [2, 1]
