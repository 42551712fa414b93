"""What following many balls is measured by: `bars`, and what ten clear balls cost, `cost_ratio`."""

import math
import time
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

import matchset as ms
from benchmarks.crowds.cases import PAIR, Case, cases, color_of
from benchmarks.crowds.crowd import Crowd
from benchmarks.crowds.followers import SMOOTH, Many
from benchmarks.crowds.rows import Row
from matchset.sim.clips.multi_ball_clip import PositionFunction

FEW, MANY = Case("crossing", 5, 60.0, 200), Case("crossing", 16, 60.0, 200)
PAIRS = cases([PAIR], [2], 0.0, tuple(range(200, 300)))
TIMED = [FEW, MANY, *PAIRS]
MOST_SWITCHES, MOST_NAMES, MOST_MS = 1, 20, 8.0
LEAST_RIGHT = 90  # of the pairs
LEAST_HOTA, HOTA_BALLS = 0.9, 10
MOST_COST, COST_BALLS = 1.3, 10
WARM, FRAMES = 45, 200  # frames that do not count, and all


class Bar(NamedTuple):
    """A bar, and what was measured; `reached` None: it was not."""

    what: str
    bar: str
    measured: str
    reached: bool | None

    def line(self) -> str:
        """Write it as a line of a table."""
        said = {True: "yes", False: "**no**", None: "not measured"}[self.reached]
        return f"| {self.what} | {self.bar} | {self.measured} | {said} |"


def bars(rows: Sequence[Row], cost: float | None) -> list[Bar]:
    """Judge the rows of matchset's own tracker; `rows` of all followers say who is first.

    Parameters
    ----------
    rows : sequence of Row
    cost : float or None
        Of `cost_ratio`.
    """
    own = [row for row in rows if row.follower == "matchset"]
    few, many = ([row for row in own if row.case == case] for case in (FEW, MANY))
    pairs = [row for row in own if row.case in PAIRS]
    right, whole = sum(row.right is True for row in pairs), len(pairs) == len(PAIRS)
    doubled = sum(row.score.doubled for row in own)
    switches = [row.score.switches for row in few + many]
    found = [
        *_hotas(rows),
        Bar("switches, 5 balls that cross, 60 s", f"{MOST_SWITCHES}", *_most(few, "switches", MOST_SWITCHES)),
        Bar("names, 16 balls that cross, 60 s", f"{MOST_NAMES}", *_most(many, "names", MOST_NAMES)),
        Bar(
            "the same: 99 % of the frames",
            f"{MOST_MS:g} ms",
            f"{many[0].most_ms:.1f} ms, {switches[-1]} switches" if many else "",
            many[0].most_ms <= MOST_MS if many else None,
        ),
        Bar(
            "one ball hides the other for a second: right names",
            f"{LEAST_RIGHT} of {len(PAIRS)}",
            f"{right} of {len(pairs)}",
            right >= LEAST_RIGHT if whole else None,
        ),
        Bar(
            "two targets on one ball, all of it", "0", f"{doubled} in {len(own)} crowds", doubled == 0 if own else None
        ),
    ]
    ratio = "" if cost is None else f"{cost:.2f}"
    reached = None if cost is None else cost <= MOST_COST
    return [*found, Bar(f"{COST_BALLS} clear balls, against as many single `update`s", f"{MOST_COST}", ratio, reached)]


def _most(rows: Sequence[Row], name: str, most: int) -> tuple[str, bool | None]:
    if not rows:
        return "", None
    value = int(getattr(rows[0].score, name))
    return str(value), value <= most


def _hotas(rows: Sequence[Row]) -> list[Bar]:
    """HOTA of ten balls, for each scene, and matchset's rank."""
    found = []
    for scene in dict.fromkeys(row.case.scene for row in rows if row.case.balls == HOTA_BALLS):
        group = [row for row in rows if row.case.scene == scene and row.case.balls == HOTA_BALLS]
        group = [row for row in group if row.follower != SMOOTH]
        hotas = {
            key: float(np.mean([row.score.hota for row in group if row.follower == key]))
            for key in {row.follower for row in group}
        }
        if "matchset" in hotas:
            rank = 1 + sum(each > hotas["matchset"] for each in hotas.values())
            measured = f"{hotas['matchset']:.3f}, rank {rank} of {len(hotas)}"
            reached = hotas["matchset"] >= LEAST_HOTA and rank == 1
            found.append(Bar(f"HOTA, {HOTA_BALLS} balls, {scene}; rank", f"{LEAST_HOTA:.2f}, first", measured, reached))
    return found


def cost_ratio(seed: int = 200) -> float:
    """Measure what `MultiTracker.update` costs of ten clear balls, over ten single `update`s of a `Tracker` each.

    Both see each frame, one after the other, in turns; the ratio of the medians.
    """
    crowd = clear_balls(COST_BALLS, seed)
    color = color_of(crowd)
    frames = list(crowd)
    many = Many(color)
    single = [ms.Tracker(ms.Circle, color) for _ in range(COST_BALLS)]
    for tracker, ball in zip(single, frames[0][1], strict=True):
        tracker.start(ball.circle)
    took: list[tuple[float, float]] = []
    for number, (frame, _) in enumerate(frames):
        alone = math.nan
        for turn in (number, number + 1):
            if turn % 2:
                many.update(frame)
            else:
                begin = time.perf_counter()
                for tracker in single:
                    tracker.update(frame)
                alone = time.perf_counter() - begin
        took.append((many.seconds, alone))
    together, apart = np.median(np.array(took[WARM:]), axis=0).tolist()
    return float(together / apart)


def clear_balls(balls: int, seed: int) -> Crowd:
    """Balls that sway in two rows, none near another."""
    return Crowd([_swaying(number, balls) for number in range(balls)], FRAMES, seed)


def _swaying(number: int, balls: int) -> PositionFunction:
    column, row = divmod(number, 2)
    x = 0.72 * (column - ((balls + 1) // 2 - 1) / 2.0)

    def place(seconds: float) -> tuple[float, float, float]:
        return (
            x + 0.1 * math.sin(1.7 * seconds + number),
            (row - 0.5) * 1.2 + 0.2 * math.sin(seconds + 2.0 * number),
            2.8,
        )

    return place
