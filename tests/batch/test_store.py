"""Results in a folder and at a URL: the same, whatever was there before."""

import contextlib
import time
from collections.abc import Iterator
from pathlib import Path

import msgspec
import pytest

from batched_videos import HerePool, write_balls, write_color
from blue_ball import Matchset
from matchset.batch import run
from matchset.batch.jobs.identity import code_digest
from matchset.batch.jobs.job import Job
from matchset.batch.jobs.video_options import track_options
from matchset.batch.jobs.work import UnfitWorkerError, do_job
from matchset.batch.options import BatchOptions
from matchset.batch.results import lock
from matchset.batch.results.lock import Owner, RemoteLock
from matchset.batch.results.store import FolderStore, Store, SupersededError, store_at


@pytest.fixture(params=["folder", "url"])
def store(request: pytest.FixtureRequest, tmp_path: Path) -> Store:
    if request.param == "folder":
        return FolderStore(tmp_path / "results")
    pytest.importorskip("fsspec", reason="fsspec is not installed")
    return store_at(f"memory://{tmp_path.name}/results")


def keep(store: Store, **files: str) -> None:
    with store.begun("mark"), store.unfinished() as folder:
        for name, text in files.items():
            (folder / name.replace("_", ".")).write_text(text)
        store.keep(folder, "a/b")


def test_a_folder_takes_the_place_of_the_one_before(store: Store) -> None:
    keep(store, tracks_csv="1", why_png="2", run_json="3")
    keep(store, tracks_csv="4", run_json="5")
    assert store.names("a/b") == ["run.json", "tracks.csv"]
    assert store.read("a/b/tracks.csv") == b"4"
    assert store.read("a/b/why.png") is None
    with store.begun("another"):
        store.remove("a/b")
        assert store.names("a/b") == []
        store.remove("a/b")


def test_nothing_is_kept_for_a_batch_that_is_not_the_last(store: Store, tmp_path: Path) -> None:
    keep(store, tracks_csv="1", why_png="2", run_json="3")
    url = f"memory://{tmp_path.name}/results"
    other = FolderStore(tmp_path / "results") if isinstance(store, FolderStore) else store_at(url)
    with store.begun("old"), store.unfinished() as folder:
        for name in ("tracks.csv", "run.json"):
            (folder / name).write_text("old")
        assert store.is_current()
        with other.begun("new"):
            assert not store.is_current()
            assert other.is_current()
            with pytest.raises((SupersededError, FileNotFoundError)):
                store.keep(folder, "a/b")
            with contextlib.suppress(SupersededError):
                store.remove("a/b")
            assert store.names("a/b") == ["run.json", "tracks.csv", "why.png"]
            assert store.read("a/b/tracks.csv") == b"1"


