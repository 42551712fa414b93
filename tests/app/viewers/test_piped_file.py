"""A file that a library writes by its name: whole, or as much as fits, and never a hanging library."""

import resource
from pathlib import Path

import pytest

from matchset.app.viewers import piped_file
from matchset.app.viewers.piped_file import PipedFile


def written(path: Path, data: bytes) -> PipedFile:
    """What a library does with it."""
    file = PipedFile(path)
    with file.name.open("wb") as out:
        file.opened()
        out.write(data)
    return file


@pytest.mark.parametrize("names", [True, False])
def test_what_exists_stays_until_the_new_file_is_whole(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, names: bool
) -> None:
    if not names:  # as on Windows
        monkeypatch.setattr(piped_file, "OPEN_FILES", tmp_path / "nothing")
    path = tmp_path / "a.rrd"
    path.write_bytes(b"mine")
    file = written(path, bytes(range(256)) * 1000)
    assert path.read_bytes() == b"mine"
    file.close()
    assert path.read_bytes() == bytes(range(256)) * 1000
    assert list(tmp_path.iterdir()) == [path]


def test_what_does_not_fit_is_told_at_the_end(tmp_path: Path) -> None:
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, before[1]))
    try:
        file = written(tmp_path / "a.rrd", bytes(1_000_000))
        with pytest.raises(OSError, match="too large") as raised:
            file.close()
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert raised.value.filename == str(tmp_path / "a.rrd")
    assert 0 < (tmp_path / "a.rrd").stat().st_size <= 100_000


def test_where_nothing_fits_what_exists_stays(tmp_path: Path) -> None:
    path, before = tmp_path / "a.rrd", resource.getrlimit(resource.RLIMIT_FSIZE)
    path.write_bytes(b"mine")
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, before[1]))
    try:
        file = written(path, b"new")
        with pytest.raises(OSError, match="too large"):
            file.close()
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert path.read_bytes() == b"mine"
    assert list(tmp_path.iterdir()) == [path]


def test_a_file_that_cannot_be_opened_is_named(tmp_path: Path) -> None:
    with pytest.raises(OSError, match="No such file or directory"):
        PipedFile(tmp_path / "none" / "a.rrd")
