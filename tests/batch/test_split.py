"""Long videos in stretches: the same frames as in one reading, identities that go on, stretches that do not fit."""

import csv
import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import cv2
import msgspec
import numpy as np
import pytest

from batched_videos import HerePool, write_ball, write_color
from blue_ball import Matchset, ball_picture
from matchset.app.guidance.choice import BallChoice, choose
from matchset.app.several.options import SeveralOptions
from matchset.batch import run
from matchset.batch.jobs import choice, counts, work
from matchset.batch.jobs.job import Job, Stretch, VideoOutcome
from matchset.batch.jobs.video_options import Options, track_options
from matchset.batch.loop import Batch
from matchset.batch.options import BatchOptions
from matchset.batch.progress import BatchCounts
from matchset.batch.results.store import FolderStore, Store, store_at
from matchset.batch.split import joining, parts, stretch_work
from matchset.batch.split.joining import JoinParameters, MisfitError, Part, cuts_between, joined
from matchset.batch.split.opening import StretchOpening
from matchset.batch.workers.pool import Answer
from matchset.media.video import Video
from matchset.media.video_stretch import StretchMark, StretchParameters, VideoStretch
from matchset.tracking.constants import TrackerConstants

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


def test_stretch_begins_where_a_tracker_that_has_read_all_does_what_it_does_now_and_then(tmp_path: Path) -> None:
    path = write_ball(tmp_path / "long.mp4", frames=240)
    for first, begin, index in ((0, 2.1, 120), (5, 2.1, 65), (5, 1.0, 65), (200, 2.0, 80)):
        with VideoStretch(str(path), begin, 7.0, lambda _: None, first=first) as stretch:
            assert next(stretch).index == index
    limits = TrackerConstants()
    own = limits.hypotheses.period, 4 * limits.adaptation.period, limits.adaptation.sweep * limits.adaptation.period
    for period in own:
        assert StretchParameters().cycle % period == 0


def test_nothing_is_left_of_a_video_that_ends_before(tmp_path: Path) -> None:
    path = write_ball(tmp_path / "long.mp4", frames=70)
    with VideoStretch(str(path), 2.1, 7.0, lambda _: None) as stretch:
        assert list(stretch) == []


def write_broken(path: Path, frames: int, broken: range) -> Path:
    """Write a video of a ball, some pictures of which do not decode."""
    path.parent.mkdir(parents=True, exist_ok=True)
    writer = cv2.VideoWriter(str(path), cv2.CAP_OPENCV_MJPEG, cv2.VideoWriter.fourcc(*"MJPG"), 30.0, (160, 120))
    for index in range(frames):
        writer.write(ball_picture((60.0 + 20.0 * np.sin(0.05 * index), 60.0)))
    writer.release()
    data = bytearray(path.read_bytes())
    begins = [match.start() for match in re.finditer(rb"\xff\xd8\xff", bytes(data))]
    assert len(begins) == frames
    for index in broken:
        begin, end = begins[index], begins[index + 1] - 8  # format: a chunk's heading in an AVI
        data[begin:end] = b"\x00" * (end - begin)
    path.write_bytes(data)
    return path


def test_a_stretch_ends_where_the_whole_ends(tmp_path: Path) -> None:
    path = write_broken(tmp_path / "broken.avi", 300, range(200, 212))
    whole = [frame.index for frame in Video(path)]
    assert whole == [*range(200), *range(212, 300)]
    with VideoStretch(str(path), 4.0, float("inf"), lambda _: None) as stretch:
        frames = [frame.index for frame in stretch]
    assert frames == whole[whole.index(120) :]


def test_pictures_in_a_folder_have_no_stretches(tmp_path: Path) -> None:
    for index in range(3):
        cv2.imwrite(str(tmp_path / f"{index}.png"), np.zeros((20, 20, 3), np.uint8))
    with pytest.raises(ValueError, match="cannot be read in stretches"):
        VideoStretch(str(tmp_path), 0.0, 1.0, lambda _: None)


