"""Several balls at once: what they cost, whether they keep their identities, when a newcomer is noticed."""

import math
import time
from collections.abc import Sequence

import cv2
import numpy as np

import matchset as ms
from benchmarks.options import Options
from benchmarks.results import Figure, Finding, Goal, Section
from matchset.localization.markers.ball_colors import pick_marker
from matchset.sim.clips.multi_ball_clip import MultiBallClip, PositionFunction
from matchset.tracking.many.searching.strip_search import StripSearch
from matchset.tracking.motion import Gate

CAMERA = ms.CameraModel.from_fov(640, 480, 1.25)
TARGET = ms.BallTarget(diameter=0.28, markers=((0, 0, 1),))
LOW, HIGH = np.array((100, 60, 40)), np.array((130, 255, 255))
NEAR = 0.15  # m from its ball from which a pose belongs to another


def run(options: Options) -> Section:
    """Time one and five neighbors and the search, and let three cross behind each other."""
    text = (
        "Balloons in a rendered room, `typical`. *Cost*: `Neighbors.update` with five balls in view and with one, less "
        "the search's strip, interleaved frame by frame. *Search*: one strip, against `cvtColor` + `inRange` of the "
        "frame. *Crossing*: three balloons hide each other in the middle of the picture; a seed is kept if every "
        "identity stayed with its balloon. *Newcomer*: time from half in view to the first answer."
    )
    return Section("Neighbors", [*_cost(options), _crossing(options), _newcomer(options)], text)


def watcher(seed: int) -> ms.Neighbors:
    """Make neighbors whose colors were learnt from one click each."""
    frame = next(iter(MultiBallClip(camera=CAMERA, paths=[lambda _: (0.0, 0.0, 1.0)], frames=1, seed=seed)))
    purple = pick_marker(frame.image, CAMERA.cx, CAMERA.cy)
    blue = ms.ColorModel.pick(frame.image, CAMERA.cx - 40.0, CAMERA.cy) | purple
    return ms.Neighbors(CAMERA, TARGET, blue, purple)


class _Timed:
    """A search for newcomers that notes how long it takes, frame by frame."""

    def __init__(self, search: StripSearch) -> None:
        self.search, self.spent = search, 0
        self.ns: list[int] = []

    def update(self, frame: ms.Frame, known: Sequence[Gate]) -> list[ms.Track[ms.Circle]]:
        begin = time.perf_counter_ns()
        found = self.search.update(frame, known)
        self.spent = time.perf_counter_ns() - begin
        self.ns.append(self.spent)
        return found

    def near(self, frame: ms.Frame, place: Gate, known: Sequence[Gate]) -> list[ms.Track[ms.Circle]]:
        return self.search.near(frame, place, known)


class _Contender:
    """Neighbors before a crowd of their own: what the search costs them, and all the rest."""

    def __init__(self, paths: list[PositionFunction], frames: int, seed: int) -> None:
        self.neighbors = watcher(seed)
        strips = self.neighbors._balls._observer.searches._strips
        ((label, search),) = strips.items()
        self.search = _Timed(search)
        vars(self.neighbors._balls._observer.searches)["_strips"] = {label: self.search}
        self.frames = list(MultiBallClip(camera=CAMERA, paths=paths, frames=frames, seed=seed))
        self.ns: list[int] = []

    def step(self, k: int) -> None:
        self.search.spent = 0
        begin = time.perf_counter_ns()
        self.neighbors.update(self.frames[k])
        self.ns.append(time.perf_counter_ns() - begin - self.search.spent)

    def rest_us(self) -> float:
        return float(np.median(self.ns[10:])) / 1e3

    def search_us(self) -> float:
        return float(np.median(self.search.ns[10:])) / 1e3


