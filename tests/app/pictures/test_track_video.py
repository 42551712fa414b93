"""`ms.write_video` and the trail and colors of `ms.draw`."""

import itertools
import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

import matchset as ms
from matchset.app.drawing.annotate import OUTLINE
from matchset.app.drawing.draw import TARGETS

IMAGE = np.full((240, 320, 3), 90, np.uint8)
RED, GREEN = (40, 40, 250), (40, 250, 40)


def track_at(x: float, y: float = 50.0, time: float = 0.0) -> ms.Track[ms.Circle]:
    return ms.Track(ms.Circle(x, y, 10.0), 0.01 * np.eye(3), 1.0, np.empty((0, 2)), time)


LOST: ms.Lost[ms.Circle] = ms.Lost("gone", 0.0, ms.Circle(100.0, 50.0, 10.0))
WAY = [track_at(x) for x in (30.0, 40.0, 50.0)]


def pixels(image: np.ndarray, color: tuple[int, int, int], near: int = 60) -> np.ndarray:
    rows, columns = np.nonzero((np.abs(image[:95].astype(int) - color) < near).all(axis=2))
    return np.column_stack((columns, rows))


def frames_in(path: Path) -> list[np.ndarray]:
    video = cv2.VideoCapture(str(path))
    return [np.asarray(image) for _, image in itertools.takewhile(lambda read: read[0], iter(video.read, None))]


def test_the_trail_leads_to_where_it_is_now() -> None:
    plain, drawn = (ms.draw(IMAGE, track_at(90.0), False, trail=way) for way in (None, WAY))
    changed = np.flatnonzero((plain != drawn).any(axis=(0, 2)))
    assert changed.min() >= 28
    assert set(range(40, 78)) <= set(changed.tolist())  # from the second of the last 40 on, ever stronger
    assert not (plain != drawn)[60:].any()


def test_a_loss_interrupts_the_trail() -> None:
    ended: list[Any] = [*WAY, LOST]
    drawn = ms.draw(IMAGE, track_at(90.0), False, trail=ended)
    assert not (drawn[:, 52:78] != 90).any()
    assert (drawn[:, 40:50] != 90).any()
    assert np.array_equal(ms.draw(IMAGE, LOST, trail=[]), ms.draw(IMAGE, LOST))


def test_each_of_several_targets_has_its_color() -> None:
    first, second = track_at(40.0), track_at(120.0)
    drawn = ms.draw(IMAGE, [first, second], words=False, colors=[RED, GREEN])
    assert pixels(drawn, RED)[:, 0].max() < 55
    assert pixels(drawn, GREEN)[:, 0].min() > 105
    default = ms.draw(IMAGE, [first, second], words=False)
    assert len(pixels(default, TARGETS[0], 30)) > 20
    assert len(pixels(default, TARGETS[1], 30)) > 20
    assert len(pixels(ms.draw(IMAGE, first, words=False), OUTLINE)) > 20
    again = ms.draw(IMAGE, [first, second], words=False, colors=[RED])
    assert pixels(again, RED)[:, 0].max() > 105


def test_a_lost_target_is_dashed_in_its_color_and_trails_have_it() -> None:
    ways = [[track_at(20.0), track_at(30.0)], [track_at(80.0), track_at(90.0)]]
    drawn = ms.draw(IMAGE, [track_at(40.0), LOST], words=False, trail=ways, colors=[RED, GREEN])
    assert 8 < len(pixels(drawn, GREEN, 90)) < len(pixels(drawn, RED, 90))


@pytest.mark.parametrize("ending", ["mp4", "webm", "avi"])
def test_a_video_has_every_frame_with_what_was_found(tmp_path: Path, ending: str) -> None:
    frames = [ms.Frame(IMAGE, index / 25.0, index) for index in range(12)]
    tracks: list[Any] = [track_at(30.0 + 8.0 * index) for index in range(11)] + [LOST]
    path = ms.write_video(str(tmp_path / f"found.{ending}"), frames, tracks, trail=False, colors=[RED])
    assert path == tmp_path / f"found.{ending}"
    shown = frames_in(path)
    assert len(shown) == 12
    for index, image in enumerate(shown[:11]):
        rim = (np.abs(image[38:62].astype(int) - 90) > 40).any(axis=2)
        assert np.flatnonzero(rim.any(axis=0)).mean() == pytest.approx(30.0 + 8.0 * index, abs=2.0)
    assert cv2.VideoCapture(str(path)).get(cv2.CAP_PROP_FPS) == pytest.approx(25.0, rel=0.01)


