import csv
import itertools
import json
import re
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from benchmarks.clicks.scenes import draw

from blue_ball import CENTERS, RADIUS, SIZE, Matchset, ball_picture
from matchset.app.track.loop import UNDECODED, RunStatistics, TrackedFrame
from matchset.app.track.rows import read_tracks, track_row
from matchset.image.errors import LinkError
from matchset.image.frame import Frame
from matchset.shapes.circle import Circle
from matchset.tracking.track import Lost

FOUR = re.compile(
    r"tracking took [\d.]+ ms of computing a frame \(median\)\n"
    r"  mean [\d.]+ ms, 95 % within [\d.]+ ms, worst [\d.]+ ms\n"
)


def test_one_click_gives_a_circle_in_every_frame(
    matchset: Matchset, ball_video: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert matchset("track", ball_video, "--pick", "50,60", "--jsonl", "--video", "out.webm") == 0
    rows = read_tracks("runs/0001-track/tracks.csv")
    assert [row.frame for row in rows] == list(range(len(CENTERS)))
    for row, (x, y) in zip(rows, CENTERS, strict=True):
        assert row.shape is not None
        assert [row.shape[name] for name in ("x", "y", "radius")] == pytest.approx([x, y, RADIUS], abs=1.0)
    assert len(Path("runs/0001-track/tracks.jsonl").read_text().splitlines()) == len(rows)
    assert frames_of(Path("out.webm")) == len(rows)
    out = capsys.readouterr().out
    assert "found in 30 of 30 frames (100.0 %)" in out
    computing = FOUR.search(out)
    assert computing is not None
    assert max(map(len, computing[0].splitlines())) < 80
    assert "runs/0001-track/tracks.csv" in out


def frames_of(path: Path) -> int:
    video = cv2.VideoCapture(str(path))
    return next(count for count in range(100_000) if not video.grab())


def test_nothing_is_overwritten(matchset: Matchset, ball_video: Path, capsys: pytest.CaptureFixture[str]) -> None:
    command = "track", ball_video, "--pick", "50,60", "--no-video", "-o", "out"
    assert matchset(*command) == 0
    before = Path("out/tracks.csv").stat().st_mtime_ns
    capsys.readouterr()
    assert matchset(*command) == 2
    assert one_error(capsys) == "the folder out is not empty: choose another, or overwrite with --force"
    assert Path("out/tracks.csv").stat().st_mtime_ns == before
    assert matchset(*command, "--force") == 0
    for _ in range(2):
        assert matchset("track", ball_video, "--pick", "50,60", "--no-video", "--end", 2) == 0
    assert sorted(path.name for path in Path("runs").iterdir()) == ["0001-track", "0002-track"]


def one_error(capsys: pytest.CaptureFixture[str]) -> str:
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 1, lines
    assert lines[0].startswith("error: ")
    return lines[0].removeprefix("error: ")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ((), "say what to follow"),
        (("--pick", "1,2", "--candidate", "1"), "not several"),
        (("--pick", "50"), "--pick is X,Y or X,Y@FRAME, as in 427,146@60, got '50'"),
        (("--pick", "50,600"), "does not lie in the 160 x 120 picture"),
        (("--pick", "5,5@99"), "there is no frame 99: the video has frames 0 ... 29"),
        (("--candidate", "one"), "--candidate is N or N@FRAME"),
        (("--candidate", "8@0"), "there is no candidate 8 in frame 0"),
        (("--hsv", "1,2,3"), "--hsv is LOW:HIGH"),
        (("--hsv", "1,2,3:4,5,999"), "999"),
        (("--color", "none.npz"), "none.npz"),
        (("--pick", "50,60", "--video", "out.gif"), "must end in .mp4, .webm, .avi"),
        (("--pick", "50,60", "--points", "3"), "--points"),
        (("--frob",), "--frob"),
    ],
)
def test_misuse_is_one_line_and_leaves_nothing(
    matchset: Matchset,
    ball_video: Path,
    capsys: pytest.CaptureFixture[str],
    options: tuple[str, ...],
    words: str,
) -> None:
    assert matchset("track", ball_video, *options) == 2
    assert words in one_error(capsys)
    assert list(Path().iterdir()) == []


