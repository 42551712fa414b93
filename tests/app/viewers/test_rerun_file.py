"""A file for Rerun that cannot be begun leaves nothing open and nothing behind; without Rerun's package."""

import sys
import threading
from pathlib import Path
from types import SimpleNamespace
from typing import IO

import pytest

from matchset.app.viewers import piped_file
from matchset.app.viewers.rerun_file import RerunFile


class Stream:
    """Rerun's stream, of which one method fails."""

    def __init__(self, failing: str) -> None:
        self._failing = failing
        self._out: IO[bytes] | None = None

    def _check(self, name: str) -> None:
        if name == self._failing:
            raise RuntimeError(f"no {name}")

    def set_log_time_enabled(self, _: bool) -> None:
        self._check("set_log_time_enabled")

    def set_log_tick_enabled(self, _: bool) -> None:
        """Needs nothing."""

    def save(self, path: Path) -> None:
        self._check("save")
        self._out = path.open("wb")

    def log(self, *_: object, **__: object) -> None:
        assert self._out is not None
        self._out.write(b"begun")
        self._check("log")

    def disconnect(self) -> None:
        if self._out is not None:
            self._out.close()


def open_files() -> int:
    return len(list(Path("/dev/fd").iterdir()))


@pytest.mark.parametrize("failing", ["set_log_time_enabled", "save", "log"])
@pytest.mark.parametrize("there", [True, False])
@pytest.mark.parametrize("names", [True, False])
def test_what_cannot_be_begun_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, failing: str, there: bool, names: bool
) -> None:
    if not names:  # as on Windows
        monkeypatch.setattr(piped_file, "OPEN_FILES", tmp_path / "nothing")
    package = SimpleNamespace(
        RecordingStream=lambda _: Stream(failing), AnnotationContext=list, ViewCoordinates=SimpleNamespace(RDF=0)
    )
    monkeypatch.setitem(sys.modules, "rerun", package)
    path = tmp_path / "a.rrd"
    if there:
        path.write_bytes(b"mine")
    before = open_files()
    with pytest.raises(RuntimeError, match=f"no {failing}"):
        RerunFile(path)
    assert [each.read_bytes() for each in tmp_path.iterdir()] == ([b"mine"] if there else [])
    assert open_files() == before
    assert not [each for each in threading.enumerate() if each.name == "matchset pipe"]
