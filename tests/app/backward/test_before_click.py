"""What came before a click: followed back from it, in order of time, in files of every kind and interlaced pictures."""

import csv
import functools
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from benchmarks.tracking.trial import sequence

import matchset as ms
from blue_ball import Matchset
from matchset.app.backward.before_click import NO_WAY_BACK, before_click
from matchset.app.backward.follow_back import follow_back
from matchset.app.backward.known_answers import STOPPED
from matchset.app.backward.mirrored import MirroredTracker
from matchset.app.cli_options import GrayTargetOptions, ShownOptions
from matchset.app.exit_codes import StopRequest
from matchset.app.locate.rows import read_poses
from matchset.app.pictures.part import VideoPart
from matchset.app.target.target_options import LearnedTarget
from matchset.app.track.options import TrackOptions
from matchset.app.track.rows import read_tracks
from matchset.app.track.score import circles, error_px, read_truth, score
from matchset.media.frame_list import StampedVideo
from matchset.tracking.track import Acquisition

SIZE = 320, 240
FRAMES, CLICK = 40, 30
RADIUS = 18.0


def place(index: int) -> tuple[float, float]:
    """Where the small ball is: it passes a large one of its color that is there all the time."""
    return 40.0 + 5.0 * index, 170.0


def picture(index: int) -> np.ndarray:
    image = np.full((SIZE[1], SIZE[0], 3), 150, np.uint8)
    cv2.circle(image, (16 * 160, 16 * 70), 16 * 50, (190, 70, 30), cv2.FILLED, cv2.LINE_AA, 4)
    x, y = place(index)
    cv2.circle(image, (round(16 * x), round(16 * y)), round(16 * RADIUS), (190, 70, 30), cv2.FILLED, cv2.LINE_AA, 4)
    noise = np.random.default_rng(index).normal(0.0, 2.0, image.shape)
    blurred = cv2.GaussianBlur(image, (0, 0), 0.8)
    return np.asarray((blurred + noise).clip(0, 255), np.uint8)


@pytest.fixture(scope="module")
def passing(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("passing") / "passing.avi"
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 25.0, SIZE)
    for index in range(FRAMES):
        writer.write(picture(index))
    writer.release()
    return path


def click(index: int = CLICK) -> str:
    x, y = place(index)
    return f"{x:.0f},{y:.0f}@{index}"


def check_rows(path: Path, first: int = 0, end: int = FRAMES) -> None:
    """Every frame has a row, in order of time, with the small ball in it."""
    with path.open() as file:
        lines = [(int(line["frame"]), float(line["time"])) for line in csv.DictReader(file)]
    assert lines == sorted(lines)
    assert [index for index, _ in lines] == list(range(first, end))
    for row in read_tracks(path):
        assert row.shape is not None, row
        assert row.time == pytest.approx(row.frame / 25.0)
        assert math.dist((row.shape["x"], row.shape["y"]), place(row.frame)) < 0.6
        assert row.shape["radius"] == pytest.approx(RADIUS + 0.5, abs=0.4)  # OpenCV's discs are half a pixel larger


