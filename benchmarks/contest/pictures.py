"""The pictures of the contest: lines of time, and accuracy against speed."""

import itertools
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.ticker import NullFormatter

from benchmarks.tracking.pictures import INK, PALE, PINK, _calm, _figure, _note, _save

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
    order = sorted(points.items(), key=lambda item: item[1])
    for number, (name, (time, error)) in enumerate(order, start=1):
        color = PINK if name == OURS else INK
        axes.plot(time, error, "o", color=color, markersize=9 if name == OURS else 5, label=f"{number}  {name}")
        # Neighbors in time are often neighbors in error: their numbers go up and down by turns.
        _note(axes, str(number), (time, error), (-4, 8 if number % 2 else -16), color)
    axes.legend(
        handlelength=0,
        markerscale=0,
        frameon=False,
        fontsize=9,
        labelcolor=INK,
        loc="center left",
        bbox_to_anchor=(1, 0.5),
    )
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.xaxis.set_major_formatter("{x:g}")
    axes.yaxis.set_major_formatter("{x:g}")
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.grid(color=PALE, linewidth=0.5, alpha=0.5)
    axes.set_xlabel("median time per frame, µs")
    axes.set_ylabel("mean of min(error, 5 px), px; not answered: 5")
    _calm(axes)
    axes.margins(x=0.08)
    _save(figure, path)


def _apart(places: Sequence[float], least: float) -> list[float]:
    """Move numbers apart so that none is nearer to another than some distance; their order stays."""
    order = np.argsort(places)
    moved = np.array(places, float)
    for before, after in itertools.pairwise(order):
        moved[after] = max(moved[after], moved[before] + least)
    return [float(value) for value in moved]
