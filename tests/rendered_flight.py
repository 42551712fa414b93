"""The files of `examples/render_flight.py`, rendered once for all tests of a process."""

import contextlib
import functools
import runpy
import tempfile
from pathlib import Path

PROGRAM = Path(__file__).resolve().parents[1] / "examples" / "render_flight.py"


@functools.cache
def _files() -> dict[str, bytes]:
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        runpy.run_path(str(PROGRAM))
        return {path.name: path.read_bytes() for path in Path().iterdir()}


def write_flight(folder: Path) -> None:
    """Write them into a folder."""
    for name, data in _files().items():
        (folder / name).write_bytes(data)
