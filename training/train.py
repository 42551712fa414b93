"""Learn the weights of the network from examples, with PyTorch.

    python -m training.train EXAMPLES... --out weights.npz --steps 10000 [--begin earlier.pt]

The network says of a circle where the ball is from it and how sure that is, as a precision, and whether there is one.
Of a ball the likelihood of Student's t with that precision counts, which a few circles that were led astray do not
spoil; of all examples the cross-entropy of there being a ball. What is written is a moving average of the weights.
Beside `weights.npz`, in half precision, there will be `weights.pt`, to go on from.
"""

import copy
import itertools
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt
import torch
import typer
from torch.nn import functional

from matchset.image.disc_network.look import LOG_PRECISIONS, MOVES, PRECISION, STEPS
from matchset.image.disc_network.patch_format import NUMBERS, PLACES
from training.augmentation import AugmentationParameters, varied
from training.examples import Examples, read_examples
from training.silent import with_silent

KERNEL = 5  # rays that a convolution sees at once
COORDINATES = 3  # of a circle


class NetworkParameters(msgspec.Struct, frozen=True):
    """Size of the network.

    Parameters
    ----------
    width : int
        Numbers that are known of a ray after each layer.
    """

    width: int = 96


class LearningParameters(msgspec.Struct, frozen=True):
    """How the weights are learned; chosen by hand.

    Parameters
    ----------
    network : NetworkParameters
    held, held_share : int, float
        The first examples are held back: so many, but no larger share of all than this.
    batch : int
        Examples of a step.
    rate : float
        Step size of AdamW at its largest.
    first_steps : int
        Steps in which that is reached.
    first_rate, last_rate : float
        It begins and ends at these shares of it.
    decay : float
        Decay of the weights.
    most_slope : float
        Norm to which the gradient is clipped.
    freedom : float
        Degrees of freedom of Student's t.
    there : float
        Weight of the cross-entropy.
    average, first_average : float
        Share of the weights of a step in their moving average; the second in the first steps.
    average_after : int
        How many those are.
    augmentation : AugmentationParameters
    """

    network: NetworkParameters = NetworkParameters()
    held: int = 3000
    held_share: float = 0.1
    batch: int = 256
    rate: float = 1.5e-3
    first_steps: int = 150
    first_rate: float = 0.02
    last_rate: float = 0.01
    decay: float = 5e-3
    most_slope: float = 1.0
    freedom: float = 3.0
    there: float = 2.0
    average: float = 0.003
    first_average: float = 0.05
    average_after: int = 500
    augmentation: AugmentationParameters = AugmentationParameters()


class Output(NamedTuple):
    """What the network says of patches: see `matchset.image.disc_network.network.NetworkEvidence`."""

    step: torch.Tensor
    precision: torch.Tensor
    log_odds: torch.Tensor


