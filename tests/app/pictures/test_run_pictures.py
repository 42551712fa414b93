"""What a run shows of itself: video, summary, animation, a part, and what each answer took."""

import csv
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image

from blue_ball import CENTERS, SIZE, Matchset, ball_picture
from matchset.app.course.log import ShapeLog
from matchset.app.drawing.annotate import OUTLINE, PREDICTED, TrackPainter
from matchset.app.drawing.status_strip import StatusStrip
from matchset.app.drawing.text import text_width, wrapped
from matchset.app.films.video_writer import quick_ending
from matchset.app.pictures.animation import Animation
from matchset.app.pictures.film import FilmParameters, RunFilm
from matchset.app.pictures.part import FrameOrTime, VideoPart
from matchset.app.pictures.summary import Summary
from matchset.app.track.loop import TrackedFrame
from matchset.app.track.rows import TrackRow, read_tracks, track_row
from matchset.image.frame import Frame
from matchset.shapes.circle import Circle
from matchset.tracking.track import Lost, Track


def frames_of(path: Path) -> int:
    video = cv2.VideoCapture(str(path))
    return next(count for count in range(100_000) if not video.grab())


@pytest.mark.usefixtures("no_path_picture")
@pytest.mark.parametrize(
    ("words", "name"), [(("track",), "track"), (("locate", "--fov", "60", "--diameter", "0.2"), "locate")]
)
def test_a_run_leaves_a_video_a_summary_and_latencies(
    matchset: Matchset, ball_video: Path, words: tuple[str, ...], name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert matchset(words[0], ball_video, *words[1:], "--pick", "50,60") == 0
    folder = Path(f"runs/0001-{name}")
    film = name + quick_ending()
    assert frames_of(folder / film) == len(CENTERS)
    sheet = cv2.imread(str(folder / "summary.png"))
    assert sheet is not None
    assert (sheet == OUTLINE).all(axis=2).any()
    with (folder / "latency.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [int(row["frame"]) for row in rows] == list(range(len(CENTERS)))
    assert all(0.0 < float(row["compute_ms"]) < 10_000.0 and row["age_ms"] == "" for row in rows)
    out = capsys.readouterr().out
    for each in (film, "summary.png", "latency.csv"):
        assert str(folder / each) in out


def test_no_video_writes_tables_only(matchset: Matchset, ball_video: Path) -> None:
    assert matchset("track", ball_video, "--pick", "50,60", "--no-video", "-o", "out") == 0
    assert sorted(path.name for path in Path("out").iterdir()) == ["latency.csv", "tracks.csv"]


def test_a_run_that_prints_writes_tables_only(
    matchset: Matchset, ball_video: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert matchset("track", ball_video, "--pick", "50,60", "--print", "-o", "out") == 0
    assert sorted(path.name for path in Path("out").iterdir()) == ["latency.csv", "tracks.csv"]
    assert len(capsys.readouterr().out.splitlines()) == len(CENTERS)


def test_the_video_that_is_asked_for_may_have_any_name(matchset: Matchset, ball_video: Path) -> None:
    assert matchset("track", ball_video, "--pick", "50,60", "-o", "out", "--video", "out/track.webm") == 0
    assert sorted(path.name for path in Path("out").iterdir()) == [
        "latency.csv",
        "summary.png",
        "track.webm",
        "tracks.csv",
    ]
    assert frames_of(Path("out/track.webm")) == len(CENTERS)


def test_a_part_after_the_end_says_where_that_is(
    matchset: Matchset, ball_video: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert matchset("track", ball_video, "--pick", "50,60", "--start", "5000") == 2
    last = len(CENTERS) - 1
    assert f"error: --start is after the last frame, {last} at" in capsys.readouterr().err


@pytest.mark.parametrize(("start", "end"), [("10", "20"), ("0.334s", "0.66s")])
def test_a_part_is_tracked_and_animated(matchset: Matchset, ball_video: Path, start: str, end: str) -> None:
    command = "track", ball_video, "--pick", "50,60", "--start", start, "--end", end, "--gif"
    for name in ("part.gif", "part.webp"):
        assert matchset(*command, name, "-o", name[-4:]) == 0
        rows = read_tracks(Path(name[-4:]) / "tracks.csv")
        assert [row.frame for row in rows] == list(range(rows[0].frame, rows[0].frame + len(rows)))
        assert rows[0].frame in (10, 11)
        assert rows[-1].frame == 19
        assert all(row.found for row in rows)
        with Image.open(name) as picture:
            assert picture.n_frames >= 4  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--start", "ten"), "--start is a frame, as in 120, or seconds, as in 4.5s, got 'ten'"),
        (("--start", "20", "--end", "20"), "is not after"),
        (("--gif", "a.png"), "must end in .gif or .webp"),
    ],
)
def test_a_wrong_part_is_one_line_and_leaves_nothing(
    matchset: Matchset, ball_video: Path, options: tuple[str, ...], words: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert matchset("track", ball_video, "--pick", "50,60", *options) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert words in line
    assert list(Path().iterdir()) == []


def test_seconds_count_from_the_first_frame() -> None:
    frames = [Frame(np.zeros((4, 4), np.uint8), 1000.0 + 0.1 * index, index) for index in range(10)]
    part = VideoPart(FrameOrTime(seconds=0.2), FrameOrTime(seconds=0.5))
    assert [frame.index for frame in part.of(frames)] == [2, 3, 4]


@pytest.mark.parametrize(("fps", "seconds"), [(30.0, 4.0), (24.0, 5.0), (7.0, 120.0 / 7.0)])
def test_an_animation_is_shown_at_the_speed_of_the_video(tmp_path: Path, fps: float, seconds: float) -> None:
    animation = Animation(tmp_path / "a.gif", fps)
    for index in range(120):
        animation.append(np.full((24, 32, 3), 2 * index, np.uint8))
    animation.close()
    with Image.open(tmp_path / "a.gif") as picture:
        shown_ms = 0
        for index in range(picture.n_frames):  # type: ignore[attr-defined]
            picture.seek(index)
            shown_ms += picture.info["duration"]
    assert shown_ms == pytest.approx(1000.0 * seconds, abs=10.0)


def test_a_video_that_nobody_asked_for_is_reduced_and_ends(tmp_path: Path) -> None:
    film = RunFilm(tmp_path / "a.webm", 30.0, (160, 130), limits=FilmParameters(pixels=80 * 65, pictures=5))
    for _ in range(9):
        film.write(np.zeros((130, 160, 3), np.uint8))
    film.close()
    assert frames_of(tmp_path / "a.webm") == 5
    assert "ends after 5 frames" in film.ending
    video = cv2.VideoCapture(str(tmp_path / "a.webm"))
    assert video.get(cv2.CAP_PROP_FRAME_WIDTH) == 80


def circle_track(x: float) -> Track[Circle]:
    return Track(Circle(x, 40.0, 20.0), np.eye(3) * 0.09, 0.95, np.empty((0, 2)), 1.0)


@pytest.mark.parametrize("size", [(480, 848), (320, 240), (480, 360), (640, 480), (160, 120), (1920, 1080)])
def test_the_strip_hides_nothing_and_cuts_nothing(size: tuple[int, int], monkeypatch: pytest.MonkeyPatch) -> None:
    written: list[tuple[str, float]] = []

    def note(image: np.ndarray, text: str, at: tuple[float, float], font: int = 14, color: object = None) -> None:
        written.append((text, at[0] + text_width(text, font)))

    painter = TrackPainter(size, Circle.parameters)
    frame = Frame(np.full((size[1], size[0], 3), 90, np.uint8), 98.76, 12345)
    lost: Lost[Circle] = Lost("it would have jumped or changed its size faster than it can", 98.76)
    plain = painter.paint(frame, lost, track_row(12345, lost))
    assert plain.shape == (painter.size[1], painter.size[0], 3)
    assert (plain[: size[1]] == 90).all()
    monkeypatch.setattr("matchset.app.drawing.status_strip.draw_text", note)
    for answer in (circle_track(100.0), lost):
        written.clear()
        painter.paint(frame, answer, track_row(12345, answer))
        whole = " ".join(text for text, _ in written)
        assert all(right <= size[0] for _, right in written)
        assert "frame 12345" in whole
        words = ("support 95 %", "radius") if answer else ("faster than it can",)
        assert all(word in whole for word in words)


def test_the_trail_shows_the_way_and_ends_where_it_was_lost() -> None:
    painter = TrackPainter((160, 120), Circle.parameters)
    frame = Frame(np.full((120, 160, 3), 90, np.uint8), 0.0, 0)
    lost: Lost[Circle] = Lost("gone", 0.0)
    for x in (20.0, 40.0, 60.0):
        picture = painter.paint(frame, circle_track(x), TrackRow(0, 0.0, {"x": x, "y": 40.0, "radius": 20.0}))
    assert (picture[40, 45:59] != 90).any()
    for answer in (lost, circle_track(120.0)):
        picture = painter.paint(frame, answer, track_row(0, answer))
    assert (picture[40, 75:95] == 90).all()


def test_the_time_stays_at_its_place(monkeypatch: pytest.MonkeyPatch) -> None:
    places: dict[str, float] = {}
    monkeypatch.setattr(
        "matchset.app.drawing.status_strip.draw_text", lambda _, text, at, *__: places.__setitem__(text, at[1])
    )
    strip, image = StatusStrip(480, 360, [("x " * 120, "frame 10000")]), np.zeros((360, 480, 3), np.uint8)
    for left, right in (("short", "frame 1"), ("x " * 115, "frame 2")):
        strip.below(image, [(left, right)], OUTLINE)
    assert places["frame 1"] == places["frame 2"]


def test_a_strip_of_any_text_keeps_its_height() -> None:
    strip = StatusStrip(320, 240, [("short", "right")])
    image = np.zeros((240, 320, 3), np.uint8)
    heights = {strip.below(image, [(text, "right")], PREDICTED).shape[0] for text in ("", "a", "word " * 60, "x" * 400)}
    assert len(heights) == 1


def test_words_are_wrapped_at_their_spaces() -> None:
    lines = wrapped("one two three four", text_width("three four", 14) + 1, 14)
    assert lines == ["one two", "three four"]
    assert wrapped("", 50) == [""]
    assert all(text_width(line, 14) <= 60 for line in wrapped("incomprehensibilities", 60, 14))


def test_a_shape_demo_has_a_sheet_and_right_words(matchset: Matchset, capsys: pytest.CaptureFixture[str]) -> None:
    assert matchset("demo", "--shape", "0,0 4,0 0,3", "--frames", "12", "-o", "out") == 0
    assert "A blue shape with 3 corners in a room" in capsys.readouterr().out
    assert cv2.imread("out/sheet.png") is not None


def summary_height(*words: object, matchset: Matchset, code: int = 0) -> int:
    assert matchset("track", *words, "-o", "out", "--force") == code
    sheet = cv2.imread("out/summary.png")
    assert sheet is not None
    return int(sheet.shape[0])


def test_the_summary_has_curves_where_something_was_found(matchset: Matchset, ball_video: Path) -> None:
    found = summary_height(ball_video, "--pick", "50,60", matchset=matchset)
    none = summary_height(ball_video, "--hsv", "60,200,200:70,255,255", matchset=matchset, code=1)
    assert found - none == pytest.approx(425, abs=80)  # the words below its tiles take lines, too


def test_a_single_picture_has_a_summary_with_dots(matchset: Matchset) -> None:
    cv2.imwrite("one.png", ball_picture((60.0, 60.0)))
    assert summary_height("one.png", "--pick", "60,60", matchset=matchset) > 425


def test_a_summary_counts_frames_that_could_not_be_decoded() -> None:
    summary, frame = Summary(), Frame(np.full((40, 60, 3), 90, np.uint8))
    log = ShapeLog(Circle)
    for index in range(10):
        lost = index in (4, 5)
        answer: Track[Circle] | Lost[Circle] = Lost("frame could not be decoded", 0.1 * index)
        if not lost:
            answer = Track(Circle(20.0 + index, 15.0, 8.0), 0.01 * np.eye(3), 1.0, np.empty((0, 2)), 0.1 * index)
        tracked = TrackedFrame(None if lost else frame, answer, track_row(index, answer))
        log.add(tracked)
        summary.append(tracked.frame, answer, tracked.row)
    assert summary.words == "found in 8 of 10 frames (80.0 %)"
    assert np.flatnonzero(~log.course.found).tolist() == [4, 5]
    assert summary.picture("clip", log.course).shape[1] == 1480


def test_the_summary_of_a_portrait_video_fits_a_screen(matchset: Matchset) -> None:
    Path("frames").mkdir()
    for index in range(6):
        picture = cv2.copyMakeBorder(ball_picture((60.0, 60.0)), 80, 80, 0, 0, cv2.BORDER_REPLICATE)
        cv2.imwrite(f"frames/{index}.png", picture)
    assert SIZE[0] == 160
    assert matchset("track", "frames", "--pick", "60,140", "-o", "out") == 0
    sheet = cv2.imread("out/summary.png")
    assert sheet is not None
    assert sheet.shape[0] < 1400
