"""A full disk: whatever was written before stays whole, every file is named, and nothing is lost in silence."""

import errno
import resource
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import pytest
from benchmarks.lost.full_disk import Ended, run_on_full_disk, small_disk
from benchmarks.lost.runs import RUNS, Run, typed, write_clip

from blue_ball import Matchset
from chain_flight import Flown
from matchset.app.disk import FreeSpace, SpaceParameters, UnfinishedFileError, WholeFile
from matchset.app.exit_codes import errors_in_one_line
from matchset.app.films.video_writer import FilmWriter, FilmWriterParameters
from matchset.app.tables import Column, RowWriter
from matchset.flight.recording.reader import RecordingReader
from matchset.flight.recording.writer import RecordingWriter
from matchset.image.files.whole_file import write_whole
from matchset.media.closing import close_all

SIZE = 160, 120
NO_GUARD = SpaceParameters(keep_free=0.0)


@pytest.fixture(scope="module")
def clip(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("clip") / "clip.avi"
    write_clip(path, 200)
    return path


@pytest.fixture
def short_of_room(tmp_path: Path) -> Iterator[Path]:
    """No file may be longer than 60 kB: what a full disk does, for users who may mount nothing."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (60_000, before[1]))
    yield tmp_path
    resource.setrlimit(resource.RLIMIT_FSIZE, before)


@pytest.fixture
def run_here(matchset: Matchset, capfd: pytest.CaptureFixture[str]) -> Ended:
    """Run a command in this process, which has its code loaded; returns the exit code and what was said."""

    def run(run: Run, clip: Path, disk: Path, other: Path) -> tuple[int, str]:
        capfd.readouterr()
        return matchset(*typed(run, clip, disk, other)), capfd.readouterr().err

    return run


SHORT_FLIGHT = RUNS["recording"]._replace(words=tuple("0.5" if w == "1.5" else w for w in RUNS["recording"].words))


# Bytes of the disk, well below what each command writes; `python -m benchmarks.lost.full_disk` tries 20 random sizes.
@pytest.mark.parametrize(
    ("title", "size"),
    [
        ("table and webm", 150_000),
        ("poses", 40_000),
        ("color", 8_000),
        ("recording", 4_000_000),
    ],
)
def test_a_full_disk_ends_in_two_and_names_what_is_left(
    clip: Path, tmp_path: Path, run_here: Ended, title: str, size: int
) -> None:
    try:
        with small_disk(tmp_path, 4096):
            pass
    except OSError as error:
        pytest.skip(f"a small disk cannot be mounted here: {error}")
    end = run_on_full_disk(SHORT_FLIGHT if title == "recording" else RUNS[title], clip, tmp_path, size, run_here)
    assert end.wrong == (), end.line


@pytest.mark.parametrize("title", ["mp4", "table and mp4"])
def test_a_disk_on_which_not_even_the_beginning_of_a_film_fits_is_named(clip: Path, tmp_path: Path, title: str) -> None:
    try:
        with small_disk(tmp_path, 4096):
            pass
    except OSError as error:
        pytest.skip(f"a small disk cannot be mounted here: {error}")
    end = run_on_full_disk(RUNS[title], clip, tmp_path, 4096)
    assert end.wrong == (), end.line


@pytest.mark.parametrize("suffix", [".mp4", ".webm", ".avi"])
@pytest.mark.parametrize("packer", ["PyAV", "OpenCV"])
def test_a_film_that_does_not_fit_says_how_much_it_holds(
    short_of_room: Path, monkeypatch: pytest.MonkeyPatch, suffix: str, packer: str
) -> None:
    if packer == "PyAV":
        pytest.importorskip("av")
    else:
        monkeypatch.setitem(sys.modules, "av", None)
    rng = np.random.default_rng(0)
    path = short_of_room / f"film{suffix}"
    film = FilmWriter(path, 30.0, SIZE, parameters=FilmWriterParameters(space=NO_GUARD))
    for _ in range(60):
        film.write(rng.integers(110, 146, (SIZE[1], SIZE[0], 3), np.uint8))
    with pytest.raises(UnfinishedFileError, match=r"it holds \d+ of 60 pictures") as raised:
        film.close()
    assert raised.value.filename == str(path)
    video = cv2.VideoCapture(str(path))
    held = sum(video.grab() for _ in range(60))
    assert f"it holds {held} of 60" in str(raised.value)
    assert held >= 1 or packer == "OpenCV"
    film.close()  # again does no harm


def test_a_table_that_does_not_fit_ends_with_a_whole_row(short_of_room: Path) -> None:
    path = short_of_room / "long.csv"
    columns = [Column("number", lambda row: int(row)), Column("words", lambda _: "x" * 3000)]
    rows: RowWriter[int] = RowWriter(path, columns)
    for number in range(19):
        rows.write(number)
    with pytest.raises(UnfinishedFileError, match="it holds 19 rows"):
        rows.write(19)
    rows.close()
    lines = path.read_text(encoding="utf-8").splitlines()
    assert len(lines) == 20
    assert lines[-1] == "18," + "x" * 3000


def test_a_recording_that_does_not_fit_never_ends_the_flight(flown: Flown, tmp_path: Path) -> None:
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (8_000_000, before[1]))
    try:
        out = RecordingWriter(tmp_path / "a.mcap", flown.setup, NO_GUARD)
        for chain_step in flown.chain_steps:
            out.write(chain_step, (True, True))
        with pytest.raises(UnfinishedFileError, match=f"it holds [45] of {len(flown.chain_steps)} steps") as raised:
            out.close()
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    recorded = RecordingReader(tmp_path / "a.mcap")
    assert f"holds {len(list(recorded))} of" in str(raised.value)
    assert recorded.cut_off


def test_films_and_recordings_stop_while_there_is_room_for_the_rest(flown: Flown, tmp_path: Path) -> None:
    everything = SpaceParameters(keep_free=1e12, keep_share=1.0)
    out = RecordingWriter(tmp_path / "a.mcap", flown.setup, everything)
    out.write(flown.chain_steps[0], (True, True))
    with pytest.raises(UnfinishedFileError, match=r"stopped, since only .* MB are free on its disk; it holds 0 of 1"):
        out.close()
    recorded = RecordingReader(tmp_path / "a.mcap")
    assert list(recorded) == []
    assert not recorded.cut_off  # stopped in time, so it has its index
    film = FilmWriter(tmp_path / "a.avi", 30.0, SIZE, parameters=FilmWriterParameters(space=everything))
    film.write(np.zeros((SIZE[1], SIZE[0], 3), np.uint8))
    with pytest.raises(UnfinishedFileError, match="it holds 0 of 1 pictures"):
        film.close()
    assert FreeSpace(tmp_path / "b", SpaceParameters()).left > FreeSpace(tmp_path / "b", everything).left
    for wrong in ({"keep_free": -1.0}, {"keep_share": 2.0}):
        with pytest.raises(ValueError, match="must be"):
            SpaceParameters(**wrong)


def test_a_file_of_one_piece_is_written_whole_or_not_at_all(short_of_room: Path) -> None:
    path = short_of_room / "a.npz"
    write_whole(path, b"before")
    with pytest.raises(OSError, match="too large") as raised:
        write_whole(path, bytes(300_000))
    assert raised.value.filename == str(path)
    assert path.read_bytes() == b"before"
    assert list(short_of_room.iterdir()) == [path]


def test_a_piece_that_does_not_fit_is_taken_back(short_of_room: Path) -> None:
    with WholeFile(short_of_room / "a") as file:
        file.append(bytes(50_000))
        with pytest.raises(OSError, match="too large"):
            file.append(bytes(20_000))
        file.append(b"dropped")
    assert (short_of_room / "a").stat().st_size == file.size == 50_000


def test_everything_is_closed_and_every_error_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    closed = []

    def close(name: str) -> None:
        closed.append(name)
        raise UnfinishedFileError(OSError(errno.ENOSPC, "full"), Path(name), "2 rows")

    with pytest.raises(SystemExit) as ended, errors_in_one_line():
        close_all(lambda: close("a"), lambda: closed.append("b"), lambda: close("c"))
    assert (ended.value.code, closed) == (2, ["a", "b", "c"])
    assert capsys.readouterr().err == "error: a: full; it holds 2 rows; c: full; it holds 2 rows\n"


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no /dev/full here")
def test_a_full_stdout_is_named(clip: Path, tmp_path: Path) -> None:
    for words in (["track", str(clip), "--pick", "50,60", "--print", "-o", str(tmp_path / "out")], ["params"]):
        with Path("/dev/full").open("w") as full:
            command = [sys.executable, "-m", "matchset.cli", *words]
            ended = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True)
        assert ended.returncode == 2
        assert ended.stderr.splitlines()[-1] == "error: stdout: No space left on device"
