"""Examples to learn from: patches around circles near a rendered ball, and where the ball is from there.

    python -m training.examples OUT --photographs FOLDER --seed 31 --scenes 14000

writes `patches`, float16 of shape (n, 64, 32, 6), as the package's `read_patch` gives them, and `targets`, float32 of
shape (n, 4): how far the ball's center is along x and y, how much larger its radius is, all in radii of the circle, and
1 for a ball; where there is none that is 0, and the others do not count. 14,000 scenes are 2.1 GB.
"""

import math
from pathlib import Path
from typing import Annotated, NamedTuple

import cv2
import msgspec
import numpy as np
import numpy.typing as npt
import typer

from matchset.image.disc_network.patch_format import NUMBERS, PLACES, RAYS, Circle3, Colors
from matchset.image.disc_network.polar_patch import colors_of, read_patch
from training.rendering.layers import FULL, Floats, Random, Range, Singles, any_angle, away, happens, which, within
from training.rendering.photographs import Photographs
from training.rendering.scene import Scene, SceneParameters, render

Halves = npt.NDArray[np.float16]

TARGETS = 4  # x, y, radius, and whether there is a ball


class KnownParameters(msgspec.Struct, frozen=True):
    """How the colors of a ball are known from an earlier picture; chosen by hand.

    Parameters
    ----------
    light : float
        Standard deviation of the logarithm by which its light was another.
    tint : float
        The same of each channel besides.
    jumps : float
        Share of pictures whose light differs by `jump` instead.
    jump : float
    off : float
        Standard deviation of a coordinate of the circle in which they were seen from the ball's, radii.
    parts : float
        Share of circles that are a part of the ball.
    part : (float, float)
        Radius of those, radii of the ball.
    part_off : (float, float)
        Distance of their centers, as a share of what keeps them within it.
    others : float
        Share of shapes that are no balls whose colors are those of the ball rendered before.
    """

    light: float = 0.12
    tint: float = 0.04
    jumps: float = 0.1
    jump: float = 0.4
    off: float = 0.06
    parts: float = 0.35
    part: Range = (0.5, 0.8)
    part_off: Range = (0.0, 1.0)
    others: float = 0.5


class ExampleParameters(msgspec.Struct, frozen=True):
    """Which circles are read in a scene; chosen by hand.

    Parameters
    ----------
    near : int
        Circles near each ball.
    spreads : tuple of float
        Standard deviations of a coordinate of those from the ball's, radii, each as likely.
    farthest : float
        Most that one is off, radii.
    radius_share : float
        How much less that is for the radius, as a share.
    swept : float
        Share of them that are moved along the way of a moving ball besides, by up to half of it.
    apart : (float, float)
        Share of circles off the ball that are beside it, and that are within it; the others are around it.
    beside, within, around : (float, float)
        Distance of their centers from the ball's, radii of the ball.
    beside_size : float
        Standard deviation of the logarithm of their radius, of those beside it.
    within_size, around_size : (float, float)
        Radius of the others, radii of the ball.
    other_spreads : tuple of float
        Standard deviations of a coordinate of a circle from another shape's, radii, each as likely.
    least_radius : float
        Smaller circles are not read, px.
    known : KnownParameters
    scene : SceneParameters
    """

    near: int = 4
    spreads: tuple[float, ...] = (0.04, 0.1, 0.18)
    farthest: float = 0.42
    radius_share: float = 0.8
    swept: float = 0.5
    apart: tuple[float, float] = (0.5, 0.25)
    beside: Range = (0.75, 2.0)
    within: Range = (0.0, 0.5)
    around: Range = (0.0, 1.0)
    beside_size: float = 0.3
    within_size: Range = (0.25, 0.5)
    around_size: Range = (1.9, 3.0)
    other_spreads: tuple[float, ...] = (0.02, 0.2)
    least_radius: float = 2.0
    known: KnownParameters = KnownParameters()
    scene: SceneParameters = SceneParameters()


class Example(NamedTuple):
    """A patch of shape (64, 32, 6), and its target of shape (4,)."""

    patch: Singles
    target: Singles


class Examples(NamedTuple):
    """All patches and targets, of shape (n, 64, 32, 6) and (n, 4)."""

    patches: Halves
    targets: Singles


def examples_of(random: Random, photographs: Photographs, limits: ExampleParameters) -> list[Example]:
    """Render a ball and another shape, and read them around circles: four near the ball, two that are no balls."""
    ball = render(random, photographs, is_ball=True, limits=limits.scene)
    known = _known(random, ball, limits.known)
    circles = [(_near(random, ball, limits), True) for _ in range(limits.near)]
    circles.append((_apart(random, ball.circle, limits), False))
    found = [_example(ball, circle, known, (is_ball, limits)) for circle, is_ball in circles]
    other = render(random, photographs, is_ball=False, limits=limits.scene)
    off = random.normal(0.0, random.choice(limits.other_spreads), 3)
    colors = known if happens(random, limits.known.others) else _known(random, other, limits.known)
    found.append(_example(other, _moved(other.circle, off, limits), colors, (False, limits)))
    return [example for example in found if example is not None]