def test_bad_sources_are_one_line(matchset: Matchset, capsys: pytest.CaptureFixture[str]) -> None:
    Path("text.mp4").write_text("this is no video")
    Path("empty").mkdir()
    for source in ("none.mp4", "text.mp4", "empty"):
        assert matchset("track", source, "--hsv", "1,1,1:9,9,9") == 2
        assert source in one_error(capsys)
    assert matchset("track", "97", "--hsv", "1,1,1:9,9,9") == 3
    assert "camera 97" in one_error(capsys)


def test_a_ball_that_is_never_found_ends_with_one(matchset: Matchset, ball_video: Path) -> None:
    assert matchset("track", ball_video, "--hsv", "50,200,200:60,255,255") == 1
    rows = read_tracks("runs/0001-track/tracks.csv")
    assert len(rows) == len(CENTERS)
    assert all(row.reason for row in rows)


def test_what_a_click_is_taken_for_is_said_and_another_reading_can_be_asked_for(
    matchset: Matchset, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    image, (x, y, radius), _ = draw("before a disc", 4)
    cv2.imwrite(str(tmp_path / "ball.png"), image)
    command = "track", tmp_path / "ball.png", "--no-video", "--pick", f"{x + 0.5 * radius:.0f},{y:.0f}"
    assert matchset(*command) == 0
    told = capsys.readouterr().err
    assert f"note: the click is taken for: ball at ({x:.0f}, {y:.0f}), r = {radius:.0f} px, 9" in told
    assert "; or ball around it at (" in told
    assert "(--reading 2)" in told
    assert matchset(*command, "--reading", "2") == 0
    assert "note: the click is taken for: ball around it at (" in capsys.readouterr().err
    assert matchset("track", tmp_path / "ball.png", "--candidate", "1", "--reading", "2") == 2
    assert one_error(capsys) == "--reading says what a --pick means: give one, without --gray"


def test_a_candidate_is_a_click(matchset: Matchset, ball_video: Path) -> None:
    assert matchset("track", ball_video, "--candidate", "1@3", "--no-video", "-o", "a") == 0
    assert matchset("track", ball_video, "--candidate", "1", "--no-video", "-o", "b") == 0
    assert all(row.found for row in read_tracks("a/tracks.csv") + read_tracks("b/tracks.csv"))


def test_a_broken_frame_has_a_row_that_says_so(matchset: Matchset, capsys: pytest.CaptureFixture[str]) -> None:
    Path("frames").mkdir()
    for index in range(6):
        cv2.imwrite(f"frames/{index}.png", ball_picture((50.0, 60.0)))
    Path("frames/2.png").write_bytes(b"\x89PNG broken")
    assert matchset("track", "frames", "--pick", "50,60", "-o", "out", "--video", "out.webm") == 0
    rows = read_tracks("out/tracks.csv")
    assert [row.frame for row in rows] == list(range(6))
    assert [row.reason for row in rows if not row.found] == [UNDECODED]
    assert [row.time for row in rows] == sorted({row.time for row in rows})
    assert "1 broken frame skipped" in capsys.readouterr().err


def test_print_writes_json_alone_to_stdout(
    matchset: Matchset, ball_video: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert matchset("track", ball_video, "--pick", "50,60", "--print", "-o", "out") == 0
    lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [line["frame"] for line in lines] == list(range(30))
    with Path("out/tracks.csv").open() as file:
        table = list(csv.DictReader(file))
    assert [float(row["x"]) for row in table] == [line["x"] for line in lines]


class FakeCamera:
    """A camera that drops every other frame and is pulled out after some."""

    live, fps, length, broken, warnings = True, 30.0, None, 0, ()
    width, height = SIZE

    def __init__(self, _source: str, **_: object) -> None:
        self.dropped = 0

    def __iter__(self) -> Iterator[Frame]:
        return self

    def until(self, stopped: Callable[[], bool]) -> Iterator[Frame]:
        return itertools.takewhile(lambda _: not stopped(), self)

    def __next__(self) -> Frame:
        if self.dropped == 10:
            raise LinkError("camera 0 went away")
        self.dropped += 1
        return Frame(ball_picture((50.0, 60.0)), time.monotonic(), 2 * self.dropped)

    def __enter__(self) -> "FakeCamera":
        return self

    def __exit__(self, *error: Any) -> None: ...


def test_a_camera_that_goes_away_leaves_whole_files(
    matchset: Matchset, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("matchset.media.video.Video", FakeCamera)
    assert matchset("track", "0", "--pick", "50,60", "--print", "-o", "out", "--video", "out.webm") == 3
    captured = capsys.readouterr()
    lines = [json.loads(line) for line in captured.out.splitlines()]
    assert [line["frame"] for line in lines] == list(range(2, 22, 2))  # no rows for dropped frames
    assert all(0.0 <= line["age_ms"] < 10_000.0 for line in lines)
    assert lines[-1]["dropped"] == 10
    assert all(line["found"] for line in lines)
    assert "error: camera 0 went away" in captured.err
    assert len(read_tracks("out/tracks.csv")) == 10
    assert frames_of(Path("out.webm")) == 10


def test_a_click_counts_in_its_own_frame(matchset: Matchset) -> None:
    """Two equal balls: the one that was clicked is followed from its frame on."""
    Path("frames").mkdir()
    for index in range(8):
        both = np.minimum(ball_picture((40.0, 60.0)), ball_picture((120.0, 60.0)))
        both[..., 0] = np.where(both[..., 2] < 100, 190, both[..., 0])
        cv2.imwrite(f"frames/{index}.png", both)
    for x in (40.0, 120.0):
        assert matchset("track", "frames", "--pick", f"{x},60@4", "--no-video", "-o", f"out{x}") == 0
        shapes = [row.shape for row in read_tracks(f"out{x}/tracks.csv")]
        assert all(shape is not None and abs(shape["x"] - x) < 2.0 for shape in shapes[4:])


def test_a_note_on_the_color_is_told(matchset: Matchset, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "everywhere"
    folder.mkdir()
    for index in range(3):
        image = np.full((240, 320, 3), (40, 150, 60), np.uint8)
        cv2.circle(image, (160, 120), 75, (130, 130, 130), cv2.FILLED, cv2.LINE_AA)
        cv2.circle(image, (160, 120), 20, (40, 150, 60), cv2.FILLED, cv2.LINE_AA)
        noise = np.random.default_rng(index).integers(-3, 4, image.shape)
        cv2.imwrite(str(folder / f"{index}.png"), (image.astype(int) + noise).clip(0, 255).astype(np.uint8))
    assert matchset("track", folder, "--pick", "158,120", "--no-video") == 0
    out, err = capsys.readouterr()
    assert "note: the color at (160, 120) is all over the picture: learned against what is next to it\n" in err
    assert "found in 3 of 3 frames" in out


def test_force_never_overwrites_the_video_that_is_read(
    matchset: Matchset, ball_video: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    own = Path("own.mp4")
    own.write_bytes(ball_video.read_bytes())
    Path("out.mp4").symlink_to(own)
    for name in ("own.mp4", "out.mp4"):
        assert matchset("track", own, "--pick", "50,60", "--video", name, "--force") == 2
        assert one_error(capsys).startswith(f"{name} is what is read")
        assert own.read_bytes() == ball_video.read_bytes()


def test_reasons_that_differ_by_their_numbers_are_one_with_its_range() -> None:
    said = RunStatistics()
    for reason in ("only 41 % of 3 px", "it left", "only 5 % of 3 px", "only 7.5 % of 3 px"):
        lost = Lost[Circle](reason, 0.0)
        said.count(TrackedFrame(None, lost, track_row(0, lost)))
    assert said.reasons(5) == [("only 5 to 41 % of 3 px", 3), ("it left", 1)]
    assert said.reasons(1) == [("only 5 to 41 % of 3 px", 3)]