def test_a_click_late_in_a_video_is_followed_back_to_its_first_frame(
    matchset: Matchset, passing: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert matchset("track", passing, "--pick", click(), "--no-video", "-o", "out") == 0
    check_rows(Path("out/tracks.csv"))
    assert f"note: followed backward from the click in frame {CLICK} to frame 0" in capsys.readouterr().err
    with Path("out/latency.csv").open() as file:
        assert all(float(line["compute_ms"]) > 0.0 for line in csv.DictReader(file))


def test_a_folder_of_pictures_and_a_part_are_followed_back_too(
    matchset: Matchset, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("frames").mkdir()
    for index in range(FRAMES):
        cv2.imwrite(f"frames/{index}.png", picture(index))
    options = "--fps", 25, "--no-video", "--pick", click()
    assert matchset("track", "frames", *options, "--start", 12, "--end", 20, "-o", "out") == 0
    check_rows(Path("out/tracks.csv"), 12, 20)
    assert "to frame 12" in capsys.readouterr().err
    assert matchset("track", "frames", *options, "--start", 35, "-o", "later") == 0
    assert "followed backward" not in capsys.readouterr().err
    assert [row.frame for row in read_tracks("later/tracks.csv")] == list(range(35, FRAMES))


def test_a_click_in_the_first_frame_has_nothing_before_it(
    matchset: Matchset, passing: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert matchset("track", passing, "--pick", click(0), "--no-video", "-o", "out") == 0
    check_rows(Path("out/tracks.csv"))
    assert "followed backward" not in capsys.readouterr().err


@pytest.mark.usefixtures("no_path_picture")
def test_it_is_located_before_the_click_too(matchset: Matchset, passing: Path) -> None:
    ball = "--fov", 60, "--diameter", 0.2, "--pick", click()
    assert matchset("locate", passing, *ball, "--no-video", "-o", "out") == 0
    poses = read_poses("out/poses.csv")
    assert [row.frame for row in poses] == list(range(FRAMES))
    camera = ms.CameraModel.from_fov(*SIZE, math.radians(60.0))
    for row in poses:
        assert row.values is not None
        seen = camera.project(np.array([[row.values[axis] for axis in "xyz"]]))[0]
        assert math.dist(seen.tolist(), place(row.frame)) < 1.5


REAL = Path(__file__).resolve().parents[4] / "shared" / "data" / "green_ball_hand"


@pytest.mark.skipif(not (REAL / "truth.csv").exists(), reason=f"the real clip is not here: {REAL}")
def test_a_real_ball_is_followed_back_from_near_the_end_through_all_that_hides_it(matchset: Matchset) -> None:
    truth = read_truth(REAL / "truth.csv")
    assert matchset("track", REAL / "video.mp4", "--pick", "610,242@960", "--no-video", "-o", "out") == 0
    result = score(circles(read_tracks("out/tracks.csv")), truth)
    assert result.valid_percent is not None
    assert result.mean_error_px is not None
    assert result.valid_percent >= 95.0
    assert result.mean_error_px <= 1.5


def test_a_live_source_says_that_it_has_no_way_back(capsys: pytest.CaptureFixture[str]) -> None:
    options = TrackOptions(source="0", target=GrayTargetOptions(pick="10,10@75"), shown=ShownOptions())
    live: Any = type("Camera", (), {"live": True})()
    target = LearnedTarget(None, (10.0, 10.0), 75)
    assert before_click(options, live, target, lambda *_, **__: pytest.fail("a tracker"), StopRequest()) is None
    assert capsys.readouterr().err == f"note: {NO_WAY_BACK}\n"


class Asked(StopRequest):
    """A stop that comes after so many questions."""

    def __init__(self, after: int) -> None:
        super().__init__()
        self._left = after

    def __bool__(self) -> bool:
        self._left -= 1
        self.code = 130 if self._left < 0 else 0
        return super().__bool__()


def test_a_stop_on_the_way_back_leaves_the_rest_unknown_in_words(passing: Path) -> None:
    frame = ms.Frame(picture(CLICK), CLICK / 25.0, CLICK)
    color = ms.ColorModel.pick(frame.image, *place(CLICK))
    begin = functools.partial(ms.Tracker, ms.Circle, color, start=place(CLICK))
    known = follow_back(functools.partial(StampedVideo, passing), CLICK, begin, VideoPart(), Asked(CLICK + 12))
    assert known is not None
    assert known.update(ms.Frame(frame.image, 1.16, CLICK - 1))
    lost = known.update(ms.Frame(frame.image, 0.0, 0))
    assert isinstance(lost, ms.Lost)
    assert lost.reason == STOPPED


class Echo:
    """A tracker that answers with the time it is told, found since its second frame."""

    def __init__(self) -> None:
        self.times: list[float] = []

    def update(self, frame: ms.Frame) -> ms.Track[ms.Circle] | ms.Lost[ms.Circle]:
        self.times.append(frame.time)
        if len(self.times) == 1:
            return ms.Lost("not yet", frame.time)
        acquired = Acquisition(self.times[1])
        return ms.Track(ms.Circle(1.0, 2.0, 3.0), np.eye(3), 1.0, np.empty((0, 2)), frame.time, acquired)


def test_a_mirrored_tracker_sees_time_run_forward_and_answers_in_the_time_of_the_frames() -> None:
    echo, image = Echo(), np.zeros((4, 4), np.uint8)
    mirrored = MirroredTracker(echo)
    answers = [mirrored.update(ms.Frame(image, time, 0)) for time in (3.0, 2.9, 2.5)]
    assert echo.times == pytest.approx([3.0, 3.1, 3.5])
    assert [answer.time for answer in answers] == [3.0, 2.9, 2.5]
    second, last = answers[1:]
    assert isinstance(second, ms.Track)
    assert isinstance(last, ms.Track)
    assert second.acquired == Acquisition(2.9)
    assert last.acquired is not None
    assert last.acquired.time == pytest.approx(2.9)


@pytest.mark.parametrize("seed", [260, 261])
def test_backward_the_fields_come_in_the_other_order_and_are_followed_as_well(seed: int) -> None:
    clip = sequence("fast", seed, 60)
    pairs = [(frame, truth) for frame, truth in clip if truth.circle is not None]

    def followed(way: list[Any], tracker_of: Any) -> Iterator[tuple[int, Any, float]]:
        frame, truth = way[0]
        start = truth.circle.x, truth.circle.y
        tracker = tracker_of(ms.Tracker(ms.Circle, ms.ColorModel.pick(frame.image, *start), start=start))
        for frame, truth in way:
            answer = tracker.update(frame)
            circle = truth.circle.x, truth.circle.y, truth.circle.radius
            yield frame.index, answer, error_px(tuple(answer.shape.state[:3]), circle) if answer else math.inf

    forward = {index: (answer, error) for index, answer, error in followed(pairs, lambda tracker: tracker)}
    backward = {index: (answer, error) for index, answer, error in followed(pairs[::-1], MirroredTracker)}
    both = range(20, 40)  # both have seen enough
    assert np.mean([backward[index][1] for index in both]) < 1.0
    assert max(error for _, error in backward.values()) < 5.0
    offsets = np.array([[answers[index][0].field_offset for index in both] for answers in (forward, backward)])
    assert np.hypot(*offsets[0].T).max() > 5.0
    assert np.median(np.hypot(*(offsets[0] - offsets[1]).T)) < 1.0  # a distance in the picture, the same both ways
