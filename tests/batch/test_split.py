"""Long videos in stretches: the same frames as in one reading, identities that go on, stretches that do not fit."""

import csv
from pathlib import Path

import pytest

from batched_videos import HerePool, write_ball, write_color
from blue_ball import Matchset
from matchset.app.guidance.choice import BallChoice, choose
from matchset.app.several.options import SeveralOptions
from matchset.batch import run
from matchset.batch.jobs import choice
from matchset.batch.jobs.video_options import track_options
from matchset.batch.options import BatchOptions
from matchset.batch.split import parts
from matchset.batch.split.joining import MisfitError, Part, joined
from matchset.media.video import Video
from matchset.media.video_stretch import StretchMark, VideoStretch

HEADING = "frame,time,found,x,y,radius,identity,label,alternatives"


@pytest.fixture(autouse=True)
def here(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(run, "Processes", HerePool)


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as text:
        return list(csv.DictReader(text))


def test_stretch_has_the_frames_of_the_whole(tmp_path: Path) -> None:
    path = write_ball(tmp_path / "long.mp4", frames=120)
    whole = {frame.index: frame for frame in Video(path)}
    marks = list[StretchMark]()
    with VideoStretch(str(path), 2.0, 3.0, marks.append) as stretch:
        frames = list(stretch)
    assert [frame.index for frame in frames] == list(range(60, 90))
    assert all((frame.image == whole[frame.index].image).all() for frame in frames)
    assert all(frame.time == whole[frame.index].time for frame in frames)
    assert [mark.index for mark in marks] == [frame.index for frame in frames]


def test_pictures_in_a_folder_have_no_stretches(tmp_path: Path) -> None:
    import cv2
    import numpy as np

    for index in range(3):
        cv2.imwrite(str(tmp_path / f"{index}.png"), np.zeros((20, 20, 3), np.uint8))
    with pytest.raises(ValueError, match="cannot be read in stretches"):
        VideoStretch(str(tmp_path), 0.0, 1.0, lambda _: None)


@pytest.mark.parametrize("words", [("--color", "ball.npz"), ("--pick", "60,60@5"), ("--color", "ball.npz", "--all")])
def test_joined_table_is_that_of_the_whole(
    matchset: Matchset, tmp_path: Path, words: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(parts, "PARAMETERS", parts.SplitParameters(overlap=2.0))
    monkeypatch.setattr(parts.Parts.__init__, "__defaults__", (None, parts.PARAMETERS))
    path = write_ball(tmp_path / "clips" / "long.mp4", frames=360)
    write_color(tmp_path / "ball.npz")
    assert matchset("batch", path, "--out", "whole", *words) == 0
    assert matchset("batch", path, "--out", "cut", *words, "--split", 4) == 0
    one, other = rows(Path("whole/long.mp4/tracks.csv")), rows(Path("cut/long.mp4/tracks.csv"))
    assert [(row["frame"], row["time"], row["found"]) for row in one] == [
        (row["frame"], row["time"], row["found"]) for row in other
    ]
    found = [(float(a["x"]) - float(b["x"]), float(a["y"]) - float(b["y"])) for a, b in zip(one, other, strict=True)]
    assert max(abs(value) for pair in found for value in pair) < 0.3
    assert {row.get("identity") for row in other} == {row.get("identity") for row in one}
    assert sorted(path.name for path in Path("cut").iterdir() if path.is_dir() and path.name[0] != ".") == ["long.mp4"]
    assert "joined of 3 stretches" in Path("cut/videos.csv").read_text()


def test_what_is_likeliest_is_chosen_once(matchset: Matchset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(parts.Parts.__init__, "__defaults__", (None, parts.SplitParameters(overlap=2.0)))
    monkeypatch.setattr(parts, "PARAMETERS", parts.SplitParameters(overlap=2.0))
    chosen = list[BallChoice]()

    def choose_and_count(video: Video) -> BallChoice:
        chosen.append(choose(video))
        return chosen[-1]

    monkeypatch.setattr(choice, "choose", choose_and_count)
    path = write_ball(tmp_path / "clips" / "long.mp4", frames=360)
    assert matchset("batch", path, "--out", "auto", "--auto", "--split", 4) == 0
    assert len(chosen) == 1
    (row,) = rows(Path("auto/videos.csv"))
    assert "joined of 3 stretches" in row["reason"]
    assert matchset("batch", path, "--out", "clicked", "--pick", row["click"], "--split", 4) == 0
    assert Path("auto/long.mp4/tracks.csv").read_bytes() == Path("clicked/long.mp4/tracks.csv").read_bytes()
    monkeypatch.setattr(choice.doubt_of, "__defaults__", (choice.DoubtParameters(rank=1.0),))
    assert matchset("batch", path, "--out", "doubtful", "--auto", "--split", 4) == 1
    assert rows(Path("doubtful/videos.csv"))[0]["state"] == "doubtful"
    assert Path("doubtful/long.mp4/frame.png").is_file()
    assert len(chosen) == 2


def part(frames: range, places: dict[str, float], shift: int = 0, first: int = 0) -> Part:
    """A stretch with targets at rest: the place of each by its identity."""
    lines = [HEADING]
    for frame in frames:
        lines += [f"{frame - shift},{frame / 30:.6f},1,{x},50.0,10.0,{name},0," for name, x in places.items()]
    marks = [StretchMark(frame - shift, frame / 30, frame / 30, 7 * frame + first) for frame in frames]
    return Part("\n".join(lines).encode() + b"\n", marks)


def test_identities_go_on_and_new_ones_get_new_numbers() -> None:
    one = part(range(100), {"0": 20.0, "1": 80.0})
    other = part(range(60, 200), {"0": 80.0, "1": 20.0, "2": 140.0}, shift=2)
    table, differing = joined([one, other])
    lines = [line.split(",") for line in table.decode().splitlines()[1:]]
    assert [int(line[0]) for line in lines] == sorted(int(line[0]) for line in lines)
    assert {int(line[0]) for line in lines} == set(range(200))
    assert {(line[6], line[3]) for line in lines} == {("0", "20.0"), ("1", "80.0"), ("2", "140.0")}
    assert differing == [99]  # one more target is seen by the later stretch: said


def test_nobody_is_there_where_stretches_overlap() -> None:
    one, other = part(range(100), {"0": 20.0}), part(range(60, 200), {"0": 90.0})
    for frame in range(50, 110):
        one.rows.pop(frame, None)
        other.rows.pop(frame, None)
    table, differing = joined([one, other])
    lines = [line.split(",") for line in table.decode().splitlines()[1:]]
    assert [int(line[0]) for line in lines] == [*range(50), *range(110, 200)]
    assert [line[6] for line in lines] == ["0"] * 50 + ["1"] * 90  # somebody else, as far as can be told
    assert differing == []


def test_three_stretches_with_other_numbers() -> None:
    stretches = [part(range(first, first + 100), {"3": 20.0}, shift=k) for k, first in enumerate((0, 60, 120))]
    table, differing = joined(stretches)
    lines = [line.split(",") for line in table.decode().splitlines()[1:]]
    assert [int(line[0]) for line in lines] == list(range(220))
    assert {line[6] for line in lines} == {"3"}
    assert differing == []


@pytest.mark.parametrize("other", [part(range(60, 200), {"0": 20.0}, first=1), part(range(100, 200), {"0": 20.0})])
def test_other_pictures_are_not_joined(other: Part) -> None:
    with pytest.raises(MisfitError, match="are the same where they overlap"):
        joined([part(range(100), {"0": 20.0}), other])


def test_options_of_a_batch_are_those_of_track() -> None:
    options = track_options(BatchOptions(videos=[], out="x"), "video.mp4")
    several = SeveralOptions(every=True, most=3, smooth=True)
    asked = track_options(BatchOptions(videos=[], out="x", several=several), "video.mp4").several
    assert (asked.every, asked.most, asked.smooth) == (True, 3, True)
    assert options.source == "video.mp4"
    assert options.shown.no_video
