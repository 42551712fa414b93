"""`ms.table`: the columns of tracks.csv and poses.csv, as a frame of pandas or polars, or as arrays."""

import csv
import sys
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import matchset as ms
from matchset.app.track.rows import track_row, track_table

CIRCLES = [(70.0, 50.0, 25.0), (71.23456789, 50.5, 25.1)]
TRACKS: list[Any] = [
    ms.Track(ms.Circle(*CIRCLES[0]), 0.04 * np.eye(3), 0.9, np.empty((0, 2)), 0.0),
    ms.Lost("behind a tree", 1.0 / 30.0),
    ms.Track(ms.Circle(*CIRCLES[1]), np.diag([0.04, np.inf, 0.01]), 1.0, np.empty((0, 2)), 2.0 / 30.0),
]
POSE = ms.Pose(
    position=np.array((0.1, 0.2, 3.0)), rotation_matrix=None, covariance=1e-4 * np.eye(6), observed="position", time=0.0
)


def test_the_columns_are_those_of_the_file(tmp_path: Path) -> None:
    found = ms.table(TRACKS, kind="arrays")
    with track_table(tmp_path / "tracks.csv", ms.Circle.parameters) as writer:
        for number, track in enumerate(TRACKS):
            writer.write(track_row(number, track))
    with (tmp_path / "tracks.csv").open() as file:
        lines = list(csv.DictReader(file))
    assert list(found) == list(lines[0])
    for name, column in found.items():
        written = [line[name] for line in lines]
        if name in ("reason",):
            assert column.tolist() == written
        else:
            assert column.tolist() == [None if cell == "" else float(cell) for cell in written]


def test_what_is_missing_is_masked_and_never_counts() -> None:
    found = ms.table(TRACKS, kind="arrays")
    assert found["frame"].dtype == np.int64
    assert found["found"].dtype == np.bool_
    assert found["x"].mean() == pytest.approx(np.mean([70.0, 71.2346]))
    assert np.ma.getmaskarray(found["x"]).tolist() == [False, True, False]
    assert np.ma.getmaskarray(found["y_std"]).tolist() == [False, True, True]  # no finite one
    assert np.isnan(np.asarray(found["x"].data)[1])  # whoever takes the mask off sees no number


def test_nothing_found_has_the_columns_of_a_circle() -> None:
    found = ms.table([ms.Lost("gone", 0.0)], kind="arrays")
    assert list(found)[:6] == ["frame", "time", "found", "x", "y", "radius"]
    assert np.ma.getmaskarray(found["x"]).all()
    assert {name: len(column) for name, column in ms.table([], kind="arrays").items()} == dict.fromkeys(found, 0)


def test_other_shapes_and_single_answers_have_their_columns() -> None:
    ellipse = ms.Track(ms.Ellipse(1.0, 2.0, 30.0, 20.0, 0.5), 0.01 * np.eye(5), 1.0, np.empty((0, 2)), 0.0)
    found = ms.table(ellipse, kind="arrays")
    assert list(found)[3:8] == ["x", "y", "a", "b", "angle"]
    assert found["angle"].tolist() == [0.5]


def test_poses_have_the_columns_of_poses_csv() -> None:
    found = ms.table([POSE, ms.Lost("gone", 0.1)], kind="arrays")
    assert list(found)[:6] == ["frame", "time", "found", "x", "y", "z"]
    assert found["z"].tolist() == [3.0, None]
    assert found["observed"].tolist() == ["position", ""]
    assert found["reason"].tolist() == ["", "gone"]


@pytest.mark.parametrize("kind", ["pandas", "polars"])
def test_frames_of_other_packages(kind: str) -> None:
    pytest.importorskip(kind)
    found = ms.table(TRACKS, kind=kind)
    assert type(found).__name__ == "DataFrame"
    assert type(found).__module__.startswith(kind)
    assert list(found.columns) == list(ms.table(TRACKS, kind="arrays"))
    assert found["x"].mean() == pytest.approx(np.mean([70.0, 71.2346]))
    missing = found["x"].isna() if kind == "pandas" else found["x"].is_null()
    assert missing.to_list() == [False, True, False]
    assert found["found"].to_list() == [True, False, True]
    assert len(ms.table([], kind=kind)) == 0


def fake(name: str) -> Any:
    """A package with a frame that remembers what it was given."""
    module: Any = ModuleType(name)
    module.__spec__ = find_spec("csv")
    module.DataFrame = lambda cells, **_: (name, list(cells))
    module.Series = lambda column, dtype: column  # noqa: ARG005
    module.Int64 = module.Float64 = module.Boolean = module.String = None
    return module


def test_the_first_package_that_is_installed_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    installed: set[str] = set()
    monkeypatch.setattr("matchset.app.course.table.find_spec", lambda name: name if name in installed else None)
    for name in ("pandas", "polars"):
        monkeypatch.setitem(sys.modules, name, fake(name))
    assert isinstance(ms.table(TRACKS), dict)
    installed.add("polars")
    assert ms.table(TRACKS)[0] == "polars"
    installed.add("pandas")
    assert ms.table(TRACKS) == ("pandas", list(ms.table(TRACKS, kind="arrays")))
    assert ms.table(TRACKS, kind="polars")[0] == "polars"


def test_a_package_that_is_missing_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("matchset.app.course.table.find_spec", lambda _: None)
    with pytest.raises(ValueError, match="kind='polars' needs the package polars: pip install polars"):
        ms.table(TRACKS, kind="polars")


make: Any = ms
MISUSE: dict[str, tuple[Callable[[], object], type[Exception], str]] = {
    "kind": (lambda: ms.table(TRACKS, kind="excel"), ValueError, "'pandas', 'polars', 'arrays', got 'excel'"),
    "no track": (lambda: make.table([3], kind="arrays"), TypeError, "must be a Track or Lost, got int 3"),
    "both": (lambda: ms.table([POSE, TRACKS[0]], kind="arrays"), TypeError, "must be a Pose or Lost, got Track"),
    "families": (
        lambda: ms.table(
            [TRACKS[0], ms.Track(ms.Ellipse(1.0, 2.0, 3.0, 2.0, 0.0), np.eye(5), 1.0, np.empty((0, 2)), 0.0)],
            kind="arrays",
        ),
        ValueError,
        "one family of shapes, got Circle, Ellipse",
    ),
}


@pytest.mark.parametrize("name", MISUSE)
def test_misuse_is_refused_in_words(name: str) -> None:
    call, error, words = MISUSE[name]
    with pytest.raises(error, match=words):
        call()


def test_targets_have_rows_with_their_identities() -> None:
    found = ms.Track(ms.Circle(70.0, 50.0, 25.0), 0.04 * np.eye(3), 1.0, np.empty((0, 2)), 0.0)
    one: ms.Target[Any] = ms.Target(0, "red", found, 0.0)
    other: ms.Target[Any] = ms.Target(3, "blue", ms.Lost("hidden", 0.0), 0.0, (0,))
    made = ms.table([[one, other], [], [other]], kind="arrays")
    assert made["frame"].tolist() == [0, 0, 2]
    assert made["identity"].tolist() == [0, 3, 3]
    assert made["label"].tolist() == ["red", "blue", "blue"]
    assert made["alternatives"].tolist() == ["", "0", "0"]
    assert made["x"].tolist() == [70.0, None, None]
    with pytest.raises(TypeError, match="a frame of the table"):
        ms.table([[one], found])
    with pytest.raises(TypeError, match="a row of the table"):
        ms.table([[found]])  # type: ignore[list-item]
