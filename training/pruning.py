"""Leave out of the weights of the network of discs what answers to nothing: outputs that no example makes positive.

    python -m training.examples examples.npz --photographs FOLDER --seed 41 --scenes 4000
    python -m training.pruning examples.npz --out weights.npz

An output of a layer with the rectifier that is 0 for every ray of every example adds nothing, and a network that has
learned with a decay of its weights has many of them: of 4 times 96 outputs 202. Without them a look takes less time,
and all answers stay the same, bit for bit (docs/decisions/132-weights-without-silent-outputs.md).
"""

from pathlib import Path
from typing import Annotated, Any

import numpy as np
import numpy.typing as npt
import typer

from matchset.image.disc_network.look import STEPS
from matchset.image.disc_network.network import FILE
from training.examples import read_examples
from training.silent import with_silent, without_silent


def prune(weights: Path, patches: npt.NDArray[np.floating[Any]], out: Path) -> str:
    """Read weights, leave out what no patch makes positive, and write them; says how many outputs are left."""
    with np.load(weights) as file:
        whole = with_silent({name: file[name] for name in file.files})
    pruned = without_silent(whole, patches)
    np.savez(out, **pruned)  # type: ignore[arg-type]  # NumPy's stub takes the names for options
    left = ", ".join(f"{len(pruned[f'{name}.on'])} of {len(whole[f'{name}.b'])}" for name in STEPS)
    return f"{len(patches)} patches; outputs left: {left}"


def main(
    examples: Annotated[list[Path], typer.Argument(help="Files of `python -m training.examples`.")],
    out: Annotated[Path, typer.Option(help="Weights to write, .npz.")],
    weights: Annotated[Path, typer.Option(help="Weights to prune, .npz.")] = FILE,
) -> None:
    """Leave out of the weights of the network what answers to nothing."""
    typer.echo(prune(weights, read_examples(examples).patches, out))


if __name__ == "__main__":
    typer.run(main)
