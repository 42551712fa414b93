"""`matchset batch`: what is written, what a second run does, bad input."""

import csv
import errno
import os
import sys
from pathlib import Path

import msgspec
import pytest

from batched_videos import HerePool, write_ball, write_balls, write_color
from blue_ball import Matchset
from matchset.batch import run
from matchset.batch.jobs import work
from matchset.batch.jobs.identity import content_digest
from matchset.batch.jobs.job import VideoOutcome
from matchset.batch.jobs.video_options import Options
from matchset.batch.results.store import FolderStore

FILES = {"all.csv", "videos.csv", "summary.html", "manifest.jsonl"}


@pytest.fixture
def pools(monkeypatch: pytest.MonkeyPatch) -> list[HerePool]:
    """Let batches work in this process; the pools that they made."""
    made = list[HerePool]()

    def make(*_: object) -> HerePool:
        made.append(HerePool())
        return made[-1]

    monkeypatch.setattr(run, "Processes", make)
    return made


@pytest.fixture
def clips(tmp_path: Path) -> Path:
    return write_balls(tmp_path / "clips", 4)


@pytest.fixture
def color(tmp_path: Path) -> Path:
    return write_color(tmp_path / "ball.npz")


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as text:
        return list(csv.DictReader(text))


def outcomes(out: Path) -> list[VideoOutcome]:
    lines = (out / "manifest.jsonl").read_bytes().splitlines()[1:]
    return [msgspec.json.decode(line, type=VideoOutcome) for line in lines]


def test_tables_are_those_of_track(matchset: Matchset, pools: list[HerePool], clips: Path, color: Path) -> None:
    assert matchset("batch", clips, "--out", "results", "--color", color) == 0
    assert {path.name for path in Path("results").iterdir()} >= FILES
    for video in sorted(clips.rglob("*.mp4")):
        assert matchset("track", video, "--color", color, "--no-video", "-o", "one", "--force") == 0
        name = video.relative_to(clips)
        assert (Path("one") / "tracks.csv").read_bytes() == (Path("results") / name / "tracks.csv").read_bytes()
    table = rows(Path("results/videos.csv"))
    assert [row["video"] for row in table] == ["day0/ball0.mp4", "day0/ball2.mp4", "day1/ball1.mp4", "day1/ball3.mp4"]
    assert all(row["state"] == "found" and row["share"] == "1.0000" for row in table)
    assert len(rows(Path("results/all.csv"))) == 48


