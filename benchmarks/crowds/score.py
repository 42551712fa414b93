"""Who kept which name: as a user counts it, HOTA and IDF1 by TrackEval, and what only the truth tells: `Score`."""

import contextlib
import io
import math
from collections import Counter
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.optimize import linear_sum_assignment
from scipy.sparse import csr_array
from scipy.sparse.csgraph import maximum_bipartite_matching

import matchset as ms
from benchmarks.crowds.crowd import MIN_VISIBLE, Seen, shared_area

CLEAR = 0.9  # share of its disc from which a ball is clear
MIN_IOU = 0.5  # of two discs, from which an answer is of a ball; HOTA takes the mean over its own limits
NEAR, NEAR_SHARE = (
    10.0,
    0.5,
)  # px and of the radius, the larger one: so near to a center, a user takes an answer for right
CLOSE = 0.5  # px, of an answer that is exact
SEEN_WEIGHT, NAME_WEIGHT = 100.0, 10.0  # for a ball that counts, and for its last name, beside 0 ... 1 for nearness


class Answer(NamedTuple):
    """What a tracker says of a frame: its name of a ball, and where that is."""

    identity: int
    circle: ms.Circle


class Score(NamedTuple):
    """How well names were kept.

    Parameters
    ----------
    mota : float
        1 less the missed, the false and the renamed, over the balls that count; may be negative. As a user counts: by
        centers, `NEAR` px or `NEAR_SHARE` of the radius apart.
    recall : float
        Share of the balls that count that are answered so near.
    renamed : int
        How often a ball that is answered so near got another name than the last time.
    close : float
        Share of the balls that count that are answered within `CLOSE` px, by the first name that they got.
    hota, idf1 : float
        0 ... 1.
    switches : int
        How often a ball got another name by TrackEval, which goes by what discs share.
    names : int
        Names that were given.
    doubled : int
        Answers on balls beyond one for each ball of a frame: two targets on one ball.
    missed, false : float
        Shares of the balls that count without an answer, and of the answers without a ball.
    """

    mota: float
    recall: float
    renamed: int
    close: float
    hota: float
    idf1: float
    switches: int
    names: int
    doubled: int
    missed: float
    false: float


def iou(one: ms.Circle, other: ms.Circle) -> float:
    """Area that two discs share, over the area that they cover."""
    shared = shared_area(one.radius, other.radius, math.hypot(one.x - other.x, one.y - other.y))
    a, b = one.radius, other.radius
    return shared / (math.pi * (a * a + b * b) - shared)


def names_kept(truth: Iterable[list[Seen]], answers: Iterable[list[Answer]], frames: int = 20) -> bool:
    """Whether every ball is called at the end what it was called at the beginning, and nothing else is.

    Parameters
    ----------
    truth, answers : iterable of list
        As of `score`.
    frames : int
        Length of the beginning and of the end, in frames in which all balls are clear; the name of a ball there is that
        of most answers that lie on it.
    """
    pairs = [pair for pair in zip(truth, answers, strict=True) if all(each.visible > CLEAR for each in pair[0])]
    first, last = _called(pairs[:frames]), _called(pairs[-frames:])
    return None not in first.values() and len(set(first.values())) == len(first) and first == last


def _called(pairs: Iterable[tuple[list[Seen], list[Answer]]]) -> dict[int, int | None]:
    """Find the name that each ball has in most frames; None where it has none."""
    counts: dict[int, Counter[int | None]] = {}
    for seen, said in pairs:
        for ball in seen:
            best = max(said, key=lambda answer: iou(ball.circle, answer.circle), default=None)
            met = best is not None and iou(ball.circle, best.circle) > MIN_IOU
            counts.setdefault(ball.identity, Counter())[best.identity if met and best is not None else None] += 1
    return {ball: names.most_common(1)[0][0] for ball, names in counts.items()}


def score(truth: Iterable[list[Seen]], answers: Iterable[list[Answer]]) -> Score:
    """Compare answers with the truth, frame by frame.

    Answers on balls that are hidden more than `MIN_VISIBLE` allows count neither for nor against.
    """
    with contextlib.redirect_stdout(io.StringIO()):  # it prints which of its data sets cannot be read
        from trackeval.metrics import CLEAR, HOTA, Identity

    pairs = list(zip(truth, answers, strict=True))
    frames = [_frame(seen, said) for seen, said in pairs]
    balls = sorted({name for balls, _, _ in frames for name in balls})
    names = sorted({name for _, names, _ in frames for name in names})
    data = {
        "num_timesteps": len(frames),
        "num_gt_ids": len(balls),
        "num_tracker_ids": len(names),
        "num_gt_dets": sum(len(balls) for balls, _, _ in frames),
        "num_tracker_dets": sum(len(names) for _, names, _ in frames),
        "gt_ids": [np.array([balls.index(name) for name in there], int) for there, _, _ in frames],
        "tracker_ids": [np.array([names.index(name) for name in said], int) for _, said, _ in frames],
        "similarity_scores": [overlaps for _, _, overlaps in frames],
    }
    quiet = {"PRINT_CONFIG": False}
    hota, clear, identity = (each.eval_sequence(data) for each in (HOTA(), CLEAR(quiet), Identity(quiet)))
    mota, recall, renamed, close = counted(pairs)
    return Score(
        mota=mota,
        recall=recall,
        renamed=renamed,
        close=close,
        hota=float(np.mean(hota["HOTA"])),
        idf1=float(identity["IDF1"]),
        switches=int(clear["IDSW"]),
        names=len({answer.identity for _, said in pairs for answer in said}),
        doubled=sum(_doubled(seen, said) for seen, said in pairs),
        missed=float(clear["CLR_FN"] / max(sum(len(balls) for balls, _, _ in frames), 1)),
        false=float(clear["CLR_FP"] / max(sum(len(names) for _, names, _ in frames), 1)),
    )