def _cost(options: Options) -> list[Finding]:
    frames = 60 if options.quick else 200
    many = [_swaying(k) for k in range(5)]
    five, one = (_Contender(paths, frames, options.seeds[0]) for paths in (many, many[2:3]))
    conversion: list[int] = []
    for k in range(frames):
        five.step(k)
        one.step(k)
        begin = time.perf_counter_ns()
        cv2.inRange(cv2.cvtColor(five.frames[k].image, cv2.COLOR_BGR2HSV), LOW, HIGH)
        conversion.append(time.perf_counter_ns() - begin)
    strip, whole = five.search_us(), float(np.median(conversion[10:])) / 1e3
    times = Figure("five", five.rest_us(), "µs", 1), Figure("one", one.rest_us(), "µs", 1)
    return [
        Finding(
            name="neighbors_cost",
            what="five neighbors against one, beyond the search's strip",
            figures=(Figure("ratio", five.rest_us() / one.rest_us(), "", 2), *times),
            bar=(Goal("ratio", high=5.5),),
            prize=(),
        ),
        Finding(
            name="neighbors_search",
            what="search for newcomers, a strip, against cvtColor + inRange",
            figures=(Figure("ratio", strip / whole, "", 2), Figure("strip", strip, "µs", 1)),
            bar=(Goal("ratio", high=0.5),),
            prize=(),
        ),
    ]


def _swaying(k: int) -> PositionFunction:
    return lambda t: (-1.0 + 0.5 * k, 0.35 * math.sin(2.0 * k + t), 2.2)


def _crossing(options: Options) -> Finding:
    paths: list[PositionFunction] = [
        lambda t: (-0.9 + 0.4 * t, 0.0, 2.2),
        lambda t: (0.9 - 0.4 * t, 0.05, 1.5),
        lambda t: (0.0, -0.4 + 0.25 * t, 1.0),
    ]
    kept = 0
    for seed in options.seeds:
        met: dict[int, set[int]] = {}
        neighbors = watcher(seed)
        for frame in MultiBallClip(camera=CAMERA, paths=paths, frames=130, seed=seed):
            for each in neighbors.update(frame):
                if isinstance(each.pose, ms.Pose):
                    met.setdefault(each.identity, set()).add(_whose(each.pose, paths, frame.time))
        kept += sorted(tuple(balls - {-1}) for balls in met.values()) == [(0,), (1,), (2,)]
    share = 100.0 * kept / len(options.seeds)
    return Finding(
        name="neighbors_identity",
        what="three neighbors cross and hide each other: seeds in which each keeps its identity",
        figures=(Figure("kept", share, "%", 0),),
        bar=(Goal("kept", low=100.0),),
        prize=(),
    )


def _whose(pose: ms.Pose, paths: Sequence[PositionFunction], time: float) -> int:
    far = [float(np.linalg.norm(np.subtract(path(time) or (9.0, 9.0, 9.0), pose.position))) for path in paths]
    return int(np.argmin(far)) if min(far) < NEAR else -1


def _newcomer(options: Options) -> Finding:
    entering: PositionFunction = lambda t: (-1.6 + 0.6 * t, 0.2, 1.8)  # noqa: E731
    waits = []
    for seed in options.seeds:
        neighbors = watcher(seed)
        paths: list[PositionFunction] = [lambda _: (0.3, 0.0, 1.8), entering]
        entered = next(k for k in range(90) if _in_view(entering(k / 30)))
        crowd = MultiBallClip(camera=CAMERA, paths=paths, frames=90, seed=seed)
        noticed = next((k for k, frame in enumerate(crowd) if len(neighbors.update(frame)) > 1), 90)
        waits.append(noticed - entered)
    return Finding(
        name="neighbors_newcomer",
        what="a newcomer is noticed, after half of it is in view",
        figures=(
            Figure("longest", max(waits) / 30.0, "s", 2),
            Figure("median", float(np.median(waits)) / 30.0, "s", 2),
        ),
        bar=(Goal("longest", high=0.5),),
        prize=(),
    )


def _in_view(place: Sequence[float] | None) -> bool:
    """Whether the middle of a ball is in the picture."""
    x, _, z = place or (9.0, 0.0, 1.0)
    return abs(x / z) < 0.5 * CAMERA.width / CAMERA.fx