def test_all_of_them_as_parquet(matchset: Matchset, pools: list[HerePool], clips: Path, color: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet", reason="pyarrow is not installed")
    assert matchset("batch", clips, "--out", "results", "--color", color) == 0
    table = parquet.read_table("results/all.parquet")
    assert [str(value) for value in table.column("x").to_pylist()] == [
        row["x"] for row in rows(Path("results/all.csv"))
    ]
    assert table.schema.field("frame").type == "int64"
    assert table.schema.field("video").type == "string"


def test_second_run_does_nothing(matchset: Matchset, pools: list[HerePool], clips: Path, color: Path) -> None:
    for _ in range(2):
        assert matchset("batch", clips, "--out", "results", "--color", color) == 0
    assert [len(pool.done) for pool in pools] == [4, 0]
    before = Path("results/day0/ball0.mp4/tracks.csv").read_bytes()
    write_ball(clips / "day0" / "ball0.mp4", 3)
    write_ball(clips / "day0" / "new.mp4", 4)
    assert matchset("batch", clips, "--out", "results", "--color", color) == 0
    assert Path("results/day0/ball0.mp4/tracks.csv").read_bytes() != before
    assert sorted(Path(job.video).name for job in pools[2].done) == ["ball0.mp4", "new.mp4"]
    assert len(rows(Path("results/videos.csv"))) == 5


def test_other_settings_do_all_again(matchset: Matchset, pools: list[HerePool], clips: Path, color: Path) -> None:
    assert matchset("batch", clips, "--out", "results", "--color", color) == 0
    assert matchset("batch", clips, "--out", "results", "--color", color, "--points", 32) == 0
    assert len(pools[1].done) == 4


def test_settings_of_before_are_done_again(matchset: Matchset, pools: list[HerePool], clips: Path, color: Path) -> None:
    for points in (64, 32, 64):
        assert matchset("batch", clips, "--out", "results", "--color", color, "--points", points) == 0
    assert [len(pool.done) for pool in pools] == [4, 4, 4]  # what lay in the folders was of the others


def test_videos_are_never_replaced_by_results(
    matchset: Matchset, pools: list[HerePool], clips: Path, color: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = {path: path.read_bytes() for path in clips.rglob("*.mp4")}
    assert matchset("batch", clips, "--out", clips, "--color", color) == 2
    assert "--out is the folder of the videos" in capsys.readouterr().err
    Path("results/day0").mkdir(parents=True)
    Path("results/day0/ball0.mp4").write_text("something of mine")
    assert matchset("batch", clips, "--out", "results", "--color", color) == 2
    assert "is not of a batch" in capsys.readouterr().err
    assert Path("results/day0/ball0.mp4").read_text() == "something of mine"
    assert {path: path.read_bytes() for path in clips.rglob("*.mp4")} == before


def test_a_copied_video_is_known_by_its_content(
    matchset: Matchset, pools: list[HerePool], clips: Path, color: Path
) -> None:
    assert matchset("batch", clips, "--out", "results", "--color", color) == 0
    before = Path("results/day0/ball0.mp4/run.json").stat().st_mtime_ns
    os.utime(clips / "day0/ball0.mp4", ns=(1, 1))
    assert matchset("batch", clips, "--out", "results", "--color", color) == 0
    assert [Path(job.video).name for job in pools[1].done] == ["ball0.mp4"]
    assert Path("results/day0/ball0.mp4/run.json").stat().st_mtime_ns == before


def test_a_table_that_was_changed_is_written_again(
    matchset: Matchset, pools: list[HerePool], clips: Path, color: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert matchset("batch", clips, "--out", "results", "--color", color) == 0
    table, other = Path("results/day0/ball0.mp4/tracks.csv"), Path("results/day0/ball2.mp4/tracks.csv")
    before = table.read_bytes()
    table.write_bytes(other.read_bytes())  # such as one by other settings, of a batch that was killed behind it
    assert matchset("batch", clips, "--out", "results", "--color", color) == 1
    assert "1 videos have no table, or another one than was noted: the same command goes on" in capsys.readouterr().err
    assert len(rows(Path("results/videos.csv"))) == 3
    assert matchset("batch", clips, "--out", "results", "--color", color) == 0
    assert [Path(job.video).name for job in pools[2].done] == ["ball0.mp4"]
    assert table.read_bytes() == before


def test_manifest_cut_in_half_goes_on(matchset: Matchset, pools: list[HerePool], clips: Path, color: Path) -> None:
    assert matchset("batch", clips, "--out", "results", "--color", color) == 0
    manifest = Path("results/manifest.jsonl")
    whole = manifest.read_bytes()
    manifest.write_bytes(whole[: len(whole) // 2])
    assert matchset("batch", clips, "--out", "results", "--color", color) == 0
    assert pools[1].done == []  # the folders of the results say what became of them
    assert len(outcomes(Path("results"))) == 4
    assert len(rows(Path("results/videos.csv"))) == 4


def test_broken_line_is_said(
    matchset: Matchset, pools: list[HerePool], clips: Path, color: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert matchset("batch", clips, "--out", "results", "--color", color) == 0
    manifest = Path("results/manifest.jsonl")
    lines = manifest.read_bytes().splitlines(keepends=True)
    lines[2] = b"\x00" * 40 + b"\n"
    manifest.write_bytes(b"".join(lines))
    assert matchset("batch", clips, "--out", "results", "--color", color) == 0
    assert "1 lines of the manifest cannot be read" in capsys.readouterr().err


def test_foreign_file_is_no_manifest(
    matchset: Matchset, clips: Path, color: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("results").mkdir()
    Path("results/manifest.jsonl").write_text("frame,time\n")
    assert matchset("batch", clips, "--out", "results", "--color", color) == 2
    assert "is not a manifest of a batch" in capsys.readouterr().err


def test_one_that_fails_is_a_row(matchset: Matchset, pools: list[HerePool], clips: Path, color: Path) -> None:
    (clips / "day0" / "broken.mp4").write_bytes(b"no video")
    assert matchset("batch", clips, "--out", "results", "--color", color) == 1
    broken = next(row for row in rows(Path("results/videos.csv")) if row["state"] == "failed")
    assert broken["video"] == "day0/broken.mp4"
    assert "not a video" in broken["reason"]
    assert "error:" in Path("results/day0/broken.mp4/log.txt").read_text()
    assert matchset("batch", clips, "--out", "results", "--color", color) == 1
    assert pools[1].done == []
    assert matchset("batch", clips, "--out", "results", "--color", color, "--retry") == 1
    assert [Path(job.video).name for job in pools[2].done] == ["broken.mp4"]


def test_full_disk_stops(
    matchset: Matchset,
    pools: list[HerePool],
    clips: Path,
    color: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def full(_: object) -> int:
        raise OSError(errno.ENOSPC, "No space left on device", "tracks.csv")

    with monkeypatch.context() as patched:
        patched.setattr(work, "run_command", full)
        assert matchset("batch", clips, "--out", "results", "--color", color) == 2
    assert "no room for the results" in capsys.readouterr().err
    assert outcomes(Path("results")) == []
    assert matchset("batch", clips, "--out", "results", "--color", color) == 0
    assert len(outcomes(Path("results"))) == 4


def test_two_batches_into_one_folder(
    matchset: Matchset, pools: list[HerePool], clips: Path, color: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    fcntl = pytest.importorskip("fcntl", reason="locks of files are others here")
    Path("results").mkdir()
    with Path("results/.lock").open("w") as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        assert matchset("batch", clips, "--out", "results", "--color", color) == 2
    assert "another batch writes into" in capsys.readouterr().err


def test_names_that_are_no_text(matchset: Matchset, pools: list[HerePool], tmp_path: Path, color: Path) -> None:
    odd = [b"a\nb.mp4", b"100%.mp4", b"\xff\xfe.mp4", "läufer, 2.mp4".encode()]
    plain = write_ball(tmp_path / "plain.mp4")
    clips = tmp_path / "odd"
    clips.mkdir()
    for name in odd:
        (clips / os.fsdecode(name)).write_bytes(plain.read_bytes())
    matchset("batch", clips, "--out", "results", "--color", color)
    states = {row["video"]: row["state"] for row in rows(Path("results/videos.csv"))}
    assert set(states) == {"100%25.mp4", "%FF%FE.mp4", "a%0Ab.mp4", "läufer, 2.mp4"}
    assert {name for name, state in states.items() if state != "found"} <= {"%FF%FE.mp4"}  # OpenCV may not open it
    assert Path("results/a%0Ab.mp4/tracks.csv").is_file()


@pytest.mark.skipif(sys.platform == "win32", reason="there are no such files")
def test_what_is_no_file(matchset: Matchset, pools: list[HerePool], clips: Path, color: Path) -> None:
    os.mkfifo(clips / "pipe.mp4")
    (clips / "loop.mp4").symlink_to("loop.mp4")
    (clips / "day0" / "all").symlink_to(clips)  # is not gone into, again and again
    (clips / "gone.mp4").symlink_to("nothing")
    assert matchset("batch", clips, "--out", "results", "--color", color) == 1
    reasons = {row["video"]: row["reason"] for row in rows(Path("results/videos.csv")) if row["state"] != "found"}
    assert reasons == {
        "gone.mp4": "no such file",
        "loop.mp4": os.strerror(errno.ELOOP),
        "pipe.mp4": "it is a pipe or a device, which does not end",
    }
    assert len(pools[0].done) == 4


def test_what_must_not_be_read(
    matchset: Matchset,
    pools: list[HerePool],
    clips: Path,
    color: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def digest(video: str) -> str:
        if video.endswith("ball0.mp4"):
            raise PermissionError(errno.EACCES, "Permission denied", video)
        return content_digest(video)

    scandir = os.scandir

    def scan(path: str) -> object:
        if str(path).endswith("day1"):
            raise PermissionError(errno.EACCES, "Permission denied", path)
        return scandir(path)

    monkeypatch.setattr(work, "content_digest", digest)
    monkeypatch.setattr(os, "scandir", scan)
    assert matchset("batch", clips, "--out", "results", "--color", color) == 1
    table = {row["video"]: (row["state"], row["reason"]) for row in rows(Path("results/videos.csv"))}
    problem = f"cannot read {clips}/day0/ball0.mp4: Permission denied"
    assert table == {"ball0.mp4": ("failed", problem), "ball2.mp4": ("found", "")}
    assert f"note: {clips}/day1: Permission denied: what is in it is left out" in capsys.readouterr().err


def test_names_that_differ_in_case_alone(
    matchset: Matchset, pools: list[HerePool], clips: Path, color: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (clips / "day0" / "BALL0.mp4").write_bytes((clips / "day0" / "ball0.mp4").read_bytes())
    monkeypatch.setattr(FolderStore, "ignores_case", True)
    assert matchset("batch", clips, "--out", "results", "--color", color) == 1
    failed = {row["video"]: row["reason"] for row in rows(Path("results/videos.csv")) if row["state"] == "failed"}
    assert list(failed) == ["day0/ball0.mp4"]
    assert "differs in upper and lower case alone" in failed["day0/ball0.mp4"]
    monkeypatch.setattr(FolderStore, "ignores_case", False)
    assert matchset("batch", clips, "--out", "results", "--color", color, "--retry") == 0


def test_a_video_that_grows_while_it_is_followed(
    matchset: Matchset, pools: list[HerePool], clips: Path, color: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    growing, run_command = clips / "day0" / "ball0.mp4", work.run_command

    def run_and_grow(options: Options) -> int:
        if options.source == str(growing):
            with growing.open("ab") as file:
                file.write(bytes(8))
        return run_command(options)

    with monkeypatch.context() as patched:
        patched.setattr(work, "run_command", run_and_grow)
        assert matchset("batch", clips, "--out", "results", "--color", color) == 0
    reasons = {row["video"]: row["reason"] for row in rows(Path("results/videos.csv"))}
    assert [name for name, reason in reasons.items() if reason == "it has changed meanwhile"] == ["day0/ball0.mp4"]
    assert matchset("batch", clips, "--out", "results", "--color", color) == 0
    assert [job.folder for job in pools[1].done] == ["day0/ball0.mp4"]


def test_several_and_locate(matchset: Matchset, pools: list[HerePool], clips: Path, color: Path) -> None:
    assert matchset("batch", clips, "--out", "several", "--color", color, "--all") == 0
    assert "identity" in rows(Path("several/all.csv"))[0]
    words = "--locate", "--fov", 60, "--diameter", 0.2
    assert matchset("batch", clips, "--out", "located", "--color", color, *words) == 0
    assert "z" in rows(Path("located/all.csv"))[0]
    assert matchset("locate", clips / "day0/ball0.mp4", *words[1:], "--color", color, "--no-video", "-o", "one") == 0
    assert Path("one/poses.csv").read_bytes() == Path("located/day0/ball0.mp4/poses.csv").read_bytes()


def test_color_of_the_folder(
    matchset: Matchset, pools: list[HerePool], clips: Path, color: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (clips / "day0" / "green.npz").write_bytes(color.read_bytes())
    assert matchset("batch", clips, "--out", "results", "--color-name", "green.npz") == 1
    states = {row["video"]: row["state"] for row in rows(Path("results/videos.csv"))}
    assert states["day0/ball0.mp4"] == "found"
    assert states["day1/ball1.mp4"] == "failed"
    assert "there is no green.npz" in Path("results/videos.csv").read_text()


def test_clicks(matchset: Matchset, pools: list[HerePool], clips: Path) -> None:
    table = "video,frame,x,y\n" + "".join(
        f"{name},0,{x},60\n" for name, x in (("ball0.mp4", 60), ("day1/ball1.mp4", 80))
    )
    Path("clicks.csv").write_text(table)
    assert matchset("batch", clips, "--out", "results", "--clicks", "clicks.csv") == 1
    found = {row["video"]: row for row in rows(Path("results/videos.csv"))}
    assert found["day0/ball0.mp4"]["state"] == found["day1/ball1.mp4"]["state"] == "found"
    assert found["day0/ball2.mp4"]["reason"] == "no click says what to follow in it"


def test_a_click_for_several_videos_is_refused(
    matchset: Matchset, pools: list[HerePool], clips: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_ball(clips / "day0/ball1.mp4", 1)
    write_ball(clips / "day0/ball3.mp4", 3)
    Path("clicks.csv").write_text("video,frame,x,y\nball0.mp4,0,60,60\nball1.mp4,0,80,60\n")
    assert matchset("batch", clips, "--out", "results", "--clicks", "clicks.csv") == 2
    said = capsys.readouterr().err
    assert f"clicks.csv, line 3: ball1.mp4 is the name of 2 videos, {clips}/day0/ball1.mp4, {clips}/day1/" in said
    assert pools == []


def test_a_click_is_of_the_video_that_has_more_of_its_name(
    matchset: Matchset, pools: list[HerePool], clips: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_ball(clips / "ball1.mp4", 1)
    table = "video,frame,x,y\nball1.mp4,0,80,60\nday1/ball1.mp4,0,80,60\nball3.mp4,0,80,60\nbal.mp4,0,1,2\nx,0,1,2\n"
    Path("clicks.csv").write_text(table + f"{clips}/day1/ball3.mp4,5,85,60\n")
    assert matchset("batch", clips, "--out", "results", "--clicks", "clicks.csv") == 1
    picks = {job.folder: job.options.target.picks for job in pools[0].done}
    assert picks == {
        "ball1.mp4": ["80,60@0"],
        "day1/ball1.mp4": ["80,60@0"],
        "day1/ball3.mp4": ["80,60@0", "85,60@5"],
    }
    assert "clicks.csv, line 5: 2 names of no video here, 'bal.mp4'" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "problem"),
    [
        (("--color", "ball.npz", "--auto"), "give one of --color"),
        ((), "say what to follow"),
        (("--color", "missing.npz"), "missing.npz"),
        (("--clicks", "missing.csv"), "no such file"),
        (
            ("--color", "ball.npz", "--jobs", 2, "--scheduler", "tcp://127.0.0.1:1"),
            "give one of --jobs and --scheduler",
        ),
        (("--color", "ball.npz", "--locate", "--shape", "ellipse"), "--shape and --gray are of 'track'"),
        (("--color", "ball.npz", "--split", 5), "--split must be 60 s at least"),
        (("--color", "ball.npz", "--split", 60, "--films"), "--films is of whole videos"),
        (("--color", "ball.npz", "--split", 60, "--all", "--smooth"), "--smooth is of whole videos"),
        (("--color", "ball.npz", "--most", 3), "--most is of several targets"),
    ],
)
def test_what_does_not_fit_is_said(
    matchset: Matchset,
    clips: Path,
    color: Path,
    words: tuple[object, ...],
    problem: str,
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert matchset("batch", clips, "--out", "results", *words) == 2
    assert problem in capsys.readouterr().err