def test_frames_are_taken_one_at_a_time_and_several_targets_have_trails(tmp_path: Path) -> None:
    alive: list[int] = []

    def frames() -> Iterator[np.ndarray]:
        for index in range(40):
            alive.append(index)
            yield IMAGE.copy()

    def tracks() -> Iterator[list[Any]]:
        for index in range(40):
            assert len(alive) <= max(index + 1, 9) + 1
            yield [track_at(30.0 + 2.0 * index), LOST if index % 3 else track_at(100.0, 80.0)]

    path = ms.write_video(tmp_path / "two.mp4", frames(), tracks())
    shown = frames_in(path)
    assert len(shown) == 40
    assert (np.abs(shown[-1][50, 60:90].astype(int) - 90) > 15).any()  # the way it has come
    assert cv2.VideoCapture(str(path)).get(cv2.CAP_PROP_FPS) == pytest.approx(30.0)


def test_a_video_and_gray_pictures_will_do(tmp_path: Path) -> None:
    ms.write_video(tmp_path / "a.avi", [IMAGE[..., 0]] * 5, [track_at(50.0)] * 5, fps=10.0)
    with ms.Video(tmp_path / "a.avi") as video:
        ms.write_video(tmp_path / "b.avi", video, [LOST] * 5)
    with ms.Video(tmp_path / "b.avi") as again:
        assert again.fps == pytest.approx(10.0)
        assert sum(1 for _ in again) == 5


def test_a_video_of_another_length_than_its_tracks_keeps_what_it_has(tmp_path: Path) -> None:
    path = tmp_path / "short.avi"
    for frames, tracks, words in ((5, 3, "more frames than the 3"), (3, 5, "more tracks than the 3")):
        with pytest.raises(ValueError, match=words):
            ms.write_video(path, [IMAGE] * frames, [track_at(50.0)] * tracks)
        assert len(frames_in(path)) == 3


make: Any = ms
MISUSE: dict[str, tuple[Callable[[Path], object], type[Exception], str]] = {
    "ending": (lambda at: ms.write_video(at / "a.png", [IMAGE], [LOST]), ValueError, "must end in .mp4, .webm, .avi"),
    "no frame": (lambda at: ms.write_video(at / "a.avi", [], []), ValueError, "there is no frame to write"),
    "fps": (lambda at: ms.write_video(at / "a.avi", [IMAGE], [LOST], fps=0.0), ValueError, "must be positive, got 0.0"),
    "nan": (lambda at: ms.write_video(at / "a.avi", [IMAGE], [LOST], fps=math.nan), ValueError, "positive, got nan"),
    "no folder": (lambda at: ms.write_video(at / "b" / "a.avi", [IMAGE], [LOST]), ValueError, "cannot write"),
    "no track": (lambda at: make.write_video(at / "a.avi", [IMAGE], [[3]]), TypeError, "Track or Lost, got int 3"),
    "targets": (
        lambda at: ms.write_video(at / "a.avi", [IMAGE] * 2, [[LOST], [LOST, LOST]]),
        ValueError,
        "as many tracks as the first, 1, frame 1 has 2",
    ),
    "color": (lambda _: make.draw(IMAGE, LOST, colors=[(0, 0, 256)]), ValueError, r"got \(0, 0, 256\)"),
    "color, a word": (lambda _: make.draw(IMAGE, LOST, colors=["red"]), ValueError, "0 ... 255, got 'red'"),
    "no color": (lambda _: ms.draw(IMAGE, LOST, colors=[]), ValueError, "one color .* or more, got none"),
    "trails": (lambda _: ms.draw(IMAGE, [LOST, LOST], trail=[[LOST]]), ValueError, "each of 2 tracks, got 1"),
    "one trail": (lambda _: ms.draw(IMAGE, [LOST, LOST], trail=[LOST]), ValueError, "2 tracks, got one for all"),
    "trail": (lambda _: make.draw(IMAGE, LOST, trail=[3]), TypeError, "what a trail holds must be a Track or Lost"),
}


@pytest.mark.parametrize("name", MISUSE)
def test_misuse_is_refused_in_words(name: str, tmp_path: Path) -> None:
    call, error, words = MISUSE[name]
    with pytest.raises(error, match=words):
        call(tmp_path)
