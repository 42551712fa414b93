"""A crowd with physics as frames with their truth, kept in a file: `PhysicsCrowd`, and by names, `SCENES`."""

import hashlib
import os
from collections.abc import Callable, Generator, Iterator
from functools import cache, partial
from itertools import pairwise
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

import matchset as ms
from benchmarks.crowds.crowd import Seen
from benchmarks.crowds.physics.camera import JITTER, View
from benchmarks.crowds.physics.scenes import STAGES
from benchmarks.crowds.physics.sensor import Sensor
from benchmarks.crowds.physics.world import RATE, World, engine

FOLDER = Path(__file__).resolve().parents[3] / "build" / "crowds" / "physics"
RATES = (25, 30)  # frames a second
SPACINGS = (1, 2, 3)  # steps between the parts of an exposure, which is 1/120 to 1/40 s
PREFIX = "physics_"

Made = tuple[npt.NDArray[np.uint8], list[Seen]]


class PhysicsCrowd:
    """A scene: frames, and what is in each. It is rendered once; a file keeps it.

    Parameters
    ----------
    scene : str
        One of `STAGES`.
    balls : int
    seconds : float
    seed : int
        Decides everything.

    Raises
    ------
    ImportError
        If pybullet is not installed.
    """

    def __init__(self, scene: str, balls: int, seconds: float, seed: int) -> None:
        engine()
        self.scene, self.balls, self.seconds, self.seed = scene, balls, seconds, seed
        random = np.random.default_rng(self._seeds(1))
        self.fps = int(random.choice(RATES))
        self.spacing = int(random.choice(SPACINGS))
        self.frames = round(seconds * self.fps)
        self.path = FOLDER / f"{scene}_{balls}_{seconds:g}_{seed}_{source()}.npz"
        self._made: list[Made] = []
        self._rest: Generator[Made, None, None] | None = None

    def __iter__(self) -> Iterator[tuple[ms.Frame, list[Seen]]]:
        if not self._made and self.path.exists():
            self._made = _read(self.path)
        for index in range(self.frames):
            if index == len(self._made):
                self._make()
            coded, seen = self._made[index]
            image = cv2.imdecode(coded, cv2.IMREAD_COLOR)
            if image is None:
                raise ValueError(f"{self.path}: frame {index} is no picture")
            yield ms.Frame(image.astype(np.uint8), index / self.fps, index), list(seen)

    def _seeds(self, number: int) -> tuple[int, int, int]:
        return self.seed, list(STAGES).index(self.scene), number

    def _make(self) -> None:
        """Render one more frame; after the last, keep all."""
        if self._rest is None:
            self._rest = self._played()
        self._made.append(next(self._rest))
        if len(self._made) == self.frames:
            _write(self.path, self._made)
            self._rest.close()
            self._rest = None

    def _played(self) -> Generator[Made, None, None]:
        random, noise = (np.random.default_rng(self._seeds(number)) for number in (2, 3))
        sensor = Sensor(np.random.default_rng(self._seeds(4)))
        with World() as world:
            stage = STAGES[self.scene](world, self.balls, random)
            view = View(world, stage.camera, stage.lamp, stage.normal)
            step = 0
            first = max(round(stage.before * RATE), 1)
            for index in range(self.frames):
                parts = []
                seen: list[Seen] = []
                for part, jitter in enumerate(JITTER):
                    due = first + index * RATE // self.fps + part * self.spacing
                    while step < due:
                        stage.act(step / RATE)
                        world.step()
                        step += 1
                    light, bodies = view.light(jitter)
                    parts.append(light)
                    if jitter == (0.0, 0.0):  # the middle of the exposure
                        named = [(each, each.identity) for each in world.balls]
                        seen = view.truth(bodies, [(ball, name) for ball, name in named if name is not None])
                yield sensor.coded(np.mean(parts, axis=0, dtype=np.float32), index, noise), seen


@cache
def source() -> str:
    """Checksum of the folder's modules."""
    total = hashlib.sha256()
    for path in sorted(Path(__file__).parent.glob("*.py")):
        total.update(path.name.encode() + b"\0" + path.read_bytes())
    return total.hexdigest()[:12]


def _write(path: Path, made: list[Made]) -> None:
    sizes = np.cumsum([0, *(len(coded) for coded, _ in made)])
    truth = [
        (index, each.identity, each.circle.x, each.circle.y, each.circle.radius, each.visible)
        for index, (_, seen) in enumerate(made)
        for each in seen
    ]
    path.parent.mkdir(parents=True, exist_ok=True)
    unfinished = path.with_suffix(f".{os.getpid()}")
    with unfinished.open("wb") as file:
        coded = np.concatenate([each for each, _ in made])
        np.savez(file, coded=coded, sizes=sizes, truth=np.array(truth, float).reshape(-1, 6))
    unfinished.replace(path)


def _read(path: Path) -> list[Made]:
    with np.load(path) as file:
        coded, sizes, truth = file["coded"], file["sizes"].tolist(), file["truth"]
    made: list[Made] = [(coded[begin:end], []) for begin, end in pairwise(sizes)]
    for index, identity, x, y, radius, visible in truth.tolist():
        made[int(index)][1].append(Seen(int(identity), ms.Circle(x, y, radius), visible))
    return made


SCENES: dict[str, Callable[[int, float, int], PhysicsCrowd]] = {
    PREFIX + name: partial(PhysicsCrowd, name) for name in STAGES
}