def short_overlap(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(parts, "PARAMETERS", parts.SplitParameters(overlap=4.0))
    monkeypatch.setattr(parts.Parts.__init__, "__defaults__", (None, parts.PARAMETERS))
    monkeypatch.setattr(joining.cuts_between, "__defaults__", (joining.JoinParameters(same=30),))
    monkeypatch.setattr(joining.frames_needed, "__defaults__", (joining.JoinParameters(same=30),))


@pytest.mark.parametrize("words", [("--color", "ball.npz"), ("--pick", "60,60@5"), ("--color", "ball.npz", "--all")])
def test_joined_table_is_that_of_the_whole(
    matchset: Matchset, tmp_path: Path, words: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    short_overlap(monkeypatch)
    path = write_ball(tmp_path / "clips" / "long.mp4", frames=900)
    write_color(tmp_path / "ball.npz")
    assert matchset("batch", path, "--out", "whole", *words) == 0
    assert matchset("batch", path, "--out", "cut", *words, "--split", 10) == 0
    one, other = rows(Path("whole/long.mp4/tracks.csv")), rows(Path("cut/long.mp4/tracks.csv"))
    assert one == other
    assert sorted(path.name for path in Path("cut").iterdir() if path.is_dir() and path.name[0] != ".") == ["long.mp4"]
    assert "joined of 3 stretches" in Path("cut/videos.csv").read_text()


def test_what_is_likeliest_is_chosen_once(matchset: Matchset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    short_overlap(monkeypatch)
    chosen = list[BallChoice]()

    def choose_and_count(video: Video) -> BallChoice:
        chosen.append(choose(video))
        return chosen[-1]

    monkeypatch.setattr(choice, "choose", choose_and_count)
    path = write_ball(tmp_path / "clips" / "long.mp4", frames=900)
    assert matchset("batch", path, "--out", "auto", "--auto", "--split", 10) == 0
    assert len(chosen) == 1
    (row,) = rows(Path("auto/videos.csv"))
    assert "joined of 3 stretches" in row["reason"]
    assert matchset("batch", path, "--out", "clicked", "--pick", row["click"], "--split", 10) == 0
    assert Path("auto/long.mp4/tracks.csv").read_bytes() == Path("clicked/long.mp4/tracks.csv").read_bytes()
    monkeypatch.setattr(choice.doubt_of, "__defaults__", (choice.DoubtParameters(rank=1.0),))
    assert matchset("batch", path, "--out", "doubtful", "--auto", "--split", 10) == 1
    assert rows(Path("doubtful/videos.csv"))[0]["state"] == "doubtful"
    assert Path("doubtful/long.mp4/frame.png").is_file()
    assert len(chosen) == 2


@pytest.mark.parametrize(
    ("hidden", "words"),
    [
        ((range(160, 320),), "joined of 3 stretches, 2 of them followed again: rows differed at a cut"),
        ((range(160, 320), range(460, 620)), "followed whole: rows of 3 stretches differ at all cuts"),
    ],
)
def test_stretches_whose_rows_do_not_agree_are_followed_as_one(
    matchset: Matchset, tmp_path: Path, hidden: tuple[range, ...], words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    short_overlap(monkeypatch)
    gone = {index for each in hidden for index in each}  # nobody is seen where two stretches overlap
    path = write_ball(tmp_path / "clips" / "long.mp4", frames=900, hidden=gone)
    write_color(tmp_path / "ball.npz")
    assert matchset("batch", path, "--out", "whole", "--color", "ball.npz") == 0
    assert matchset("batch", path, "--out", "cut", "--color", "ball.npz", "--split", 10) == 0
    assert Path("whole/long.mp4/tracks.csv").read_bytes() == Path("cut/long.mp4/tracks.csv").read_bytes()
    assert words in Path("cut/videos.csv").read_text()
    assert all(path.is_file() for path in Path("cut/long.mp4").iterdir())
    assert [path.name for path in Path("cut").iterdir() if path.is_dir() and path.name[0] != "."] == ["long.mp4"]


def part(frames: range, places: dict[str, float], shift: int = 0, first: int = 0) -> Part:
    """A stretch with targets at rest: the place of each by its identity."""
    lines = [HEADING]
    for frame in frames:
        lines += [f"{frame - shift},{frame / 30:.6f},1,{x},50.0,10.0,{name},0," for name, x in places.items()]
    marks = [StretchMark(frame - shift, frame / 30, frame / 30, 7 * frame + first) for frame in frames]
    return Part("\n".join(lines).encode() + b"\n", marks)


SHORT = JoinParameters(same=15)


def table_of(stretches: list[Part]) -> list[list[str]]:
    table = joined(stretches, cuts_between(stretches, SHORT)).decode()
    return [line.split(",") for line in table.splitlines()[1:]]


def agree(*stretches: Part) -> list[bool]:
    return [cut.same for cut in cuts_between(stretches, SHORT)]


def test_identities_go_on_and_new_ones_get_new_numbers() -> None:
    one = part(range(100), {"0": 20.0, "1": 80.0})
    other = part(range(60, 200), {"0": 80.0, "1": 20.0, "2": 140.0}, shift=2)
    lines = table_of([one, other])
    assert [int(line[0]) for line in lines] == sorted(int(line[0]) for line in lines)
    assert {int(line[0]) for line in lines} == set(range(200))
    assert {(line[6], line[3]) for line in lines} == {("0", "20.0"), ("1", "80.0"), ("2", "140.0")}
    assert agree(one, other) == [False]  # one more target is seen by the later stretch


def test_where_nobody_is_seen_nothing_says_that_trackers_know_the_same() -> None:
    one, other = part(range(100), {"0": 20.0}), part(range(60, 200), {"0": 20.0})
    assert agree(one, other) == [True]
    for frame in range(50, 110):
        one.rows.pop(frame, None)
        other.rows.pop(frame, None)
    assert agree(one, other) == [False]


def test_frames_in_which_nobody_is_seen_neither_count_nor_end_a_run() -> None:
    one, other = part(range(100), {"0": 20.0}), part(range(60, 200), {"0": 20.0})
    for frame in range(65, 95):
        one.rows.pop(frame)
        other.rows.pop(frame)
    assert agree(one, other) == [False]  # ten frames
    for frame in range(70, 80):
        one.rows[frame] = other.rows[frame] = [[str(frame), "2.0", "1", "20.0", "50.0", "10.0", "0", "0", ""]]
    assert agree(one, other) == [True]


def test_three_stretches_with_other_numbers() -> None:
    cycle = StretchParameters().cycle
    stretches = [part(range(first, first + 100), {"3": 20.0}, shift=k * cycle) for k, first in enumerate((0, 60, 120))]
    lines = table_of(stretches)
    assert [int(line[0]) for line in lines] == list(range(220))
    assert {line[6] for line in lines} == {"3"}
    assert agree(*stretches) == [True, True]


def test_a_tracker_that_counted_other_frames_is_not_joined() -> None:
    shifts = 0, StretchParameters().cycle + 1, 1
    stretches = [part(range(60 * k, 60 * k + 100), {"0": 20.0}, shift=shift) for k, shift in enumerate(shifts)]
    assert agree(*stretches) == [False, False]
    shifts = 0, StretchParameters().cycle + 1, 2 * StretchParameters().cycle
    stretches = [part(range(60 * k, 60 * k + 100), {"0": 20.0}, shift=shift) for k, shift in enumerate(shifts)]
    assert agree(*stretches) == [False, True]  # of the last one all numbers together count


def test_rows_that_differ_later_in_the_overlap_count() -> None:
    one, other = part(range(100), {"0": 20.0}), part(range(60, 200), {"0": 20.0})
    one.rows[80][0][3] = "20.1"
    assert [(cut.frame, cut.same) for cut in cuts_between([one, other], SHORT)] == [(95, True)]
    one.rows[90][0][3] = "20.1"
    assert agree(one, other) == [False]


def test_other_or_missing_pictures_end_a_run() -> None:
    one, other = part(range(120), {"0": 20.0}), part(range(60, 200), {"0": 20.0})
    one.marks[80] = msgspec.structs.replace(one.marks[80], checksum=5)
    assert [(cut.frame, cut.same) for cut in cuts_between([one, other], SHORT)] == [(95, True)]
    del one.marks[110]
    assert agree(one, other) == [False]


def row(frame: int, name: str, place: float, found: bool, alternatives: str = "", reason: str = "") -> list[str]:
    """A row of a target, also of one that is not seen."""
    cells = [f"{place}", "50.0", "10.0"] if found else ["", "", ""]
    return [str(frame), f"{frame / 30:.6f}", str(int(found)), *cells, name, "0", alternatives, reason]


def two_with_names(names: dict[str, str]) -> Part:
    """A stretch of three targets, by names; the third is hidden behind the second, or comes later."""
    late = range(60, 200) if names["0"] != "0" else range(100)
    stretch = part(late, {})
    stretch.names = [*HEADING.split(","), "reason"]
    for frame in late:
        seen = [row(frame, names["0"], 20.0, True, names["1"]), row(frame, names["1"], 80.0, True)]
        if frame < 68:
            last = row(frame, names["2"], 140.0, True)
        else:
            last = row(frame, names["2"], 140.0, False, reason=f"hidden behind target {names['1']}")
        stretch.rows[frame] = sorted([*seen, last], key=lambda each: each[6])
    return stretch


def test_targets_have_the_names_of_the_earlier_stretch_wherever_they_are_named() -> None:
    one, other = two_with_names({"0": "0", "1": "1", "2": "2"}), two_with_names({"0": "2", "1": "0", "2": "1"})
    assert agree(one, other) == [True]
    lines = table_of([one, other])
    for frame in range(200):
        rows_of = [line for line in lines if line[0] == str(frame)]
        assert [line[6] for line in rows_of] == ["0", "1", "2"]
        assert rows_of[0][8] == "1"
        assert rows_of[2][9] == ("" if frame < 68 else "hidden behind target 1")


def test_names_in_rows_that_are_thrown_away_do_not_count() -> None:
    one, other = part(range(100), {"0": 20.0}), part(range(60, 200), {"5": 20.0})
    other.rows[61].append([*other.rows[61][0][:3], "140.0", "50.0", "10.0", "7", "0", ""])
    third = part(range(160, 300), {"0": 20.0})
    for frame in range(250, 300):
        third.rows[frame].append([*third.rows[frame][0][:3], "140.0", "50.0", "10.0", "1", "0", ""])
    assert agree(one, other, third) == [True, True]
    assert {line[6] for line in table_of([one, other, third])} == {"0", "1"}


@pytest.mark.parametrize("other", [part(range(60, 200), {"0": 20.0}, first=1), part(range(100, 200), {"0": 20.0})])
def test_other_pictures_are_not_joined(other: Part) -> None:
    with pytest.raises(MisfitError, match="are the same where they overlap"):
        cuts_between([part(range(100), {"0": 20.0}), other])


def test_options_of_a_batch_are_those_of_track() -> None:
    options = track_options(BatchOptions(videos=[], out="x"), "video.mp4")
    several = SeveralOptions(every=True, most=3, smooth=True)
    asked = track_options(BatchOptions(videos=[], out="x", several=several), "video.mp4").several
    assert (asked.every, asked.most, asked.smooth) == (True, 3, True)
    assert options.source == "video.mp4"
    assert options.shown.no_video


def cut_job(path: Path, **changed: object) -> Job:
    """The job of a video that is to be cut."""
    options = track_options(BatchOptions(videos=[], out="x"), str(path))
    job = Job(video=str(path), folder="a", out="x", options=options, settings="s")
    return msgspec.structs.replace(job, **changed)


def test_a_worker_opens_what_is_to_be_cut(tmp_path: Path) -> None:
    (job,) = parts.Parts(600.0).of(cut_job(tmp_path / "not_here.mp4"))
    assert job.choosing


@pytest.mark.parametrize(
    ("length", "click", "count"),
    [((3600.0, 30.0), "", 6), ((3600.0, 5.0), "", 1), ((0.0, 0.0), "", 1), ((3600.0, 30.0), "5,5@17500", 1)],
)
def test_what_cannot_be_joined_is_not_cut(
    length: tuple[float, float], click: str, count: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(joining.frames_needed, "__defaults__", (JoinParameters(same=300),))
    assert len(parts.Parts(600.0).of(cut_job(tmp_path / "a.mp4", length=length, click=click))) == count


def test_a_click_behind_the_first_stretch(matchset: Matchset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    short_overlap(monkeypatch)
    path = write_ball(tmp_path / "clips" / "long.mp4", frames=900)
    assert matchset("batch", path, "--out", "cut", "--pick", "60,60@400", "--split", 10) == 0
    assert rows(Path("cut/videos.csv"))[0]["reason"] == ""
    assert len(rows(Path("cut/long.mp4/tracks.csv"))) == 900


def test_a_decoder_that_fails_when_the_length_is_asked_costs_one_video(
    matchset: Matchset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(_: Job) -> tuple[float, float]:
        raise cv2.error("bad header")

    monkeypatch.setattr(work, "length_of", fail)
    path = write_ball(tmp_path / "clips" / "long.mp4")
    write_color(tmp_path / "ball.npz")
    assert matchset("batch", path, "--out", "cut", "--color", "ball.npz", "--split", 60) == 1
    assert rows(Path("cut/videos.csv"))[0]["reason"] == "bad header"


@pytest.mark.parametrize("missing", [False, True])
def test_a_video_one_of_whose_stretches_fails_is_followed_whole(
    matchset: Matchset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, missing: bool
) -> None:
    short_overlap(monkeypatch)
    run_command, kept_table = work.run_command, counts.kept_table

    def fail(options: Options) -> int:
        if isinstance(options.silence, StretchOpening) and options.silence.stretch.number == 1:
            raise ValueError("no jump in here")
        return run_command(options)

    def lose(store: Store, folder: str) -> tuple[str, bytes] | None:
        return None if folder.endswith("0001") else kept_table(store, folder)

    if missing:
        monkeypatch.setattr(stretch_work, "kept_table", lose)
    else:
        monkeypatch.setattr(work, "run_command", fail)
    path = write_ball(tmp_path / "clips" / "long.mp4", frames=900)
    write_color(tmp_path / "ball.npz")
    assert matchset("batch", path, "--out", "cut", "--color", "ball.npz", "--split", 10) == 0
    why = "the results of long.mp4.0001 are not there" if missing else "a stretch failed: no jump in here"
    assert rows(Path("cut/videos.csv"))[0]["reason"] == f"followed whole: {why}"
    assert len(rows(Path("cut/long.mp4/tracks.csv"))) == 900
    assert [each.name for each in Path("cut").iterdir() if each.is_dir() and each.name[0] != "."] == ["long.mp4"]


def test_a_join_that_fails_takes_no_place_of_one_that_did_not(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = write_ball(tmp_path / "long.mp4")
    with FolderStore(tmp_path / "out").begun("mark"):
        stretches = Stretch(0, 0.0, 1.0), Stretch(1, 0.0, 2.0)
        job = cut_job(path, out=str(tmp_path / "out"), mark="mark", parts=stretches)
        write_color(tmp_path / "ball.npz")
        target = msgspec.structs.replace(job.options.target, color=[tmp_path / "ball.npz"])
        done = msgspec.structs.replace(job, parts=(), options=msgspec.structs.replace(job.options, target=target))

        def twice(*_: object) -> int:
            monkeypatch.undo()
            assert work.do_job(done).state == "found"
            raise RuntimeError("what was to be joined is gone")

        monkeypatch.setattr(work, "join_stretches", twice)
        assert work.do_job(job).state == "found"
    assert len(rows(tmp_path / "out/a/tracks.csv")) == 12


@pytest.mark.parametrize("url", [False, True])
def test_a_video_that_was_joined_when_the_batch_was_killed_is_not_followed_again(
    matchset: Matchset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, url: bool
) -> None:
    pytest.importorskip("fsspec", reason="fsspec is not installed")
    short_overlap(monkeypatch)
    path = write_ball(tmp_path / "clips" / "long.mp4", frames=900)
    write_color(tmp_path / "ball.npz")
    out = f"memory://{tmp_path.name}/cut" if url else str(tmp_path / "cut")
    words = "batch", path, "--out", out, "--color", "ball.npz", "--split", 10
    assert matchset(*words) == 0
    store = store_at(out)
    for name in store.names("manifest") if url else ():  # killed before the lines were written
        store.write(f"manifest/{name}", (store.read(f"manifest/{name}") or b"").splitlines(keepends=True)[0])
    if not url:
        heading = (store.read("manifest.jsonl") or b"").splitlines(keepends=True)[0]
        store.write("manifest.jsonl", heading)
    for number in range(2):  # and before the stretches were removed
        store.write(f"long.mp4.{number:04d}/run.json", b"{}")
    given = list[Job]()
    monkeypatch.setattr(HerePool, "give", lambda _, job: given.append(job))
    assert matchset(*words) == 0
    assert given == []
    assert not store.names("long.mp4.0000")
    assert not store.names("long.mp4.0001")


class IdlePool:
    """Takes jobs, and does none."""

    def __init__(self) -> None:
        self.notes, self.given = list[str](), list[Job]()
        self.free, self.running = 9, dict[str, float]()

    def give(self, job: Job) -> None:
        self.given.append(job)
        self.free -= 1

    def answers(self, _: float) -> list[Answer]:
        answers = [
            Answer(job, VideoOutcome(video="v", folder="a", settings="s", state="chosen", length=(3600.0, 30.0)))
            for job in self.given
            if job.choosing
        ]
        self.given = [job for job in self.given if not job.choosing]
        return answers


def test_what_was_clicked_on_the_page_is_cut_too(tmp_path: Path) -> None:
    click = SimpleNamespace(video="a.mp4", folder="a", pick="1,1")
    clicks = [[], [], [click]]
    choice_of: Any = SimpleNamespace(add=lambda *_: None)
    plan: Any = SimpleNamespace(
        split=600.0, earlier=0, work=lambda: iter(()), choice=choice_of, again=lambda *_: cut_job(tmp_path / "a.mp4")
    )
    clicker: Any = SimpleNamespace(clicks=clicks.pop, waits=False)
    pool = IdlePool()
    here: Any = pool
    manifest: Any = None
    batch = Batch(plan, manifest, BatchCounts(1), clicker)
    while clicks:
        batch.step(here)
    assert [job.stretch.number for job in pool.given if job.stretch is not None] == list(range(6))
