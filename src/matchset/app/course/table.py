"""A run as a table for programs and notebooks: `table`."""

from collections.abc import Iterable, Sequence
from importlib import import_module
from importlib.util import find_spec
from typing import Any

import numpy as np

from matchset.app.locate.rows import pose_columns, pose_row
from matchset.app.several.target_rows import target_columns, target_row
from matchset.app.tables import Cell, Column
from matchset.app.track.rows import track_columns, track_row
from matchset.localization.pose import Pose
from matchset.numeric.arguments import check_kind
from matchset.shapes.circle import Circle
from matchset.tracking.many.target import Target
from matchset.tracking.track import Lost, Track

Answer = Track[Any] | Pose | Lost[Any]

KINDS = ("pandas", "polars", "arrays")
"""What a table may be, in the order in which it is chosen."""


def table(tracks: Answer | Iterable[Answer | Sequence[Target[Any]]], kind: str | None = None) -> Any:
    """Make a table of what was found, one row for each frame, with the columns of `tracks.csv`.

    Parameters
    ----------
    tracks : iterable of Track or Lost, or of Pose or Lost
        What `Tracker.update` returned, frame by frame: frame, time, found, the parameters of the shape (px, rad), their
        standard deviations, support, reason. Or what `Localizer.update` returned: the columns of `poses.csv`, m and
        rad. Or lists of targets, what `MultiTracker.update` returned for each frame: one row for each target, with the
        columns `identity`, `label` and `alternatives` behind the others. `frame` counts from 0.
    kind : str, optional
        "pandas": a `pandas.DataFrame`; "polars": a `polars.DataFrame`; "arrays": a dict of NumPy arrays. By default the
        first of them that is installed.

    Returns
    -------
    DataFrame or dict
        Rounded as in the file. What is not known is missing, and never NaN: `pandas.NA` in columns of type Float64,
        null in polars; the arrays of floats are masked arrays. Where nothing was found at all the parameters are those
        of a circle.

    Raises
    ------
    ValueError
        If the kind is unknown or not installed, or shapes of several families are among the tracks.
    TypeError
        If there is something else among them, or tracks and poses together.

    Examples
    --------
    >>> import numpy as np, matchset as ms
    >>> found = ms.Track(ms.Circle(70.0, 50.0, 25.0), 0.04 * np.eye(3), 1.0, np.empty((0, 2)), 0.0)
    >>> columns = ms.table([found, ms.Lost("behind a tree", 1 / 30)], kind="arrays")
    >>> columns["x"].tolist(), columns["found"].tolist(), columns["reason"].tolist()
    ([70.0, None], [True, False], ['', 'behind a tree'])
    """
    chosen = _kind(kind)
    given = [tracks] if isinstance(tracks, Track | Pose | Lost) else list(tracks)
    columns, rows = _rows(given)
    cells = {column.name: [column.value(row) for row in rows] for column in columns}
    cells["found"] = [bool(each) for each in cells["found"]]
    return _MAKERS[chosen](cells)


def _kind(kind: str | None) -> str:
    """Return which kind of table to make, checked."""
    if kind is None:
        return next(each for each in KINDS if each == KINDS[-1] or find_spec(each) is not None)
    if kind not in KINDS:
        raise ValueError(f"kind must be one of {', '.join(map(repr, KINDS))}, got {kind!r:.60}")
    if kind != KINDS[-1] and find_spec(kind) is None:
        raise ValueError(f"kind={kind!r} needs the package {kind}: pip install {kind}")
    return kind


def _rows(given: Sequence[Any]) -> tuple[list[Column], list[Any]]:
    """Return the columns and the rows of what was given."""
    if any(isinstance(each, list | tuple) for each in given):
        return _target_rows(given)
    return _pose_rows(given) if any(isinstance(each, Pose) for each in given) else _track_rows(given)


def _track_rows(given: Sequence[Any]) -> tuple[list[Column], list[Any]]:
    for each in given:
        check_kind("a row of the table", each, (Track, Lost), "Tracker.update(frame) gives one")
    return track_columns(_parameters(given)), [track_row(number, each) for number, each in enumerate(given)]


def _target_rows(given: Sequence[Any]) -> tuple[list[Column], list[Any]]:
    for frame in given:
        check_kind("a frame of the table", frame, (list, tuple), "MultiTracker.update(frame) gives a list")
        for each in frame:
            check_kind("a row of the table", each, Target, "MultiTracker.update(frame) gives a list of them")
    columns = target_columns(_parameters([each.track for frame in given for each in frame]))
    return columns, [target_row(number, each) for number, frame in enumerate(given) for each in frame]


def _parameters(given: Sequence[Any]) -> Sequence[str]:
    """Return the parameters of the only family of shapes among answers."""
    families = {type(each.shape): each.shape.parameters for each in given if isinstance(each, Track)}
    if len(set(families.values())) > 1:
        names = ", ".join(sorted(family.__name__ for family in families))
        raise ValueError(f"a table has the parameters of one family of shapes, got {names}")
    parameters: Sequence[str] = next(iter(families.values()), Circle.parameters)
    return parameters


def _pose_rows(given: Sequence[Any]) -> tuple[list[Column], list[Any]]:
    for each in given:
        check_kind("a row of the table of poses", each, (Pose, Lost), "Localizer.update(track) gives one")
    return pose_columns(), [pose_row(number, each) for number, each in enumerate(given)]


_ARRAYS: dict[str, Any] = {"frame": np.int64, "identity": np.int64, "found": np.bool_}


def _is_text(name: str) -> bool:
    return name in ("reason", "observed", "label", "alternatives")


def _arrays(cells: dict[str, list[Cell]]) -> dict[str, Any]:
    """Arrays: what is missing is masked, and NaN below the mask."""
    made: dict[str, Any] = {}
    for name, column in cells.items():
        if name in _ARRAYS or _is_text(name):
            made[name] = np.array(column, _ARRAYS.get(name, np.str_))
        else:
            missing = [each is None for each in column]
            made[name] = np.ma.array(np.array(column, np.float64), mask=missing)
    return made


def _pandas(cells: dict[str, list[Cell]]) -> Any:
    pandas: Any = import_module("pandas")
    kinds = {"frame": "int64", "identity": "int64", "found": "bool"}
    return pandas.DataFrame(
        {
            name: pandas.Series(column, dtype=kinds.get(name, "string" if _is_text(name) else "Float64"))
            for name, column in cells.items()
        }
    )


def _polars(cells: dict[str, list[Cell]]) -> Any:
    polars: Any = import_module("polars")
    kinds = {"frame": polars.Int64, "identity": polars.Int64, "found": polars.Boolean}
    return polars.DataFrame(
        cells, schema={name: kinds.get(name, polars.String if _is_text(name) else polars.Float64) for name in cells}
    )


_MAKERS = {"pandas": _pandas, "polars": _polars, "arrays": _arrays}
