"""Make weights of the network of discs from nothing: `make weights`, or `python -m training FOLDER`; see `training`."""

from pathlib import Path
from typing import Annotated

import cv2
import msgspec
import torch
import typer

from matchset.image.disc_network.network import FILE
from training.examples import ExampleParameters, make_examples
from training.pruning import prune
from training.rendering.photographs import Photographs, read_photographs
from training.shipped import SHIPPED, checksum
from training.train import Learner, LearningParameters, export, train


class RecipeParameters(msgspec.Struct, frozen=True):
    """How weights are made; as the shipped ones were begun, but counted in steps.

    Parameters
    ----------
    seed, scenes : int, int
        Of the examples that are learned from: 14,000 scenes are 84,000 examples, 2.1 GB of memory.
    steps : int
        Batches that are learned from: more learn better, and take longer; 10,000 take 26 minutes on one core.
    learning_seed : int
        Of the weights to begin with, and of the order of the examples.
    pruning_seed, pruning_scenes : int, int
        Of the examples on which an output must answer not to be left out.
    examples : ExampleParameters
    learning : LearningParameters
    """

    seed: int = 31
    scenes: int = 14000
    steps: int = 10000
    learning_seed: int = 0
    pruning_seed: int = 41
    pruning_scenes: int = 4000
    examples: ExampleParameters = ExampleParameters()
    learning: LearningParameters = LearningParameters()


def make_weights(photographs: Photographs, out: Path, recipe: RecipeParameters, begin: Path | None = None) -> None:
    """Render scenes, learn from them, leave out what is silent, and write the weights.

    Parameters
    ----------
    photographs : Photographs
        To render scenes before.
    out : Path
        File to write, .npz. The same photographs, recipe, processor and PyTorch give the same bytes.
    recipe : RecipeParameters
    begin : Path, optional
        Weights to begin with, .npz or .pt.
    """
    learner = Learner(recipe.learning, begin, recipe.learning_seed)
    examples = make_examples(recipe.seed, recipe.scenes, photographs, recipe.examples)
    typer.echo(f"{len(examples.targets)} examples before {len(photographs)} photographs")
    typer.echo(f"held back: {train(examples, recipe.steps, learner, recipe.learning)}")
    del examples  # gigabytes
    export(learner.average, out)
    asked = make_examples(recipe.pruning_seed, recipe.pruning_scenes, photographs, recipe.examples)
    typer.echo(prune(out, asked.patches, out))
    typer.echo(f"{out}: SHA-256 {checksum(out)}; shipped {SHIPPED}")


def main(
    photographs: Annotated[list[Path], typer.Argument(help="Folders of pictures; Debian's are fetched if empty.")],
    out: Annotated[Path, typer.Option(help="Weights to write, .npz.")] = Path("weights.npz"),
    begin: Annotated[Path | None, typer.Option(help="Weights to begin with, .pt or .npz.")] = None,
    scenes: Annotated[int, typer.Option(help="Scenes to learn from.", min=1)] = RecipeParameters().scenes,
    steps: Annotated[int, typer.Option(help="Batches to learn from.", min=1)] = RecipeParameters().steps,
    seed: Annotated[int, typer.Option(help="Of the scenes.")] = RecipeParameters().seed,
) -> None:
    """Make weights of the network of discs from nothing but photographs."""
    cv2.setNumThreads(1)
    torch.set_num_threads(1)
    recipe = RecipeParameters(seed=seed, scenes=scenes, steps=steps)
    try:
        if out.resolve() == FILE:
            raise ValueError(f"write the weights beside those that ship and compare them first, got {out}")
        make_weights(read_photographs(photographs), out, recipe, begin)
    except ValueError as error:
        raise typer.BadParameter(str(error)) from None


if __name__ == "__main__":
    typer.run(main)
