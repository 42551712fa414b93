"""Which frame of a video to look at, and which circle in it is the ball: `choose`.

Some frames, spread over the video, are searched for ball-like circles. A ball can be told from everything around it,
its color finds it again in the other frames, and there it has moved. What rests at one place is looked at once.
"""

import math
from collections.abc import Sequence

import msgspec
import numpy as np

from matchset.app.guidance.large_frames import reduced, rescaled
from matchset.app.guidance.separation import separate
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
        small = reduced(frame)
        return _in_full(_choice(small, find_candidates(small.image), None), frame)
    whole: dict[int, Frame] = {}
    sampled = _samples(video, whole)
    if given is not None and all(frame.index != given.index for frame, _ in sampled):
        whole[given.index], small = given, reduced(given)
        sampled.append((small, find_candidates(small.image)))
    if not sampled:
        raise ValueError("the video holds no frames but black ones")
    likeliest = _likeliest(sampled, None if given is None else given.index)
    if likeliest is None:
        return BallChoice(whole[sampled[0][0].index] if given is None else given, [])
    rank, frame, best = likeliest
    chosen = _choice(frame, next(found for each, found in sampled if each is frame), best)
    return msgspec.structs.replace(_in_full(chosen, whole[frame.index]), rank=rank)


def _in_full(choice: BallChoice, frame: Frame) -> BallChoice:
    """Return a choice made in a reduced copy in the pixels of the frame."""
    return BallChoice(frame, [rescaled(each, choice.frame, frame) for each in choice.candidates])


def _samples(video: Video, whole: dict[int, Frame]) -> list[tuple[Frame, list[Candidate]]]:
    """Frames spread over a video that are not black, reduced, with their circles; `whole` takes them as read."""
    wanted = min(max(int(PARAMETERS.pixels / (video.width * video.height)), 3), PARAMETERS.samples)
    step = max(1, min(video.length or PARAMETERS.span, PARAMETERS.span) // wanted)
    found: list[tuple[Frame, list[Candidate]]] = []
    convincing = False
    for frame in video:
        if len(found) >= wanted and (convincing or frame.index > PARAMETERS.farthest * step * wanted):
            break
        if frame.index % step or is_black(frame.image):
            if not found and frame.index > PARAMETERS.farthest * step * wanted:
                break
            continue
        small = reduced(frame)
        circles = find_candidates(small.image)
        convincing |= bool(circles) and circles[0].score >= SCORE.convincing
        if len(found) >= wanted:
            scores = [each[0].score if each else 0.0 for _, each in found]
            worst = scores.index(min(scores))
            del whole[found[worst][0].index], found[worst]
        whole[frame.index] = frame
        found.append((small, circles))
    return found


def _likeliest(
    sampled: Sequence[tuple[Frame, list[Candidate]]], index: int | None
) -> tuple[float, Frame, Candidate] | None:
    """Rank, frame and circle of the ball where it is seen best: in any frame, or in that of an index."""
    things = _things([(frame, each) for frame, found in sampled for each in found], index)
    ranked: list[tuple[float, Frame, Candidate]] = []
    for frame, candidate in things[: PARAMETERS.looked_at]:
        separation = separate(frame.image, candidate)
        clicked = msgspec.structs.replace(candidate, pick=separation.pick)
        ranked.append((candidate.score * separation.clearness, frame, clicked))
    ranked.sort(key=lambda each: -each[0])
    last = max(frame.index for frame, _ in sampled)
    best: tuple[float, Frame, Candidate] | None = None
    for rank, frame, candidate in ranked[: PARAMETERS.tried]:
        total = rank * _found_again(frame, candidate, [each for each, _ in sampled])
        total *= 1.0 - PARAMETERS.late * frame.index / max(last, 1)
        if best is None or total > best[0]:
            best = total, frame, candidate
    return best


def _things(seen: list[tuple[Frame, Candidate]], index: int | None) -> list[tuple[Frame, Candidate]]:
    """Circles with the best scores first, without those of other frames at the same place."""
    kept: list[tuple[Frame, Candidate]] = []
    for frame, candidate in sorted(seen, key=lambda pair: -pair[1].score):
        if index is not None and frame.index != index:
            continue
        near = PARAMETERS.at_rest * candidate.radius
        at_rest = (math.dist((candidate.x, candidate.y), (other.x, other.y)) < near for _, other in kept)
        if not any(at_rest):
            kept.append((frame, candidate))
    return kept


def _found_again(frame: Frame, candidate: Candidate, frames: Sequence[Frame]) -> float:
    """Share of the frames in which the color of a circle finds something; less for what never moves."""
    try:
        color = ColorModel.pick(frame.image, *candidate.pick)
    except ValueError:
        return 0.0
    places = [
        (found[0].shape.x, found[0].shape.y)
        for other in frames
        if (found := detect(Frame(other.image, 0.0, 0), Circle, color, limit=1))
    ]
    share = len(places) / len(frames) + PARAMETERS.unseen
    if not places:
        return share
    moved = float(np.hypot(*np.std(places, axis=0))) / candidate.radius
    return share if moved > PARAMETERS.at_rest else PARAMETERS.resting * share


def _choice(frame: Frame, found: list[Candidate], best: Candidate | None) -> BallChoice:
    """Order the circles of a frame: the one that was chosen, then those that are clearest."""
    ranked: list[tuple[float, Candidate]] = []
    for each in found:
        if best is not None and (each.x, each.y, each.radius) == (best.x, best.y, best.radius):
            ranked.append((math.inf, best))
            continue
        separation = separate(frame.image, each)
        ranked.append((each.score * separation.clearness, msgspec.structs.replace(each, pick=separation.pick)))
    ranked.sort(key=lambda pair: -pair[0])
    return BallChoice(frame, [each for _, each in ranked])
