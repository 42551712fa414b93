"""Which frame of a video to look at, and which circle in it is the ball: `choose`.

Some frames, spread over the video, are searched for ball-like circles. A ball can be told from everything around it,
its color finds it again in the other frames, and there it has moved. What rests at one place is looked at once.
"""

import functools
import math
from collections.abc import Callable, Sequence

import msgspec
import numpy as np

from matchset.app.guidance.large_frames import reduced, rescaled
from matchset.app.guidance.separation import Separation, separate
from matchset.app.target.frame_picker import PARAMETERS as PICKER
from matchset.app.target.frame_picker import is_black, lit_frame_at
from matchset.image.candidates import Candidate, find_candidates
from matchset.image.circle_score import SCORE
from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.media.video import Video
from matchset.shapes.circle import Circle
from matchset.tracking.detection import detect


class BallChoiceParameters(msgspec.Struct, frozen=True):
    """How the ball is chosen among ball-like circles.

    Chosen by hand on four real clips; docs/log/search.md#learn-chooses has the figures of these
    and of five others.

    Parameters
    ----------
    samples : int
        Frames that are searched: more find a ball that is visible for a short time, and take longer.
    span : int
        Frames over which they are spread, so that a long video need not be read to its end.
    farthest : float
        While nothing convincing was found, as many times that span is searched.
    pixels : float
        Pixels of all searched frames together, which are held in memory.
    looked_at : int
        Circles that are compared with what is around them, those with the best scores first.
    tried : int
        Circles whose color is learned and looked for in the other frames.
    at_rest : float
        Distance within which circles of two frames are one thing at rest, in radii.
    resting : float
        Factor on the rank of what never moves; a lamp, a button, a knob.
    late : float
        What the last of the frames counts less than the first: `track` follows from the click on, and before it nothing
        but the color is known.
    unseen : float
        Share of frames that a circle counts as found in although its color finds nothing.
    """

    samples: int = 8
    span: int = 600
    farthest: float = 2.0
    pixels: float = 1e8
    looked_at: int = 24
    tried: int = 6
    at_rest: float = 0.5
    resting: float = 0.5
    late: float = 0.5
    unseen: float = 0.02


PARAMETERS = BallChoiceParameters()


class BallChoice(msgspec.Struct, frozen=True):
    """A frame and the ball-like circles in it.

    Parameters
    ----------
    frame : Frame
    candidates : list of Candidate
        The likeliest to be the ball first, each with the pixel to click at.
    rank : float
        How sure the first one is, 0 ... 1: its score, how clearly it is told from what is around it, and in which share
        of the frames it is found again, as one product. 0 where the frame was not chosen.
    """

    frame: Frame
    candidates: list[Candidate]
    rank: float = 0.0


class _Sample:
    """A frame, reduced, and its ball-like circles: they are looked for when they are asked for first."""

    def __init__(self, frame: Frame) -> None:
        self.frame = frame
        self._separations: dict[Candidate, Separation] = {}

    @functools.cached_property
    def circles(self) -> list[Candidate]:
        """Ball-like circles, the most ball-like first."""
        return find_candidates(self.frame.image)

    @property
    def score(self) -> float:
        """Score of the most ball-like circle, 0 where there is none."""
        return self.circles[0].score if self.circles else 0.0

    def separated(self, circle: Candidate) -> tuple[float, Candidate]:
        """Score of a circle times how clear it is, and the circle with the pixel at which it is clearest."""
        if circle not in self._separations:
            self._separations[circle] = separate(self.frame.image, circle)
        found = self._separations[circle]
        return circle.score * found.clearness, msgspec.structs.replace(circle, pick=found.pick)


def choose(video: Video, given: Frame | None = None) -> BallChoice:
    """Choose a frame, and order its ball-like circles.

    Parameters
    ----------
    video : Video
        Not yet read. Of a live source a frame is taken once the exposure has settled, and no other is looked at.
    given : Frame, optional
        The frame, if it is chosen already; the others say which of its circles is the ball. Without it the frame is
        that in which the ball is seen best, never a black one.

    Returns
    -------
    Choice
        The same for the same video.

    Raises
    ------
    ValueError
        If the video holds no frames but black ones.
    """
    if video.live:
        frame = lit_frame_at(video, PICKER.warm_up) if given is None else given
        return _in_full(_choice(_Sample(reduced(frame)), None), frame)
    whole: dict[int, Frame] = {}
    sampled = _samples(video, whole, given)
    if not sampled:
        raise ValueError("the video holds no frames but black ones")
    likeliest = _likeliest(sampled, None if given is None else given.index)
    if likeliest is None:
        return BallChoice(whole[sampled[0].frame.index] if given is None else given, [])
    rank, sample, best = likeliest
    return msgspec.structs.replace(_in_full(_choice(sample, best), whole[sample.frame.index]), rank=rank)


def _in_full(choice: BallChoice, frame: Frame) -> BallChoice:
    """Return a choice made in a reduced copy in the pixels of the frame."""
    return BallChoice(frame, [rescaled(each, choice.frame, frame) for each in choice.candidates])