def test_what_says_that_files_are_whole_comes_last(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fsspec = pytest.importorskip("fsspec", reason="fsspec is not installed")
    memory, written = fsspec.get_filesystem_class("memory"), list[str]()
    put_file = memory.put_file

    def note(files: object, path: str, name: str, **more: object) -> None:
        written.append(name.rpartition("/")[2])
        put_file(files, path, name, **more)

    monkeypatch.setattr(memory, "put_file", note)
    keep(store_at(f"memory://{tmp_path.name}/last"), why_png="1", run_json="2", tracks_csv="3", a_txt="4")
    assert written == ["a.txt", "tracks.csv", "why.png", "run.json"]


def test_what_is_not_of_a_batch_is_not_replaced(store: Store) -> None:
    store.write("a/b/tracks.csv", b"mine")
    with pytest.raises(ValueError, match="is not of a batch: choose another --out"):
        keep(store, tracks_csv="1", run_json="3")
    assert store.read("a/b/tracks.csv") == b"mine"


def test_what_is_half_written_at_a_url_is_replaced(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fsspec = pytest.importorskip("fsspec", reason="fsspec is not installed")
    store = store_at(f"memory://{tmp_path.name}/half")
    memory = fsspec.get_filesystem_class("memory")
    put_file, written = memory.put_file, list[str]()

    def put_one(files: object, path: str, name: str, **more: object) -> None:
        if written:
            raise RuntimeError("cut off")
        written.append(name.rpartition("/")[2])
        put_file(files, path, name, **more)

    with monkeypatch.context() as patched:
        patched.setattr(memory, "put_file", put_one)
        with pytest.raises(OSError, match="cut off"):
            keep(store, a_csv="1", log_txt="2", run_json="3")
    assert written == store.names("a/b") == ["log.txt"]
    keep(store, a_csv="1", log_txt="2", run_json="3")
    assert store.names("a/b") == ["a.csv", "log.txt", "run.json"]


@pytest.mark.parametrize("name", ["videos.csv", "all.csv", "summary.html", "clicks.csv"])
def test_files_of_somebody_else_in_the_place_of_results_stay(
    matchset: Matchset, tmp_path: Path, name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    clips, color = write_balls(tmp_path / "clips", 1), write_color(tmp_path / "ball.npz")
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / name).write_text("mine")
    assert matchset("batch", clips, "--out", tmp_path / "out", "--color", color) == 2
    assert f"has {name}, but no batch has written there" in capsys.readouterr().err
    assert (tmp_path / "out" / name).read_text() == "mine"


def test_files(store: Store, tmp_path: Path) -> None:
    assert store.read("x/y.txt") is None
    store.write("x/y.txt", b"one")
    store.write("x/y.txt", b"two")
    assert store.read("x/y.txt") == b"two"
    path = tmp_path / "z.txt"
    path.write_text("three")
    store.put(path, "z.txt")
    assert store.read("z.txt") == b"three"


def test_batch_at_a_url(matchset: Matchset, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("fsspec", reason="fsspec is not installed")
    monkeypatch.setattr(run, "Processes", HerePool)
    clips, color = write_balls(tmp_path / "clips", 3), write_color(tmp_path / "ball.npz")
    url = f"memory://{tmp_path.name}/out"
    for _ in range(2):
        assert matchset("batch", clips, "--out", url, "--color", color) == 0
    assert matchset("batch", clips, "--out", "here", "--color", color) == 0
    remote, here = store_at(url), FolderStore(Path("here"))
    for name in ("all.csv", "day0/ball0.mp4/tracks.csv"):
        assert remote.read(name) == here.read(name)
    lines = b"".join(remote.read(f"manifest/{name}") or b"" for name in remote.names("manifest"))
    assert len(lines.splitlines()) == 1 + 3


def test_two_batches_at_one_url(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    pytest.importorskip("fsspec", reason="fsspec is not installed")
    store = store_at(f"memory://{tmp_path.name}/locked")
    with RemoteLock(store, "there"), pytest.raises(ValueError, match="another batch writes into there"):
        RemoteLock(store, "there").__enter__()
    with RemoteLock(store, "there"):  # the first one has ended
        pass
    store.write(".lock", msgspec.json.encode(Owner("killed", 1.0)))
    with RemoteLock(store, "there"):  # killed long ago
        assert lock.PARAMETERS.dead > lock.PARAMETERS.beat
    store.write(".lock", b"no json")
    with RemoteLock(store, "there"):
        pass


def test_a_batch_that_slept_leaves_the_place_to_the_next_one(tmp_path: Path) -> None:
    pytest.importorskip("fsspec", reason="fsspec is not installed")
    store = store_at(f"memory://{tmp_path.name}/slept")
    with RemoteLock(store, "there") as slept:
        taken = msgspec.json.encode(Owner("another:7", time.time()))
        store.write(".lock", taken)
        slept.beat()
        assert store.read(".lock") == taken
    assert store.read(".lock") == taken


def test_what_a_kind_of_url_says_is_said_in_words(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fsspec = pytest.importorskip("fsspec", reason="fsspec is not installed")
    memory = fsspec.get_filesystem_class("memory")
    store = store_at(f"memory://{tmp_path.name}/away")

    def away(*_: object, **__: object) -> None:
        raise RuntimeError("no credentials")

    def no_bucket(*_: object, **__: object) -> None:
        raise FileNotFoundError("The specified bucket does not exist")

    monkeypatch.setattr(memory, "cat_file", away)
    with pytest.raises(OSError, match=rf"no credentials: 'memory://{tmp_path.name}/away'"):
        store.read("x")
    monkeypatch.setattr(memory, "root_marker", "")
    monkeypatch.setattr(memory, "pipe_file", no_bucket)
    with pytest.raises(ValueError, match="make it first"):
        store.write("x", b"")


def test_unknown_kind_of_url() -> None:
    pytest.importorskip("fsspec", reason="fsspec is not installed")
    with pytest.raises(ValueError, match="nosuch"):
        store_at("nosuch://bucket/results")


@pytest.fixture
def job(tmp_path: Path) -> Iterator[Job]:
    clips = write_balls(tmp_path / "clips", 1)
    out = tmp_path / "out"
    batch = BatchOptions(videos=[], out=str(out))
    with FolderStore(out).begun("mark"):
        yield _job(clips, out, batch)


def _job(clips: Path, out: Path, batch: BatchOptions) -> Job:
    return Job(
        video=str(clips / "day0/ball0.mp4"),
        folder="a",
        out=str(out),
        options=track_options(batch, ""),
        settings="s",
        mark="mark",
        code=code_digest(),
        size=1,
    )


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        ({"code": "0.0.9 0123"}, "its matchset is another one"),
        ({"mark": "another"}, "share that folder"),
        ({"video": "/not/there.mp4"}, "it does not see /not/there.mp4"),
    ],
)
def test_worker_that_does_not_fit(job: Job, change: dict[str, str], problem: str) -> None:
    with pytest.raises(UnfitWorkerError, match=problem):
        do_job(msgspec.structs.replace(job, **change))


def test_what_is_wrong_with_a_video_is_its_outcome(job: Job) -> None:
    assert do_job(job).reason.startswith("say what to follow")
    gone = do_job(msgspec.structs.replace(job, video="/not/there.mp4", size=0))
    assert (gone.state, gone.reason) == ("failed", "cannot read /not/there.mp4: No such file or directory")
