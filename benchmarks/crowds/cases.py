"""A crowd that is followed, and what is detected in it, once for all: `Case`, `Watched`, `watched`, `watch`."""

import hashlib
import math
import os
import time
from collections.abc import Callable
from functools import cache
from pathlib import Path

import msgspec

import matchset as ms
from benchmarks.crowds.composed.scenes import COMPOSED, Composed
from benchmarks.crowds.crowd import Crowd, Seen
from benchmarks.crowds.labelled import CLIPS, NAMES, LabelledClip
from benchmarks.crowds.pair import SECONDS, hidden_pair
from benchmarks.crowds.physics.clip import SCENES as PHYSICS
from benchmarks.crowds.physics.clip import PhysicsCrowd
from benchmarks.crowds.scenes import SCENES
from benchmarks.crowds.score import Answer

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "build" / "crowds"
PAIR = "pair"
MOST = 20  # balls of a crowd
RENDERED = (*SCENES, PAIR)
REAL = (*COMPOSED, *NAMES)  # of real pixels
EVERY = (*RENDERED, *REAL, *PHYSICS)
CLEAR = 0.95  # share of a ball that must be seen for a click on it
DETECTING = ("numeric", "shapes", "image", "media", "fitting", "tracking", "camera", "sim")
"""Folders of the package that decide what is rendered and detected; following many balls at once is left out."""
FOLLOWING = (*DETECTING, "localization")
DECIDING = (".py", ".toml", ".npz")


Detection = tuple[float, float, float, float]
AnyCrowd = Crowd | LabelledClip | Composed | PhysicsCrowd


class Case(msgspec.Struct, frozen=True):
    """A crowd to be followed.

    Parameters
    ----------
    scene : str
        One of `SCENES` or `COMPOSED`, "pair", a clip that was labelled, or one of `PHYSICS`.
    balls : int
    seconds : float
        0 of a clip, which has a length of its own.
    seed : int
    """

    scene: str
    balls: int
    seconds: float
    seed: int

    def __post_init__(self) -> None:
        if self.scene not in EVERY:
            raise ValueError(f"a scene is one of {', '.join(EVERY)}, got {self.scene!r}")
        if not 1 <= self.balls <= MOST:
            raise ValueError(f"a crowd has 1 to {MOST} balls, got {self.balls}")

    def crowd(self) -> AnyCrowd:
        """Make it; a pair and a clip have balls and a length of their own."""
        if self.scene == PAIR:
            return hidden_pair(self.seed)
        if self.scene in NAMES:
            return LabelledClip(self.scene)
        if self.scene in PHYSICS:
            return PHYSICS[self.scene](self.balls, self.seconds, self.seed)
        if self.scene in COMPOSED:
            return COMPOSED[self.scene](self.balls, self.seconds, self.seed)
        return SCENES[self.scene](self.balls, self.seconds, self.seed)


def cases(scenes: list[str], balls: list[int], seconds: float, seeds: tuple[int, ...]) -> list[Case]:
    """List the crowds of some scenes, numbers of balls and seeds; a pair once for each seed, a clip once."""
    listed = []
    for scene in scenes:
        if scene in NAMES:
            listed.append(Case(scene, CLIPS[scene].balls, 0.0, 0))
        elif scene == PAIR:
            listed += [Case(PAIR, 2, SECONDS, seed) for seed in seeds]
        else:
            listed += [Case(scene, number, seconds, seed) for number in balls for seed in seeds]
    return listed


def real() -> list[Case]:
    """List the crowds of real pixels that report."""
    composed = [Case(scene, balls, 4.0, seed) for scene in COMPOSED for balls in (8, 10) for seed in (650, 651)]
    return composed + cases(list(NAMES), [], 0.0, ())


def drawn_otherwise() -> list[Case]:
    """List the crowds of the other renderer that report."""
    bouncing = [Case("physics_bouncing", 6, 2.52, seed) for seed in (500, 501, 502)]
    return bouncing + [Case(scene, 10, 3.0, 500) for scene in PHYSICS if scene != "physics_bouncing"]


