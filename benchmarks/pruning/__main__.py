"""`python -m benchmarks.pruning EXAMPLES... --out weights.npz`; see `benchmarks.pruning`."""

from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from benchmarks.pruning.silent import with_silent, without_silent
from benchmarks.training.examples import read_examples
from matchset.image.disc_network.look import STEPS
from matchset.image.disc_network.network import FILE


def main(
    examples: Annotated[list[Path], typer.Argument(help="Files of `python -m benchmarks.training.examples`.")],
    out: Annotated[Path, typer.Option(help="Weights to write, .npz.")],
    weights: Annotated[Path, typer.Option(help="Weights to prune, .npz.")] = FILE,
) -> None:
    """Leave out of the weights of the network what answers to nothing."""
    with np.load(weights) as file:
        whole = with_silent({name: file[name] for name in file.files})
    patches = read_examples(examples).patches
    pruned = without_silent(whole, patches)
    np.savez(out, **pruned)  # type: ignore[arg-type]  # NumPy's stub takes the names for options
    left = ", ".join(f"{len(pruned[f'{name}.on'])} of {len(whole[f'{name}.b'])}" for name in STEPS)
    typer.echo(f"{len(patches)} patches; outputs left: {left}")


if __name__ == "__main__":
    typer.run(main)
