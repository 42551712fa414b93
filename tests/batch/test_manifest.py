"""The manifest on a disk that is full."""

import errno
import os
from pathlib import Path

import pytest

from matchset.batch.jobs.job import VideoOutcome
from matchset.batch.results.manifest import Manifest
from matchset.batch.results.store import FolderStore, store_at


def outcome(name: str) -> VideoOutcome:
    return VideoOutcome(video=f"/v/{name}", folder=name, settings="s", state="found", size=1, modified=1)


@pytest.mark.parametrize("fails", [True, False])
def test_a_line_is_written_whole_or_not_at_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fails: bool) -> None:
    write = os.write

    def half(file: int, line: bytes) -> int:
        count = write(file, line[: len(line) // 2])
        if fails:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return count

    with Manifest(FolderStore(tmp_path), Path("/v")) as manifest:
        manifest.append(outcome("a"))
        before = (tmp_path / "manifest.jsonl").read_bytes()
        with monkeypatch.context() as patched:
            patched.setattr(os, "write", half)
            with pytest.raises(OSError, match="No space left"):
                manifest.append(outcome("b"))
        assert (tmp_path / "manifest.jsonl").read_bytes() == before
        manifest.append(outcome("c"))
    with Manifest(FolderStore(tmp_path), Path("/v")) as manifest:
        assert manifest.is_done(outcome("a"), failed_too=False)
        assert manifest.is_done(outcome("c"), failed_too=False)
        assert not manifest.is_done(outcome("b"), failed_too=False)


def test_a_batch_that_slept_takes_no_part_of_the_next_one(tmp_path: Path) -> None:
    pytest.importorskip("fsspec", reason="fsspec is not installed")
    store = store_at(f"memory://{tmp_path.name}/slept")
    with Manifest(store, Path("/v")) as slept:
        slept.append(outcome("a"))
        with Manifest(store, Path("/v")) as newer:
            newer.append(outcome("b"))
    with Manifest(store, Path("/v")) as manifest:
        assert manifest.is_done(outcome("a"), failed_too=False)
        assert manifest.is_done(outcome("b"), failed_too=False)