class Watched(msgspec.Struct, frozen=True):
    """A crowd's truth and detections, frame by frame.

    Parameters
    ----------
    truth : list of (list of (int, float, float, float, float) or None)
        Identity, x, y, radius, px, and the share that is visible; None of a frame without labels.
    found : list of list of (float, float, float, float)
        x, y, radius, px, and support of each circle that `detect` finds.
    seconds : list of float
        What detecting took.
    """

    truth: list[list[tuple[int, float, float, float, float]] | None]
    found: list[list[Detection]]
    seconds: list[float]

    def judged(self, answers: list[list[Answer]]) -> tuple[list[list[Seen]], list[list[Answer]]]:
        """Return the truth of every frame that has one, and the answers there."""
        pairs = [(there, said) for there, said in zip(self.truth, answers, strict=True) if there is not None]
        seen = [[Seen(name, ms.Circle(x, y, r), share) for name, x, y, r, share in there] for there, _ in pairs]
        return seen, [said for _, said in pairs]


def click_of(crowd: AnyCrowd) -> tuple[ms.Frame, ms.Circle]:
    """Return the first frame in which a ball is clear, and the largest such ball: what all followers are told.

    Raises
    ------
    ValueError
        If none ever is.
    """
    for frame, seen in crowd:
        clear = [each for each in seen or () if each.visible > CLEAR]
        if clear:
            return frame, max(clear, key=lambda each: each.circle.radius).circle
    raise ValueError("no ball of this crowd is ever seen whole")


def color_of(crowd: AnyCrowd) -> ms.ColorModel:
    """Learn the balls' color by the click of `click_of`."""
    frame, circle = click_of(crowd)
    return ms.ColorModel.pick(frame.image, circle.x, circle.y)


def watched(case: Case) -> Watched:
    """Return the truth and the detections of a crowd, from a file if it was watched before."""
    version = checksum(DETECTING) + composed_checksum(case.scene)
    name = f"{case.scene}_{case.balls}_{case.seconds:g}_{case.seed}_{version}.json"
    path = FOLDER / name
    if path.exists():
        return msgspec.json.decode(path.read_bytes(), type=Watched)
    crowd = case.crowd()
    color = color_of(crowd)

    def find(frame: ms.Frame) -> list[Detection]:
        found = ms.detect(frame, ms.Circle, color, limit=2 * case.balls)
        return [(*_rounded(each.shape), round(each.support, 4)) for each in found]

    return watch(path, crowd, find)


def watch(path: Path, crowd: AnyCrowd, find: Callable[[ms.Frame], list[Detection]]) -> Watched:
    """Note what is found in each frame of a crowd, and how long that took; in a file, too, which is whole or not there.

    Parameters
    ----------
    path : Path
    crowd : Crowd
    find : callable
        Circles in a frame: x, y, radius, px, and their confidence.
    """
    result = Watched([], [], [])
    for frame, seen in crowd:
        begin = time.perf_counter()
        found = find(frame)
        result.seconds.append(time.perf_counter() - begin)
        result.found.append(found)
        result.truth.append(noted(seen))
    path.parent.mkdir(parents=True, exist_ok=True)
    unfinished = path.with_suffix(f".{os.getpid()}")
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
    files += [here / name for name in ("crowd.py", "scenes.py", "juggling.py", "pair.py", "labelled.py")]
    files += sorted((here / "physics").glob("*.py"))
    for path in files:
        if many not in path.parents or "localization" in folders:
            total.update(path.name.encode() + b"\0" + path.read_bytes())
    return total.hexdigest()[:12]


@cache
def composed_checksum(scene: str) -> str:
    """Checksum of what decides a composed crowd, after a dash; nothing of another scene."""
    if scene not in COMPOSED:
        return ""
    total = hashlib.sha256()
    for path in sorted((Path(__file__).parent / "composed").glob("*.py")):
        total.update(path.name.encode() + b"\0" + path.read_bytes())
    return f"-{total.hexdigest()[:6]}"


def noted(seen: list[Seen] | None) -> list[tuple[int, float, float, float, float]] | None:
    """Return what is noted of a frame's truth in `Watched`."""
    if seen is None:
        return None
    return [(ball.identity, *_rounded(ball.circle), round(ball.visible, 4)) for ball in seen]


def _rounded(circle: ms.Circle) -> tuple[float, float, float]:
    if not all(math.isfinite(each) for each in (circle.x, circle.y, circle.radius)):
        raise ValueError(f"a circle must be finite, got {circle}")
    return round(circle.x, 3), round(circle.y, 3), round(circle.radius, 3)