def _known(random: Random, scene: Scene, limits: KnownParameters) -> Colors | None:
    """Colors of a ball from an earlier picture, in another light."""
    sigma = limits.jump if happens(random, limits.jumps) else limits.light
    gains = np.exp(random.normal(0.0, sigma) + random.normal(0.0, limits.tint, 3))
    relit = np.asarray(np.clip(scene.earlier * gains, 0.0, FULL), np.uint8)
    x, y, radius = scene.earlier_circle
    if happens(random, limits.parts):
        size = within(random, limits.part)
        x, y = away((x, y), any_angle(random), within(random, limits.part_off) * (1.0 - size) * radius)
        radius *= size
    right, down, larger = (random.normal(0.0, limits.off, 3) * radius).tolist()
    return colors_of(relit, (x + right, y + down, radius + larger))


def _moved(circle: Circle3, off: Floats, limits: ExampleParameters) -> Circle3:
    """Circle that is off another, in radii of that."""
    x, y, radius = circle
    right, down, larger = (float(value) * radius for value in off)
    return x + right, y + down, radius + limits.radius_share * larger


def _near(random: Random, ball: Scene, limits: ExampleParameters) -> Circle3:
    """Circle near a ball."""
    off = random.normal(0.0, random.choice(limits.spreads), 3)
    x, y, radius = _moved(ball.circle, np.clip(off, -limits.farthest, limits.farthest), limits)
    along = within(random, (-1.0, 1.0)) if happens(random, limits.swept) else 0.0
    return x + along * ball.sweep[0], y + along * ball.sweep[1], radius


def _apart(random: Random, ball: Circle3, limits: ExampleParameters) -> Circle3:
    """Circle that is not a ball's: beside it, within or around."""
    kind = which(random, limits.apart)
    if kind == 0:
        distance, size = within(random, limits.beside), math.exp(random.normal(0.0, limits.beside_size))
    elif kind == 1:
        distance, size = within(random, limits.within), within(random, limits.within_size)
    else:
        distance, size = within(random, limits.around), within(random, limits.around_size)
    return *away(ball[:2], any_angle(random), distance * ball[2]), size * ball[2]


def _example(
    scene: Scene, circle: Circle3, known: Colors | None, chosen: tuple[bool, ExampleParameters]
) -> Example | None:
    """Read a scene around a circle; None where that is too small or not in the picture."""
    is_ball, limits = chosen
    if not circle[2] > limits.least_radius:
        return None
    patch = read_patch(scene.image, circle, known)
    if patch is None:
        return None
    step = np.subtract(scene.circle, circle) / circle[2]
    return Example(patch, np.append(step, float(is_ball)).astype(np.float32))


def make_examples(
    seed: int, scenes: int, photographs: Photographs, limits: ExampleParameters | None = None
) -> Examples:
    """Make examples of so many scenes of a ball, and as many without.

    Parameters
    ----------
    seed : int
        The same gives the same examples.
    scenes : int
    photographs : Photographs
    limits : ExampleParameters, optional
    """
    limits = limits or ExampleParameters()
    random, most = np.random.default_rng(seed), (limits.near + 2) * scenes
    patches = np.empty((most, RAYS, PLACES, NUMBERS), np.float16)
    targets = np.empty((most, TARGETS), np.float32)
    count = 0
    for _ in range(scenes):
        for example in examples_of(random, photographs, limits):
            patches[count], targets[count] = example
            count += 1
    return Examples(patches[:count], targets[:count])


def write_examples(path: Path, examples: Examples) -> None:
    """Write examples into a file."""
    np.savez(path, patches=examples.patches, targets=examples.targets)


def read_examples(paths: list[Path]) -> Examples:
    """Read the examples of files, one after the other; where those were of fewer numbers, the last ones are 0."""
    patches, targets = [], []
    for path in paths:
        with np.load(path) as file:
            read = file["patches"]
            patches.append(np.pad(read, ((0, 0), (0, 0), (0, 0), (0, NUMBERS - read.shape[3]))))
            targets.append(file["targets"])
    return Examples(np.concatenate(patches), np.concatenate(targets))


def main(
    out: Annotated[Path, typer.Argument(help="File to write, .npz.")],
    photographs: Annotated[list[Path], typer.Option(help="Folder of pictures; several can be given.")],
    seed: Annotated[int, typer.Option(help="The same gives the same examples.")] = 31,
    scenes: Annotated[int, typer.Option(help="How many scenes of a ball, and as many without.", min=1)] = 14000,
) -> None:
    """Render scenes and write the examples that they give."""
    cv2.setNumThreads(1)
    try:
        pictures = Photographs.read(photographs)
    except ValueError as error:
        raise typer.BadParameter(str(error)) from None
    examples = make_examples(seed, scenes, pictures)
    write_examples(out, examples)
    typer.echo(f"{len(examples.targets)} examples before {len(pictures)} photographs: {out}")


if __name__ == "__main__":
    typer.run(main)