class Network(torch.nn.Module):  # type: ignore[misc]  # PyTorch is not where types are checked
    """The network of the package, in PyTorch.

    Parameters
    ----------
    limits : NetworkParameters, optional
    """

    def __init__(self, limits: NetworkParameters | None = None) -> None:
        super().__init__()
        width = (limits or NetworkParameters()).width
        self.first = torch.nn.Conv1d(PLACES * NUMBERS, width, 1)
        for name, step in STEPS.items():
            reach = step * (KERNEL // 2)
            around = torch.nn.Conv1d(width, width, KERNEL, dilation=step, padding=reach, padding_mode="circular")
            self.add_module(name, around)
        self.out = torch.nn.Conv1d(width, 2, 1)
        self.cls = torch.nn.Linear(2 * width, 1)
        self.register_buffer("moves", torch.tensor(MOVES, dtype=torch.float32), persistent=False)

    def forward(self, patches: torch.Tensor) -> Output:
        """Say what patches of shape (n, 64, 32, 6) show."""
        rays = functional.relu(self.first(patches.flatten(2).transpose(1, 2)))
        for name in STEPS:
            rays = rays + functional.relu(getattr(self, name)(rays))
        there = self.cls(torch.cat((rays.mean(2), rays.amax(2)), 1))[:, 0]
        lengths, log_weights = self.out(rays).unbind(1)
        weights = torch.exp(log_weights.clamp(*LOG_PRECISIONS))
        precision = torch.einsum("nr,ri,rj->nij", weights, self.moves, self.moves)
        precision = precision + PRECISION * torch.eye(COORDINATES)
        right_side = torch.einsum("nr,nr,ri->ni", weights, lengths, self.moves)
        return Output(torch.linalg.solve(precision, right_side), precision, there)


def layers_of(network: Network) -> Iterator[tuple[str, Any]]:
    """Name and module of each layer."""
    for name in ("first", *STEPS, "out", "cls"):
        yield name, getattr(network, name)


def weights_of(network: Network) -> dict[str, npt.NDArray[np.float16]]:
    """Weights as the package keeps them: of a layer `NAME.w` of shape (in, out), by ray, and `NAME.b`."""
    weights = {}
    for name, layer in layers_of(network):
        weight = layer.weight.detach().flatten(2) if layer.weight.dim() > 2 else layer.weight.detach()[..., None]
        weights[f"{name}.w"] = weight.permute(2, 1, 0).flatten(0, 1).numpy().astype(np.float16)
        weights[f"{name}.b"] = layer.bias.detach().numpy().astype(np.float16)
    return weights


def export(network: Network, path: Path) -> None:
    """Write the weights into a file for the package, `matchset/image/disc_network/weights.npz`."""
    arrays: dict[str, Any] = {**weights_of(network)}
    np.savez(path, **arrays)


def begin_with(network: Network, path: Path) -> None:
    """Give a network the weights of one that was learned before: the state of a `.pt`, or an exported `.npz`.

    One that is wider, or reads more numbers of a place, goes on from there: of what it knows besides, nothing counts at
    first (Chen et al., Net2Net).
    """
    earlier = _earlier(path)
    with torch.no_grad():
        for name, layer in layers_of(network):
            weight, bias = earlier[f"{name}.weight"], earlier[f"{name}.bias"]
            if name == "first":
                by_place = weight.reshape(len(weight), PLACES, -1)
                more = NUMBERS - by_place.shape[2]
                weight = functional.pad(by_place, (0, more)).reshape(len(weight), -1, 1)
            halves = 2 if name == "cls" else 1  # means and maxima, one after the other
            for new, known in zip(layer.weight.chunk(halves, 1), weight.chunk(halves, 1), strict=True):
                outs, ins = known.shape[:2]
                new[:outs].zero_()
                new[:outs, :ins].copy_(known)
            layer.bias[: len(bias)].copy_(bias)


def _earlier(path: Path) -> dict[str, torch.Tensor]:
    """Weights and biases of a network that was learned before, by layer, as PyTorch has them."""
    if path.suffix != ".npz":
        state: dict[str, torch.Tensor] = torch.load(path, weights_only=True)
        return state
    state = {}
    with np.load(path) as file:
        kept = with_silent({name: file[name] for name in file.files})
    for name, reach in {"first": 1, **dict.fromkeys(STEPS, KERNEL), "out": 1, "cls": 0}.items():
        weight = torch.from_numpy(kept[f"{name}.w"].astype(np.float32))
        by_ray = weight.reshape(reach, -1, weight.shape[1]).permute(2, 1, 0) if reach else weight.T
        state[f"{name}.weight"] = by_ray
        state[f"{name}.bias"] = torch.from_numpy(kept[f"{name}.b"].astype(np.float32))
    return state


def loss_of(output: Output, targets: torch.Tensor, limits: LearningParameters) -> torch.Tensor:
    """Mean of the negative logarithm of the likelihood of all that is told in targets of shape (n, 4)."""
    there = targets[:, COORDINATES]
    off = output.step - targets[:, :COORDINATES]
    squared = torch.einsum("ni,nij,nj->n", off, output.precision, off)
    tails = 0.5 * (limits.freedom + COORDINATES) * torch.log1p(squared / limits.freedom)
    circles = tails - 0.5 * torch.logdet(output.precision)
    entropy = functional.binary_cross_entropy_with_logits(output.log_odds, there)
    return (circles * there).sum() / there.sum().clamp(min=1.0) + limits.there * entropy


class Score(NamedTuple):
    """How good a network is on examples that it has not learned from.

    Attributes
    ----------
    loss : float
    area : float
        Share of pairs of a ball and none of which the ball has the larger log-odds.
    false : (float, float)
        Share of others that are taken for balls where 10 % and where 30 % of the balls are missed.
    errors : (float, float, float)
        Half, three quarters and 90 % of the circles are off by no more: sum over x, y and radius, radii.
    close : float
        Share of circles that are off by less than 1/12.
    """

    loss: float
    area: float
    false: tuple[float, float]
    errors: tuple[float, float, float]
    close: float

    def __str__(self) -> str:
        balls = f"balls told from others {self.area:.4f}, false at 10 % missed {self.false[0]:.4f}, at 30 %"
        half, most, nearly_all = self.errors
        circles = f"off by {half:.3f}, {most:.3f} (75 %), {nearly_all:.3f} (90 %) radii, under 1/12 {self.close:.3f}"
        return f"loss {self.loss:.3f}; {balls} {self.false[1]:.4f}; {circles}"


MISSED = (0.1, 0.3)  # shares of balls that are missed where false ones are counted
QUANTILES = (0.5, 0.75, 0.9)  # of errors that are shown
CLOSE = 1.0 / 12.0  # radii, sum over x, y and radius: what is close


def score_of(network: Network, patches: torch.Tensor, targets: torch.Tensor, limits: LearningParameters) -> Score:
    """Say how good a network is on examples."""
    with torch.no_grad():
        output = network(patches.float())
        loss = float(loss_of(output, targets, limits))
    ball = targets[:, COORDINATES] > 0.5
    off = (output.step - targets[:, :COORDINATES]).abs().sum(1)[ball].numpy()
    odds, other_odds = output.log_odds[ball], output.log_odds[~ball]
    area = float((odds[:, None] > other_odds).float().mean())
    first, second = (float((other_odds > torch.quantile(odds, missed)).float().mean()) for missed in MISSED)
    half, most, nearly_all = np.quantile(off, QUANTILES).tolist()
    return Score(loss, area, (first, second), (half, most, nearly_all), float((off < CLOSE).mean()))


def held_back(count: int, limits: LearningParameters) -> int:
    """How many of so many examples are held back; an error where too few are left for one step."""
    held = min(limits.held, int(limits.held_share * count))
    if held < 2 or count - held < limits.batch:
        raise ValueError(f"a step needs {limits.batch} examples beside those held back, got {count}")
    return held


def _rate(step: int, done: float, limits: LearningParameters) -> float:
    """Step size: rises at first, falls as a cosine with the share of the steps that is over."""
    rise = min(1.0, step / limits.first_steps + limits.first_rate)
    return limits.rate * rise * max(0.5 * (1.0 + math.cos(math.pi * min(done, 1.0))), limits.last_rate)


class Learner:
    """A network that learns, and the moving average of its weights.

    Parameters
    ----------
    limits : LearningParameters
    begin : Path, optional
        Weights to begin with.
    seed : int
    """

    def __init__(self, limits: LearningParameters, begin: Path | None = None, seed: int = 0) -> None:
        torch.manual_seed(seed)
        self._limits = limits
        self._network = Network(limits.network)
        if begin is not None:
            begin_with(self._network, begin)
        self.average = copy.deepcopy(self._network)
        self._optimizer = torch.optim.AdamW(self._network.parameters(), limits.rate, weight_decay=limits.decay)
        self._chance = torch.Generator().manual_seed(seed)
        self._steps = 0

    def learn(self, patches: torch.Tensor, targets: torch.Tensor, done: float) -> float:
        """Take a step by a batch of examples, after a share of all; gives its loss."""
        limits = self._limits
        for group in self._optimizer.param_groups:
            group["lr"] = _rate(self._steps, done, limits)
        patches, targets = varied(patches, targets, self._chance, limits.augmentation)
        loss = loss_of(self._network(patches), targets, limits)
        self._optimizer.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(self._network.parameters(), limits.most_slope)
        self._optimizer.step()
        self._steps += 1
        share = limits.average if self._steps > limits.average_after else limits.first_average
        with torch.no_grad():
            for mean, value in zip(self.average.parameters(), self._network.parameters(), strict=True):
                mean.lerp_(value, share)
        return float(loss.detach())

    def batches(self, count: int, first: int) -> Iterator[npt.NDArray[np.int64]]:
        """Choose the examples of each step of a round: their indices, from the first that is not held back."""
        order = first + torch.randperm(count - first, generator=self._chance).numpy()
        for start in range(0, len(order) - self._limits.batch + 1, self._limits.batch):
            yield np.sort(order[start : start + self._limits.batch])


def train(examples: Examples, steps: int, learner: Learner, limits: LearningParameters) -> Score:
    """Learn from examples, and say after each round of them how good that is.

    Parameters
    ----------
    examples : Examples
    steps : int
        Batches that are learned from. Counted and not timed, so that the same examples give the same weights again.
    learner : Learner
    limits : LearningParameters

    Returns
    -------
    Score
        On the examples held back.
    """
    patches, targets = torch.from_numpy(examples.patches), torch.from_numpy(examples.targets)
    held = held_back(len(targets), limits)
    taken = 0
    while True:
        losses = []
        for chosen in itertools.islice(learner.batches(len(targets), held), steps - taken):
            losses.append(learner.learn(patches[chosen].float(), targets[chosen], taken / steps))
            taken += 1
        score = score_of(learner.average, patches[:held], targets[:held], limits)
        if taken == steps:
            return score
        typer.echo(f"{taken} of {steps} steps, loss {np.mean(losses):.3f}; held back: {score}")


def main(
    examples: Annotated[list[Path], typer.Argument(help="Files of `python -m training.examples`.")],
    out: Annotated[Path, typer.Option(help="Weights to write, .npz; their state goes beside it, .pt.")],
    steps: Annotated[int, typer.Option(help="Batches to learn from.", min=1)] = 10000,
    begin: Annotated[Path | None, typer.Option(help="Weights to begin with, .pt or .npz.")] = None,
    width: Annotated[int, typer.Option(help="Numbers that are known of a ray.", min=1)] = NetworkParameters().width,
    threads: Annotated[int, typer.Option(help="Threads of PyTorch.", min=1)] = 1,
) -> None:
    """Learn the weights of the network, and say how good it is on examples held back."""
    torch.set_num_threads(threads)
    limits = LearningParameters(network=NetworkParameters(width))
    learner, read = Learner(limits, begin), read_examples(examples)
    try:
        score = train(read, steps, learner, limits)
    except ValueError as error:
        raise typer.BadParameter(str(error)) from None
    export(learner.average, out)
    torch.save(learner.average.state_dict(), out.with_suffix(".pt"))
    typer.echo(f"held back, {held_back(len(read.targets), limits)} of {len(read.targets)} examples: {score}")


if __name__ == "__main__":
    typer.run(main)
