"""Draw how fast simulated batches are, for benchmarks/BATCH.md: `python -m docs.pictures.batch`, from the root.

Drawn from benchmarks/batch/simulation/measured.json by the model of benchmarks/batch/simulation.
"""

from pathlib import Path

from benchmarks.batch.simulation.basis import Basis
from benchmarks.batch.simulation.many import LENGTHS, MACHINES, STORES, WORKERS, growth
from matplotlib.figure import Figure

from matchset.app.drawing.plot_style import (
    DASHES,
    OURS,
    QUIET,
    SERIES,
    LineLabel,
    figure_of,
    label_lines,
    log_ticks,
    style_axes,
    title,
    write_svg,
)

SIZE = 760, 420  # px
SHOWN = "10 s", "1 h"  # videos of


def main() -> None:
    """Write docs/pictures/batch.svg."""
    path = Path(__file__).with_suffix(".svg")
    write_svg(drawn(Basis.load()), path)
    print(f"{path}: {path.stat().st_size // 1000} kB")


def drawn(basis: Basis) -> Figure:
    """Draw the rate of all machines against their number, for each store; videos of 10 s dashed."""
    figure, (axes,) = figure_of(SIZE)
    ideal = [basis.bytes_a_second / basis.seconds_a_second * WORKERS * machines / 1e9 for machines in MACHINES]
    axes.plot(MACHINES, ideal, color=QUIET, linewidth=1.0)
    labels = [LineLabel("processors alone", ideal[-1], QUIET)]
    for (store, bandwidth), color in zip(STORES.items(), (OURS, *SERIES), strict=False):
        for name in SHOWN:
            rates = [point.rate / 1e9 for point in growth(basis, LENGTHS[name], bandwidth)]
            dashes = DASHES if name == SHOWN[0] else "-"
            axes.plot(MACHINES, rates, color=color, linestyle=dashes, linewidth=1.8)
            labels.append(LineLabel(f"{store}, {name}", rates[-1], color))
    style_axes(axes, "both")
    log_ticks(axes.xaxis, MACHINES[0], MACHINES[-1])
    log_ticks(axes.yaxis, 0.1, 1000.0)
    axes.set_xlabel(f"machines of {WORKERS} workers")
    title(axes, "GB of video a second (simulated): one store for all, videos of 10 s (dashed) and of an hour")
    label_lines(axes, labels)
    return figure


if __name__ == "__main__":
    main()