def _samples(video: Video, whole: dict[int, Frame], given: Frame | None) -> list[_Sample]:
    """Frames spread over a video that are not black, reduced, and the given one; `whole` takes them as read."""
    wanted = min(max(int(PARAMETERS.pixels / (video.width * video.height)), 3), PARAMETERS.samples)
    step = max(1, min(video.length or PARAMETERS.span, PARAMETERS.span) // wanted)
    found: list[_Sample] = []
    for frame in video:
        beyond = frame.index > PARAMETERS.farthest * step * wanted
        if len(found) >= wanted and (beyond or _are_convincing(found, given)):
            break
        if frame.index % step or is_black(frame.image):
            if not found and beyond:
                break
            continue
        if len(found) >= wanted:
            scores = [each.score for each in found]
            worst = scores.index(min(scores))
            del whole[found[worst].frame.index], found[worst]
        whole[frame.index] = frame
        found.append(_Sample(reduced(frame)))
    if given is not None and all(each.frame.index != given.index for each in found):
        whole[given.index] = given
        found.append(_Sample(reduced(given)))
    return found


def _are_convincing(found: Sequence[_Sample], given: Frame | None) -> bool:
    """Whether one of the frames has a circle that is worth tracking.

    The given frame is looked at first: its circles are needed in any case, those of others perhaps not.
    """
    ordered = sorted(found, key=lambda each: given is None or each.frame.index != given.index)
    return any(each.score >= SCORE.convincing for each in ordered)


def _likeliest(sampled: Sequence[_Sample], index: int | None) -> tuple[float, _Sample, Candidate] | None:
    """Rank, frame and circle of the ball where it is seen best: in any frame, or in that of an index.

    A circle that cannot be better than the best so far is not looked for in the other frames: the answer is the same.
    """
    chosen = [each for each in sampled if index is None or each.frame.index == index]
    things = _things([(each, circle) for each in chosen for circle in each.circles])
    ranked = [(sample, *sample.separated(circle)) for sample, circle in things[: PARAMETERS.looked_at]]
    ranked.sort(key=lambda each: -each[1])
    last = max(each.frame.index for each in sampled)
    frames = [each.frame for each in sampled]
    best: tuple[float, _Sample, Candidate] | None = None
    for sample, clear, circle in ranked[: PARAMETERS.tried]:
        late = 1.0 - PARAMETERS.late * sample.frame.index / max(last, 1)
        most = -math.inf if best is None else best[0]
        share = _found_again(sample.frame, circle, frames, functools.partial(_beats, most, clear, late))
        if share is not None and _beats(most, clear, late, share):
            best = clear * share * late, sample, circle
    return best


def _beats(most: float, clear: float, late: float, share: float) -> bool:
    """Whether a circle, with the share of frames in which it is found again, is better than the best so far."""
    return clear * share * late > most


def _things(seen: list[tuple[_Sample, Candidate]]) -> list[tuple[_Sample, Candidate]]:
    """Circles with the best scores first, without those of other frames at the same place."""
    kept: list[tuple[_Sample, Candidate]] = []
    for sample, candidate in sorted(seen, key=lambda pair: -pair[1].score):
        near = PARAMETERS.at_rest * candidate.radius
        at_rest = (math.dist((candidate.x, candidate.y), (other.x, other.y)) < near for _, other in kept)
        if not any(at_rest):
            kept.append((sample, candidate))
    return kept


def _found_again(
    frame: Frame, candidate: Candidate, frames: Sequence[Frame], is_enough: Callable[[float], bool]
) -> float | None:
    """Share of the frames in which the color of a circle finds something; less for what never moves.

    None as soon as that cannot be enough anymore.
    """
    if not is_enough(1.0 + PARAMETERS.unseen):
        return None
    try:
        color = ColorModel.pick(frame.image, *candidate.pick)
    except ValueError:
        return 0.0
    places = list[tuple[float, float]]()
    for k, other in enumerate(frames):
        if not is_enough((len(places) + len(frames) - k) / len(frames) + PARAMETERS.unseen):
            return None
        found = detect(Frame(other.image, 0.0, 0), Circle, color, limit=1)
        places += [(found[0].shape.x, found[0].shape.y)] if found else []
    share = len(places) / len(frames) + PARAMETERS.unseen
    if not places:
        return share
    moved = float(np.hypot(*np.std(places, axis=0))) / candidate.radius
    return share if moved > PARAMETERS.at_rest else PARAMETERS.resting * share


def _choice(sample: _Sample, best: Candidate | None) -> BallChoice:
    """Order the circles of a frame: the one that was chosen, then those that are clearest."""
    ranked: list[tuple[float, Candidate]] = []
    for each in sample.circles:
        if best is not None and (each.x, each.y, each.radius) == (best.x, best.y, best.radius):
            ranked.append((math.inf, best))
        else:
            ranked.append(sample.separated(each))
    ranked.sort(key=lambda pair: -pair[0])
    return BallChoice(sample.frame, [each for _, each in ranked])