def counted(pairs: Iterable[tuple[list[Seen], list[Answer]]]) -> tuple[float, float, int, float]:
    """Count as a user does: by centers, a row for each ball that can be seen.

    Parameters
    ----------
    pairs : iterable of (list of Seen, list of Answer)
        Truth and answers of each frame.

    Returns
    -------
    mota, recall : float
    renamed : int
    close : float
    """
    first: dict[int, int] = {}
    last: dict[int, int] = {}
    balls = right = false = renamed = close = 0
    for seen, said in pairs:
        balls += sum(each.visible >= MIN_VISIBLE for each in seen)
        given = met(seen, said, last)
        false += len(said) - len(given)
        for ball, answer in given:
            if ball.visible < MIN_VISIBLE:
                continue
            right += 1
            renamed += last.get(ball.identity, answer.identity) != answer.identity
            last[ball.identity] = answer.identity
            own = first.setdefault(ball.identity, answer.identity) == answer.identity
            close += own and _apart(ball, answer) < CLOSE
    most = max(balls, 1)
    return 1.0 - (balls - right + false + renamed) / most, right / most, renamed, close / most


def met(seen: list[Seen], said: list[Answer], last: dict[int, int]) -> list[tuple[Seen, Answer]]:
    """Give answers to balls of a frame: to those that count first, then by their last names, then the nearest."""
    gains = np.zeros((len(seen), len(said)))
    for row, ball in enumerate(seen):
        limit = max(NEAR, NEAR_SHARE * ball.circle.radius)
        for column, answer in enumerate(said):
            far = _apart(ball, answer)
            if far < limit:
                gains[row, column] = 1.0 - far / limit
                gains[row, column] += SEEN_WEIGHT * (ball.visible >= MIN_VISIBLE)
                gains[row, column] += NAME_WEIGHT * (last.get(ball.identity) == answer.identity)
    chosen = zip(*linear_sum_assignment(gains, maximize=True), strict=True)
    return [(seen[row], said[column]) for row, column in chosen if gains[row, column] > 0.0]


def _apart(ball: Seen, answer: Answer) -> float:
    return math.hypot(ball.circle.x - answer.circle.x, ball.circle.y - answer.circle.y)


def _doubled(seen: list[Seen], said: list[Answer]) -> int:
    """How many answers lie on balls, hidden ones too, beyond one for each ball."""
    on = np.array([[iou(ball.circle, answer.circle) > MIN_IOU for ball in seen] for answer in said], bool)
    on = on.reshape(len(said), len(seen))
    single = maximum_bipartite_matching(csr_array(on), perm_type="column")
    return int(on.any(axis=1).sum() - (single >= 0).sum())


def _frame(seen: list[Seen], said: list[Answer]) -> tuple[list[int], list[int], npt.NDArray[np.float64]]:
    """Balls and names of a frame that count, and how far each two of them are the same.

    Answers are first given to all balls, hidden ones too, as in the MOT challenge; those of hidden balls do not count,
    nor do others that lie on hidden balls alone.
    """
    overlaps = np.array([[iou(ball.circle, answer.circle) for answer in said] for ball in seen])
    overlaps = overlaps.reshape(len(seen), len(said))
    overlaps[overlaps <= MIN_IOU] *= 1e-3  # beside whatever is a match
    counts = np.array([ball.visible >= MIN_VISIBLE for ball in seen], bool)
    met = overlaps > MIN_IOU
    kept = met[counts].any(axis=0) | ~met[~counts].any(axis=0)
    for ball, answer in zip(*linear_sum_assignment(overlaps, maximize=True), strict=True):
        kept[answer] &= counts[ball] or not met[ball, answer]
    counted = [each for each in seen if each.visible >= MIN_VISIBLE]
    left = [each for each, stays in zip(said, kept, strict=True) if stays]
    shared = np.array([[iou(ball.circle, answer.circle) for answer in left] for ball in counted])
    names = [each.identity for each in left]
    return [each.identity for each in counted], names, shared.reshape(len(counted), len(left))
