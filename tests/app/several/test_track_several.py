"""`matchset track` with several targets: tables, pictures, MOT text, what is refused; and one ball stays as it was."""

import csv
import hashlib
import itertools
import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

import matchset as ms
from blue_ball import Matchset
from matchset.app.several.chosen import PARAMETERS, labelled, shared_part
from matchset.app.several.painter import PALETTE, color_of, draw_targets, target_words
from matchset.app.track.loop import UNDECODED
from matchset.app.track.rows import read_tracks
from several_balls import FRAMES, RADIUS, SIZE, picture, places, write_pictures

SINGLE_HEAD = "frame,time,found,x,y,radius,x_std,y_std,radius_std,support,reason"
BLUE_PICK, OTHER_BLUE, RED_PICK = "60,60", "250,170", "160,190"


@pytest.fixture(scope="module")
def balls(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_pictures(tmp_path_factory.mktemp("several") / "balls")


def rows_of(path: str) -> list[dict[str, str]]:
    with Path(path).open(newline="") as file:
        return list(csv.DictReader(file))


def identity_at(rows: list[dict[str, str]], ball: int, frame: int) -> str:
    """Whose row is at a ball."""
    x, y = places(frame)[ball]
    near = [row for row in rows if int(row["frame"]) == frame and row["found"] == "1"]
    (found,) = [each for each in near if np.hypot(float(each["x"]) - x, float(each["y"]) - y) < 2.0]
    assert float(found["radius"]) == pytest.approx(RADIUS, abs=1.0)
    return found["identity"]


def test_all_of_a_color_are_followed_each_under_one_identity(
    matchset: Matchset, balls: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert matchset("track", balls, "--pick", BLUE_PICK, "--all", "-o", "out", "--jsonl", "--gif", "out.gif") == 0
    rows = rows_of("out/tracks.csv")
    assert list(rows[0]) == [*SINGLE_HEAD.split(","), "identity", "label", "alternatives"]
    assert {row["label"] for row in rows} == {"1"}
    for ball in (0, 1):
        assert len({identity_at(rows, ball, frame) for frame in range(4, FRAMES)}) == 1
    assert len({row["identity"] for row in rows}) == 2
    assert [json.loads(line)["identity"] for line in Path("out/tracks.jsonl").read_text().splitlines()] == [
        int(row["identity"]) for row in rows
    ]
    out = capsys.readouterr().out
    assert f"2 targets in {FRAMES} frames\n" in out
    assert "  target 1 (1): found in " in out
    for name in ("out/summary.png", "out.gif", "out/latency.csv"):
        assert name in out
        assert Path(name).exists()


def test_only_what_is_picked_is_followed(matchset: Matchset, balls: Path) -> None:
    command = "track", balls, "--pick", OTHER_BLUE, "--pick", f"{places(3)[2][0]},{places(3)[2][1]}@3"
    assert matchset(*command, "--no-video", "-o", "out") == 0
    rows = rows_of("out/tracks.csv")
    assert {(row["identity"], row["label"]) for row in rows} == {("0", "1"), ("1", "2")}
    assert identity_at(rows, 1, FRAMES - 1) == "0"
    assert identity_at(rows, 2, FRAMES - 1) == "1"
    for identity in "01":  # what was clicked later is followed from where it enters, as a single ball is
        assert [int(row["frame"]) for row in rows if row["identity"] == identity] == list(range(FRAMES))


def test_smooth_has_each_target_from_where_it_enters(
    matchset: Matchset, balls: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = "track", balls, "--pick", BLUE_PICK, "--all", "--no-video"
    assert matchset(*command, "--smooth", "-o", "out") == 0
    assert f"note: followed forward and backward through {FRAMES} frames" in capsys.readouterr().err
    rows = rows_of("out/tracks.csv")
    assert [(int(row["frame"]), row["found"]) for row in rows] == [(k, "1") for k in range(FRAMES) for _ in (0, 1)]
    for ball in (0, 1):
        assert len({identity_at(rows, ball, frame) for frame in range(FRAMES)}) == 1
    assert len(Path("out/latency.csv").read_text().splitlines()) == FRAMES + 1
    assert matchset(*command, "--smooth", "--start", "5", "--end", "12", "-o", "part") == 0
    part = rows_of("part/tracks.csv")
    assert [int(row["frame"]) for row in part] == [k for k in range(5, 12) for _ in (0, 1)]
    for row in part:
        (whole,) = [
            each for each in rows if each["frame"] == row["frame"] and abs(float(each["x"]) - float(row["x"])) < 9
        ]
        assert float(row["x"]) == pytest.approx(float(whole["x"]), abs=0.1)


def test_a_live_source_is_not_smoothed(
    matchset: Matchset, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("matchset.media.video.Video", Camera)
    assert matchset("track", "0", "--pick", BLUE_PICK, "--all", "--smooth", "-o", "out") == 2
    assert "a live source has no way back" in capsys.readouterr().err.splitlines()[-1]


def test_picks_on_one_color_share_its_label(
    matchset: Matchset, balls: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = "track", balls, "--pick", BLUE_PICK, "--pick", OTHER_BLUE, "--pick", RED_PICK
    assert matchset(*command, "--no-video", "-o", "out") == 0
    labels = {row["identity"]: row["label"] for row in rows_of("out/tracks.csv")}
    assert sorted(labels.values()) == ["1", "1", "2"]
    assert "note: this has the color 1, too" in capsys.readouterr().err


def test_colors_share_what_both_cover() -> None:
    image = picture(0)
    blue, other, red = (ms.ColorModel.pick(image, *place) for place in places(0))
    assert shared_part(blue, other) > PARAMETERS.share > shared_part(blue, red)
    assert shared_part(ms.ColorModel.dark(), ms.ColorModel.dark()) == 1.0
    assert shared_part(blue, ms.ColorModel.dark()) == 0.0


def test_named_colors_are_labels_and_most_is_kept(matchset: Matchset, balls: Path) -> None:
    for name, place in zip(("blue", "other", "red"), places(0), strict=True):
        ms.ColorModel.pick(picture(0), *place).save(f"{name}.npz")
    colors = "--color", "sea=blue.npz", "--color", "fire engine=red.npz"
    assert matchset("track", balls, *colors, "--no-video", "-o", "out") == 0
    rows = rows_of("out/tracks.csv")
    assert sorted({row["identity"]: row["label"] for row in rows}.values()) == ["fire engine", "sea", "sea"]
    assert matchset("track", balls, *colors, "--no-video", "-o", "two", "--most", "2") == 0
    rows = rows_of("two/tracks.csv")
    assert max(sum(row["frame"] == str(frame) for row in rows) for frame in range(FRAMES)) == 2


def parse_mot(path: Path) -> dict[tuple[int, int], list[float]]:
    """Box and confidence by frame and id."""
    lines = [line.split(",") for line in path.read_text().splitlines()]
    assert all(line[-3:] == ["-1", "-1", "-1"] and len(line) == 10 for line in lines)
    read = {(int(line[0]), int(line[1])): [float(each) for each in line[2:7]] for line in lines}
    assert len(read) == len(lines)
    return read


def test_mot_text_holds_what_was_found(matchset: Matchset, balls: Path) -> None:
    command = "track", balls, "--pick", BLUE_PICK, "--all", "--no-video", "-o", "out", "--mot", "out.txt"
    assert matchset(*command) == 0
    found = [row for row in rows_of("out/tracks.csv") if row["found"] == "1"]
    boxes = parse_mot(Path("out.txt"))
    assert len(boxes) == len(found)
    for row in found:
        x, y, radius = (float(row[name]) for name in ("x", "y", "radius"))
        box = boxes[int(row["frame"]) + 1, int(row["identity"]) + 1]
        assert box == pytest.approx([x - radius, y - radius, 2 * radius, 2 * radius, float(row["support"])], abs=3e-4)
    before = Path("out.txt").read_bytes()
    assert matchset("track", balls, "--pick", BLUE_PICK, "--all", "--mot", "out.txt") == 2
    assert Path("out.txt").read_bytes() == before


def test_one_ball_stays_byte_for_byte_and_can_be_mot_text_too(matchset: Matchset, balls: Path) -> None:
    for folder, more in (("plain", ()), ("mot", ("--mot", "one.txt"))):
        assert matchset("track", balls, "--pick", BLUE_PICK, "--jsonl", "-o", folder, *more) == 0
    for name in ("tracks.csv", "tracks.jsonl", "summary.png"):
        first, second = (hashlib.sha256(Path(folder, name).read_bytes()).digest() for folder in ("plain", "mot"))
        assert first == second
    assert Path("plain/tracks.csv").read_text().splitlines()[0] == SINGLE_HEAD
    assert set(parse_mot(Path("one.txt"))) == {(frame + 1, 1) for frame in range(FRAMES)}


def test_one_ball_is_written_as_the_library_answers(matchset: Matchset, balls: Path) -> None:
    assert matchset("track", balls, "--pick", BLUE_PICK, "--no-video", "-o", "out") == 0
    tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(picture(0), 60, 60), start=(60, 60))
    lines = [SINGLE_HEAD]
    for frame in ms.Video(str(balls)):
        answer = tracker.update(frame)
        assert isinstance(answer, ms.Track)
        numbers = [
            answer.shape.x,
            answer.shape.y,
            answer.shape.radius,
            *np.sqrt(np.diagonal(answer.covariance)),
            answer.support,
        ]
        cells = [frame.index, round(frame.time, 6), 1, *(round(float(each), 4) for each in numbers), ""]
        lines.append(",".join(map(str, cells)))
    assert Path("out/tracks.csv").read_text() == "\n".join(lines) + "\n"


def test_a_table_of_several_is_read_by_identity(
    matchset: Matchset, balls: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert matchset("track", balls, "--pick", BLUE_PICK, "--all", "--no-video", "-o", "out") == 0
    identity = int(identity_at(rows_of("out/tracks.csv"), 0, 5))
    truth = ["video,frame,x,y,r,visible,method"]
    truth += [f"a,{k},{places(k)[0][0]},{places(k)[0][1]},{RADIUS},1,hand" for k in range(FRAMES)]
    Path("truth.csv").write_text("\n".join(truth) + "\n")
    capsys.readouterr()
    assert matchset("score", "out/tracks.csv", "truth.csv") == 2
    assert "out/tracks.csv holds several targets (0, 1): say which by its identity" in capsys.readouterr().err
    assert matchset("score", "out/tracks.csv", "truth.csv", "--identity", 7) == 2
    assert "holds no target 7; it has 0, 1" in capsys.readouterr().err
    assert matchset("score", "out/tracks.csv", "truth.csv", "--identity", identity, "--json") == 0
    assert json.loads(capsys.readouterr().out)["valid"] >= FRAMES - 2
    assert all(row.shape is None or set(row.shape) == {"x", "y", "radius"} for row in read_tracks("out/tracks.csv", 0))


def test_print_writes_a_line_for_each_target(
    matchset: Matchset, balls: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert matchset("track", balls, "--pick", BLUE_PICK, "--all", "--print", "-o", "out") == 0
    lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [(str(line["frame"]), str(line["identity"])) for line in lines] == [
        (row["frame"], row["identity"]) for row in rows_of("out/tracks.csv")
    ]


def test_a_broken_frame_has_a_row_for_each_target(matchset: Matchset, tmp_path: Path) -> None:
    write_pictures(tmp_path / "frames", 8)
    Path("frames/5.png").unlink(missing_ok=True)
    Path("frames/0005.png").write_bytes(b"\x89PNG broken")
    assert matchset("track", "frames", "--pick", BLUE_PICK, "--all", "--no-video", "-o", "out") == 0
    assert [row["reason"] for row in rows_of("out/tracks.csv") if row["frame"] == "5"] == [UNDECODED] * 2


def test_nothing_found_ends_with_one(matchset: Matchset, balls: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert matchset("track", balls, "--hsv", "50,200,200:60,255,255", "--all", "-o", "out", "--no-video") == 1
    assert rows_of("out/tracks.csv") == []
    captured = capsys.readouterr()
    assert f"0 targets in {FRAMES} frames" in captured.out
    assert "nothing in frame 0 has this color" in captured.out
    assert "--all" in captured.out.splitlines()[-1]
    assert cv2.imread("out/why.png") is not None


def test_a_refused_click_is_explained(matchset: Matchset, balls: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert matchset("track", balls, "--pick", "5,230", "--pick", BLUE_PICK, "--no-video", "-o", "out") == 2
    assert capsys.readouterr().err.splitlines()[-1].startswith("error: ")
    assert sorted(path.name for path in Path("out").iterdir()) == ["why.png"]


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--pick", "60,60", "--all", "--most", "0"), "--most must be 1 to 100, got 0"),
        (("--pick", "60,60", "--all", "--most", "101"), "--most must be 1 to 100, got 101"),
        (("--pick", "60,60", "--most", "3"), "--most is of several targets: give --all"),
        (("--pick", "60,60", "--smooth"), "--smooth is of several targets: give --all"),
        (("--pick", "60,60", "--on-table"), "--on-table is of several targets: give --all"),
        (("--pick", "60,60", "--pick", "9,9", "--most", "1"), "--most 1 is less than the number of --pick, 2"),
        (("--pick", "60,60", "--pick", "60,60"), "--pick 60,60 is given twice"),
        (("--pick", "60,60", "--pick", "250"), "--pick is X,Y or X,Y@FRAME, as in 427,146@60, got '250'"),
        (("--pick", "60,60", "--pick", "250,170", "--reading", "2"), "--reading 2 is of one --pick, got 2"),
        (("--pick", "60,60", "--pick", "250,170", "--candidate", "1"), "not several"),
        (("--pick", "60,60", "--pick", "63,63"), "two clicks are on one target: at (60, 60) and at (63, 63)"),
        (("--color", "a=x.npz", "--color", "a=y.npz"), "two colors are named 'a': each needs a name of its own"),
        (("--color", "a=x.npz", "--color", "b=x.npz"), "--color x.npz is named 'a' and 'b': one name is enough"),
        (("--color", "a=x.npz", "--color", "y.npz"), "of several targets each color has a name, NAME=FILE"),
        (("--color", "a=none.npz"), "none.npz"),
        (("--all",), "say what to follow"),
        (("--all", "--pick", "60,60", "--params", "t.toml"), "--params is of the tracker of one target"),
    ],
)
def test_misuse_is_one_line_and_leaves_nothing(
    matchset: Matchset, balls: Path, capsys: pytest.CaptureFixture[str], options: tuple[str, ...], words: str
) -> None:
    assert matchset("track", balls, *options) == 2
    lines = [line for line in capsys.readouterr().err.splitlines() if not line.startswith("note: ")]
    assert len(lines) == 1, lines
    assert words in lines[0]
    assert list(Path().iterdir()) == []


def test_a_later_click_on_what_is_followed_is_said(
    matchset: Matchset, balls: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    x, y = places(9)[0]
    command = "track", balls, "--pick", BLUE_PICK, "--pick", f"{x},{y}@9", "--no-video"
    assert matchset(*command, "-o", "out") == 2
    assert "is target 0, followed already" in capsys.readouterr().err.splitlines()[-1]
    assert not Path("out").exists()
    assert matchset(*command, "--all", "-o", "all") == 0
    assert len({row["identity"] for row in rows_of("all/tracks.csv")}) == 2


class Camera:
    """A camera before the balls, pulled out after some frames."""

    live, fps, length, broken, dropped = True, 30.0, None, 0, 0
    warnings: tuple[str, ...] = ()
    width, height = SIZE

    def __init__(self, _source: str, **_: object) -> None:
        self._frames = (ms.Frame(picture(k), k / 30.0, k) for k in range(FRAMES))

    def __iter__(self) -> Iterator[ms.Frame]:
        return self

    def __next__(self) -> ms.Frame:
        return next(self._frames)

    def until(self, stopped: Callable[[], bool]) -> Iterator[ms.Frame]:
        return itertools.takewhile(lambda _: not stopped(), self)

    def __enter__(self) -> "Camera":
        return self

    def __exit__(self, *error: object) -> None: ...


def test_before_a_camera_each_click_is_in_the_next_picture(
    matchset: Matchset, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("matchset.media.video.Video", Camera)
    assert matchset("track", "0", "--pick", BLUE_PICK, "--pick", RED_PICK, "--print", "-o", "out") == 0
    lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert {(line["identity"], line["label"]) for line in lines} == {(0, "1"), (1, "2")}
    assert all("age_ms" in line for line in lines)
    assert max(line["frame"] for line in lines) == FRAMES - 1
    assert not Path("out/summary.png").exists()


def test_brightness_is_followed_too(matchset: Matchset, tmp_path: Path) -> None:
    (tmp_path / "dark").mkdir()
    for index in range(12):
        image = np.full((SIZE[1], SIZE[0]), 190, np.uint8)
        for x, y in places(index)[:2]:
            cv2.circle(image, (round(x), round(y)), 22, 60, cv2.FILLED, cv2.LINE_AA)
        cv2.imwrite(f"dark/{index:02d}.png", image)
    assert matchset("track", "dark", "--gray", "dark", "--all", "--no-video", "-o", "out") == 0
    assert len({row["identity"] for row in rows_of("out/tracks.csv")}) == 2
    assert matchset("track", "dark", "--gray", "dark", "--pick", BLUE_PICK, "--pick", OTHER_BLUE, "-o", "two") == 0
    assert {(row["identity"], row["label"]) for row in rows_of("two/tracks.csv")} == {("0", "1"), ("1", "1")}


def test_one_color_under_two_names_is_refused(
    matchset: Matchset, balls: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("a", "b"):
        ms.ColorModel.pick(picture(0), 60, 60).save(f"{name}.npz")
    assert matchset("track", balls, "--color", "x=a.npz", "--color", "y=b.npz") == 2
    assert "error: the colors 'x' and 'y' are the same" in capsys.readouterr().err


def target(identity: int, answer: Any) -> ms.Target[Any]:
    return ms.Target(identity, "blue", answer, 0.0)


def test_each_identity_has_a_color_and_what_is_not_seen_is_dashed() -> None:
    circle = ms.Circle(160.0, 120.0, 40.0)
    seen = ms.Track(circle, np.eye(3), 1.0, np.empty((0, 2)), 0.0)
    drawn = []
    for answer in (seen, ms.Lost("hidden", 0.0, circle)):
        image = np.full((SIZE[1], SIZE[0], 3), 90, np.uint8)
        draw_targets(image, [target(2, answer)], target_words(False))
        drawn.append(int((np.abs(image.astype(int) - color_of(2)).max(axis=2) < 40).sum()))
    assert drawn[0] > 2 * drawn[1] > 100
    assert len({color_of(each) for each in range(len(PALETTE))}) == len(PALETTE)
    assert color_of(len(PALETTE)) == color_of(0)
    image = np.full((SIZE[1], SIZE[0], 3), 90, np.uint8)
    far = ms.Lost("far", 0.0, ms.Circle(-900.0, 9.0, 5.0))
    draw_targets(image, [target(2, ms.Lost("gone", 0.0)), target(3, far)], target_words(False))
    assert (image == 90).all()
    draw_targets(image, [target(3, ms.Lost("left", 0.0, ms.Circle(2.0, 2.0, 30.0)))], target_words(True))
    assert not (image == 90).all()


def test_the_video_shows_every_frame(matchset: Matchset, balls: Path) -> None:
    assert matchset("track", balls, "--pick", BLUE_PICK, "--all", "-o", "out", "--video", "out.avi") == 0
    video = cv2.VideoCapture("out.avi")
    assert sum(video.grab() for _ in range(FRAMES + 5)) == FRAMES


def test_two_clicks_on_one_color_know_what_was_around_the_first() -> None:
    image = picture(0)
    blue, other, red = (ms.ColorModel.pick(image, *place) for place in places(0))
    colors = dict[str, ms.ColorModel]()
    assert [labelled(colors, each) for each in (blue, other, red)] == ["1", "1", "2"]
    assert colors["1"].sample is blue.sample is not None
    assert colors["1"].circle == blue.circle
