"""Results in S3, by a server on this computer (packages moto[server] and s3fs): the same as in a folder."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from batched_videos import HerePool, write_balls, write_color
from blue_ball import Matchset
from matchset.batch import run
from matchset.batch.results.lock import RemoteLock
from matchset.batch.results.store import FolderStore, store_at


@pytest.fixture
def bucket(monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    s3fs = pytest.importorskip("s3fs", reason="s3fs is not installed")
    server = pytest.importorskip("moto.server", reason="moto[server] is not installed")
    running = server.ThreadedMotoServer("127.0.0.1", 0, verbose=False)
    running.start()
    try:
        host, port = running.get_host_and_port()
        monkeypatch.setenv("AWS_ENDPOINT_URL", f"http://{host}:{port}")
        for name in ("AWS_ACCESS_KEY_ID", "AWS_SECRET_ACCESS_KEY"):
            monkeypatch.setenv(name, "testing")
        monkeypatch.setattr(run, "Processes", HerePool)
        s3fs.S3FileSystem.clear_instance_cache()
        s3fs.S3FileSystem().makedirs("lab", exist_ok=True)
        yield "s3://lab"
    finally:
        running.stop()


def test_results_are_those_in_a_folder(
    matchset: Matchset, bucket: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    clips, color = write_balls(tmp_path / "clips", 3), write_color(tmp_path / "ball.npz")
    for _ in range(2):
        assert matchset("batch", clips, "--out", f"{bucket}/results", "--color", color) == 0
    assert matchset("batch", clips, "--out", "here", "--color", color) == 0
    remote, here = store_at(f"{bucket}/results"), FolderStore(Path("here"))
    for name in ("all.csv", "day0/ball0.mp4/tracks.csv", "day1/ball1.mp4/tracks.csv"):
        assert remote.read(name) == here.read(name) is not None
    lines = b"".join(remote.read(f"manifest/{name}") or b"" for name in remote.names("manifest"))
    assert len(lines.splitlines()) == 1 + 3
    assert remote.names("day0/ball0.mp4") == here.names("day0/ball0.mp4")
    with RemoteLock(remote, "there"):
        assert matchset("batch", clips, "--out", f"{bucket}/results", "--color", color) == 2
    assert "another batch writes into s3://lab/results" in capsys.readouterr().err


def test_no_bucket_is_made_of_a_misspelled_name(
    matchset: Matchset, bucket: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    clips, color = write_balls(tmp_path / "clips", 1), write_color(tmp_path / "ball.npz")
    assert matchset("batch", clips, "--out", "s3://lob/results", "--color", color) == 2
    assert "there is no 'lob'" in capsys.readouterr().err
