"""The pictures of the contest: lines of time, and accuracy against speed."""

import itertools
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.ticker import NullFormatter

from benchmarks.pictures import INK, PALE, PINK, _calm, _figure, _note, _save

PALETTE = ("#0b7a75", "#2f6fde", "#e08a00", "#8a5cc2", "#7a7a7a", "#b03a2e", "#4f9d2f", "#c2a000")
OURS = "matchset"


def times_over(xs: Sequence[float], times: Mapping[str, Sequence[float]], label: str, path: Path) -> None:
    """Draw what a frame costs, a line for each contender, on a logarithmic scale.

    Parameters
    ----------
    xs : sequence of float
    times : mapping of str to sequence of float
        By contender, us.
    label : str
        Of the x axis.
    path : Path
        A .png file.
    """
    figure, (axes,) = _figure(1, (9.0, 4.6))
    ends = _apart([np.log10(values[-1]) for values in times.values()], 0.17)
    colors = iter(PALETTE)
    for (name, values), end in zip(times.items(), ends, strict=True):
        color = PINK if name == OURS else next(colors)
        axes.plot(xs, values, "o-", color=color, linewidth=2.2 if name == OURS else 1.2, markersize=3.5)
        axes.annotate(
            name,
            (xs[-1], 10.0**end),
            xytext=(8, -3),
            textcoords="offset points",
            color=color,
            fontsize=9,
            annotation_clip=False,
        )
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter("{x:g}")
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.set_xlabel(label)
    axes.set_ylabel("median time per frame, µs")
    _save(figure, path)


def accuracy_over_speed(points: Mapping[str, tuple[float, float]], path: Path) -> None:
    """Draw the error against the time of everybody, both on logarithmic scales.

    Parameters
    ----------
    points : mapping of str to (us, px)
    path : Path
        A .png file.
    """
    figure, (axes,) = _figure(1, (9.0, 5.2))
    taken: list[tuple[float, float]] = []
    for name, (time, error) in sorted(points.items(), key=lambda item: -item[1][1]):
        color = PINK if name == OURS else INK
        axes.plot(time, error, "o", color=color, markersize=9 if name == OURS else 5)
        place = np.log10(time), np.log10(error)
        near = sum(abs(place[0] - x) < 0.7 and abs(place[1] - y) < 0.06 for x, y in taken)
        taken.append(place)
        _note(axes, name, (time, error), (8, -3 - 10 * near), color)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.xaxis.set_major_formatter("{x:g}")
    axes.yaxis.set_major_formatter("{x:g}")
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.grid(color=PALE, linewidth=0.5, alpha=0.5)
    low, high = axes.get_xlim()
    axes.set_xlim(low, high * 12.0)
    axes.set_xlabel("median time per frame, µs")
    axes.set_ylabel("mean of min(error, 5 px), px; not answered: 5")
    _calm(axes)
    _save(figure, path)


def _apart(places: Sequence[float], least: float) -> list[float]:
    """Move numbers apart so that none is nearer to another than some distance; their order stays."""
    order = np.argsort(places)
    moved = np.array(places, float)
    for before, after in itertools.pairwise(order):
        moved[after] = max(moved[after], moved[before] + least)
    return [float(value) for value in moved]
