"""Everybody on the same frames: `follow_with_all` follows one sequence with every peer, frame by frame."""

import functools
import itertools
from collections.abc import Iterable, Iterator
from typing import TypeVar

import msgspec

import matchset as ms
from benchmarks.common.start import Circle3, Start, Step
from benchmarks.contest.field import LIGHT, PAPER, PEERS, Peer, peer, present
from benchmarks.options import Options
from benchmarks.real.clips import Clip as RealClip
from benchmarks.tracking.trial import FPS, WHAT, Trial, as_truth, sequence
from benchmarks.workers import spread
from matchset.sim.clips.clip import Clip

T = TypeVar("T")
FRAMES, QUICK_FRAMES = 140, 80
SEEDS, QUICK_SEEDS = 2, 1
QUICK_PEERS = (*LIGHT, "hobby", "simple_blob", "edge_drawing", PAPER)
ELSEWHERE = 250  # seeds: the room where colors are learned for the sequence without a ball


class SequenceRun(msgspec.Struct, frozen=True):
    """A sequence to be followed by several peers: its name, seed and length, and their keys."""

    name: str
    seed: int
    frames: int
    peers: tuple[str, ...]


Results = dict[str, Trial]
"""What each peer made of a sequence, by its key."""
Answers = dict[str, dict[int, Circle3 | None]]
"""What each peer answered to each frame, by its key and the number of the frame."""


def results(options: Options) -> dict[str, list[Results]]:
    """Let everybody follow every sequence, once for each seed; asked again, the same is returned.

    Parameters
    ----------
    options : Options

    Returns
    -------
    dict of str to list of dict of str to Trial
        By sequence; for each seed by peer.
    """
    seeds = options.seeds[: QUICK_SEEDS if options.quick else SEEDS]
    keys = QUICK_PEERS if options.quick else PEERS
    return _results(keys, seeds, QUICK_FRAMES if options.quick else FRAMES, options.jobs)


@functools.cache
def _results(chosen: tuple[str, ...], seeds: tuple[int, ...], frames: int, jobs: int) -> dict[str, list[Results]]:
    keys = tuple(each.key for each in present(chosen))
    heats = [SequenceRun(name, seed, frames, keys) for name in WHAT for seed in seeds]
    done = spread(follow_sequence, heats, jobs)
    return {name: [r for heat, r in zip(heats, done, strict=True) if heat.name == name] for name in WHAT}


def follow_sequence(heat: SequenceRun) -> Results:
    """Follow the sequence of a heat with its peers."""
    peers = [peer(key) for key in heat.peers]
    clip = sequence(heat.name, heat.seed, heat.frames)
    if clip.ball:
        return follow_with_all(iter(clip), None, peers, heat.seed)
    return follow_with_all(iter(clip), elsewhere(clip), [each for each in peers if each.detects], heat.seed)


def elsewhere(clip: Clip) -> Start:
    """First frame of another sequence with a ball: what a color is learned from when there is none here."""
    other = sequence("typical", clip.seed + ELSEWHERE, 1)
    return first_sight(*next(iter(other)), here=False)


def first_sight(frame: ms.Frame, truth: object, here: bool = True) -> Start:
    """Make what everybody is told: the first frame and the circle in it."""
    circle = getattr(truth, "circle", None)
    if circle is None:
        raise ValueError(f"frame {frame.index} shows no ball to begin with")
    return Start(frame.image, (circle.x, circle.y, circle.radius), here)


def follow_with_all(
    frames: Iterator[tuple[ms.Frame, object]], start: Start | None, peers: Iterable[Peer], seed: int
) -> Results:
    """Give every frame to every peer and note the answers.

    Parameters
    ----------
    frames : iterator of (Frame, truth of the simulation)
        In order.
    start : Start or None
        What everybody is told; None: the first frame, which then counts as answered by nobody's merit and is left
        out.
    peers : iterable of Peer
    seed : int
        Of the sequence.

    Returns
    -------
    dict of str to Trial
    """
    if start is None:
        start = first_sight(*next(frames))
    steps, seen = {each.key: each.follow(start) for each in peers}, list[object]()
    answers = answers_of(steps, frames_of(frames, seen))
    truths = [as_truth(each) for each in seen]  # type: ignore[arg-type]
    return {key: Trial(seed, truths, [*found.values()], []) for key, found in answers.items()}


def frames_of(video: Iterable[tuple[ms.Frame, T]], truths: list[T]) -> Iterator[ms.Frame]:
    """Yield the frames of a video, and note the truth of each."""
    for frame, truth in video:
        truths.append(truth)
        yield frame


def answers_of(steps: dict[str, Step], frames: Iterable[ms.Frame]) -> Answers:
    """Give every frame to everybody, who has begun before it."""
    answers: Answers = {key: {} for key in steps}
    for frame in frames:
        for key, step in steps.items():
            answers[key][frame.index] = step(frame.image)
    return answers


def follow_real_clip(real: RealClip, peers: Iterable[Peer]) -> Answers:
    """Follow a real clip with every peer, from its first row with the ball well known.

    A peer that refuses its start answers nothing.

    Parameters
    ----------
    real : Clip
        From `benchmarks.real.clips`.
    peers : iterable of Peer

    Returns
    -------
    dict of str to dict of int to (x, y, radius) or None
        Answers by peer and frame.

    Raises
    ------
    ValueError
        If the video ends before that row.
    """
    first = real.tight[0]
    assert first.circle is not None
    video = ms.Video(real.video)
    frames = itertools.dropwhile(lambda frame: frame.index < first.frame, video)
    begin = next(frames, None)
    if begin is None:
        raise ValueError(f"{real.video} ends before frame {first.frame}, its first labelled row")
    start = Start(begin.image, first.circle, fps=video.fps or FPS)
    return answers_of({each.key: begun(each, start) for each in peers}, frames)


def begun(each: Peer, start: Start) -> Step:
    """Begin with a peer; one that refuses, since it cannot tell the color from the rest, answers nothing."""
    try:
        return each.follow(start)
    except ValueError:
        return lambda image: None  # noqa: ARG005
