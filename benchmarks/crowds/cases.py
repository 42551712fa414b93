"""A crowd that is followed, and what is detected in it, once for all: `Case`, `Watched`, `watched`."""

import hashlib
import math
import time
from functools import cache
from pathlib import Path

import msgspec

import matchset as ms
from benchmarks.crowds.crowd import Crowd, Seen
from benchmarks.crowds.pair import SECONDS, hidden_pair
from benchmarks.crowds.scenes import SCENES

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "build" / "crowds"
PAIR = "pair"
MOST = 20  # balls of a crowd
CLEAR = 0.95  # share of a ball that must be seen for a click on it
DETECTING = ("numeric", "shapes", "image", "media", "fitting", "tracking", "camera", "sim")
"""Folders of the package that decide what is rendered and detected; following many balls at once is left out."""
FOLLOWING = (*DETECTING, "localization")
DECIDING = (".py", ".toml", ".npz")


class Case(msgspec.Struct, frozen=True):
    """A crowd to be followed.

    Parameters
    ----------
    scene : str
        One of `SCENES`, or "pair".
    balls : int
    seconds : float
    seed : int
    """

    scene: str
    balls: int
    seconds: float
    seed: int

    def __post_init__(self) -> None:
        if self.scene not in SCENES and self.scene != PAIR:
            raise ValueError(f"a scene is one of {', '.join([*SCENES, PAIR])}, got {self.scene!r}")
        if not 1 <= self.balls <= MOST:
            raise ValueError(f"a crowd has 1 to {MOST} balls, got {self.balls}")

    def crowd(self) -> Crowd:
        """Make it; a pair has two balls and a length of its own."""
        if self.scene == PAIR:
            return hidden_pair(self.seed)
        return SCENES[self.scene](self.balls, self.seconds, self.seed)


def cases(scenes: list[str], balls: list[int], seconds: float, seeds: tuple[int, ...]) -> list[Case]:
    """List the crowds of some scenes, numbers of balls and seeds; a pair is listed once for each seed."""
    return [
        Case(scene, number, SECONDS if scene == PAIR else seconds, seed)
        for scene in scenes
        for number in ([2] if scene == PAIR else balls)
        for seed in seeds
    ]


class Watched(msgspec.Struct, frozen=True):
    """A crowd's truth and detections, frame by frame.

    Parameters
    ----------
    truth : list of list of (int, float, float, float, float)
        Identity, x, y, radius, px, and the share that is visible.
    found : list of list of (float, float, float, float)
        x, y, radius, px, and support of each circle that `detect` finds.
    seconds : list of float
        What detecting took.
    """

    truth: list[list[tuple[int, float, float, float, float]]]
    found: list[list[tuple[float, float, float, float]]]
    seconds: list[float]

    def seen(self) -> list[list[Seen]]:
        """Return the truth of every frame."""
        return [[Seen(name, ms.Circle(x, y, r), share) for name, x, y, r, share in there] for there in self.truth]


def color_of(crowd: Crowd) -> ms.ColorModel:
    """Learn the balls' color by a click on the largest one of the first frame in which one is clear.

    Raises
    ------
    ValueError
        If none ever is.
    """
    for frame, seen in crowd:
        clear = [each for each in seen if each.visible > CLEAR]
        if clear:
            circle = max(clear, key=lambda each: each.circle.radius).circle
            return ms.ColorModel.pick(frame.image, circle.x, circle.y)
    raise ValueError("no ball of this crowd is ever seen whole")


def watched(case: Case) -> Watched:
    """Return the truth and the detections of a crowd, from a file if it was watched before."""
    name = f"{case.scene}_{case.balls}_{case.seconds:g}_{case.seed}_{checksum(DETECTING)}.json"
    path = FOLDER / name
    if path.exists():
        return msgspec.json.decode(path.read_bytes(), type=Watched)
    crowd = case.crowd()
    color = color_of(crowd)
    result = Watched([], [], [])
    for frame, seen in crowd:
        begin = time.perf_counter()
        found = ms.detect(frame, ms.Circle, color, limit=2 * case.balls)
        result.seconds.append(time.perf_counter() - begin)
        result.found.append([(*_rounded(each.shape), round(each.support, 4)) for each in found])
        result.truth.append([(each.identity, *_rounded(each.circle), round(each.visible, 4)) for each in seen])
    FOLDER.mkdir(parents=True, exist_ok=True)
    unfinished = path.with_suffix(".part")
    unfinished.write_bytes(msgspec.json.encode(result))
    unfinished.replace(path)
    return result


@cache
def checksum(folders: tuple[str, ...]) -> str:
    """Checksum of the scenes and of folders of the package; following many balls counts if localization does."""
    total = hashlib.sha256()
    package = Path(ms.__file__).parent
    many = package / "tracking" / "many"
    files = [path for folder in folders for path in sorted((package / folder).rglob("*")) if path.suffix in DECIDING]
    here = Path(__file__).parent
    files += [here / name for name in ("crowd.py", "scenes.py", "juggling.py", "pair.py", "cases.py")]
    for path in files:
        if many not in path.parents or "localization" in folders:
            total.update(path.name.encode() + b"\0" + path.read_bytes())
    return total.hexdigest()[:12]


def _rounded(circle: ms.Circle) -> tuple[float, float, float]:
    if not all(math.isfinite(each) for each in (circle.x, circle.y, circle.radius)):
        raise ValueError(f"a circle must be finite, got {circle}")
    return round(circle.x, 3), round(circle.y, 3), round(circle.radius, 3)
