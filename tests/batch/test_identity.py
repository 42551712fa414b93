"""What a finished video is known by: sources on which results depend, and the bytes of the video."""

import ast
import os
import zlib
from collections.abc import Iterator
from pathlib import Path

import pytest

from matchset.batch.jobs import identity
from matchset.batch.jobs.identity import APART, PACKAGE, PIECE, code_digest, content_digest

TOLD = {"batch/options.py", "batch/results/store.py"}  # what is asked, which has a check sum of its own; where it goes


def test_the_check_sum_is_of_the_whole_video(tmp_path: Path) -> None:
    data = os.urandom(PIECE) + b"end"
    (tmp_path / "a.mp4").write_bytes(data)
    assert content_digest(str(tmp_path / "a.mp4")) == f"{zlib.crc32(data):08x}"


def imported(path: Path) -> Iterator[Path]:
    """Files of the package that a file imports, also within functions."""
    names = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module:
            names += [node.module, *(f"{node.module}.{each.name}" for each in node.names)]
        elif isinstance(node, ast.Import):
            names += [each.name for each in node.names]
    for name in names:
        found = PACKAGE.joinpath(*name.split(".")[1:]).with_suffix(".py")
        if name.startswith("matchset.") and found.is_file():
            yield found


def test_no_result_depends_on_what_is_left_out() -> None:
    reached, waiting = set[Path](), [PACKAGE / "batch" / "jobs" / "work.py"]
    while waiting:
        path = waiting.pop()
        if path not in reached:
            reached.add(path)
            waiting += imported(path)
    names = {path.relative_to(PACKAGE).as_posix() for path in reached}
    assert {"tracking/tracker.py", "batch/split/joining.py", "app/track/command.py"} <= names
    assert {name for name in names if APART.match(name)} == TOLD


@pytest.mark.parametrize(
    ("name", "decides"),
    [
        ("tracking/a.py", True),
        ("batch/jobs/a.py", True),
        ("batch/plan.py", False),
        ("live/a.py", False),
        ("cli.py", False),
    ],
)
def test_what_decides_about_results(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, decides: bool) -> None:
    monkeypatch.setattr(identity, "PACKAGE", tmp_path)
    digest, path = code_digest.__wrapped__, tmp_path / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("one")
    every, deciding = digest(), digest(every=False)
    path.write_text("two")
    assert digest() != every
    assert (digest(every=False) != deciding) is decides


def test_the_release_of_opencv_decides_whichever_package_it_is_of(monkeypatch: pytest.MonkeyPatch) -> None:
    before = code_digest.__wrapped__(every=False)
    monkeypatch.setattr("cv2.__version__", "0.0.1")
    assert code_digest.__wrapped__(every=False) != before
