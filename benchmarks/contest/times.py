"""Who is how fast: every peer and matchset on the same frames, by turns, on one thread."""

import functools
from collections.abc import Callable, Iterable
from typing import Any

import msgspec

import matchset as ms
from benchmarks.common.start import Start
from benchmarks.contest.field import HEAVY, LIGHT, OURS, RIVAL, TAGS, Peer, peer, present
from benchmarks.contest.run import compete, first_sight
from benchmarks.contest.tag_pictures import TagClip
from benchmarks.options import Options
from benchmarks.peers.tags import CARDS
from benchmarks.peers.visp import Visp
from benchmarks.tracking.accuracy import pooled
from benchmarks.tracking.contenders import convert
from benchmarks.tracking.sequences import sequence
from benchmarks.tracking.stopwatch import Contender, Times, duel
from matchset.sim.clips.clip import Clip

Result = dict[str, Times]

FRAMES, QUICK_FRAMES = 100, 40
RADII = (20, 40, 60, 80, 100, 120)
SIZES = ((320, 240), (640, 480), (1280, 960), (1920, 1080), (3840, 2160))
RADIUS_PX = 60.0
CONVERSION = "cvtColor + inRange"
SHARP = {"low": 0.6, "slack": 80, "opening": 0, "reach": 1.25, "margin": 12.0}
SCALED = (OURS, "region_bgr", "region_moments", "contour_moments", "visp_ellipse", "edge_drawing", "hough_gradient")
"""Those whose time is taken against the radius and against the size of the picture."""


class Pool(msgspec.Struct, frozen=True):
    """Frames after the first, and what everybody is told about the first."""

    start: Start
    frames: list[ms.Frame]

    @classmethod
    def render(cls, clip: Clip | TagClip) -> "Pool":
        """Render a clip."""
        pairs = list(clip)
        return cls(first_sight(*pairs[0]), [frame for frame, _ in pairs[1:]])


def everybody(options: Options) -> tuple[Result, Result]:
    """Time the light peers among themselves and the heavy ones among themselves, matchset in both.

    Returns
    -------
    light, heavy : dict of str to Times
        By the key of the peer.
    """
    return _everybody(options.seeds[0], options.quick)


@functools.cache
def _everybody(seed: int, quick: bool) -> tuple[Result, Result]:
    frames = QUICK_FRAMES if quick else FRAMES
    clip = sequence("typical", seed, frames + 1, shrink_to=20.0)
    pool = Pool.render(clip)
    light = duel([*contenders(present(LIGHT), pool), convert(CONVERSION, pool.frames, 0)], laps=2 if quick else 8)
    short = Pool(pool.start, pool.frames[: frames // 2])
    heavy = contenders([peer(OURS), *present(HEAVY)], short)
    for each in present(TAGS):
        tags = Pool.render(TagClip(sequence("typical", seed, frames // 2 + 1, shrink_to=40.0), CARDS[each.key]))
        heavy += contenders([each], tags)
    return light, duel(heavy, laps=1 if quick else 2, warm_up=3)


def against_radius(options: Options) -> dict[int, Result]:
    """Time some of them on balls of fixed radii, `typical`."""
    count = 20 if options.quick else 60
    results = {}
    for radius in RADII:
        fixed = (float(radius), float(radius))
        pool = Pool.render(sequence("typical", options.seeds[0], count + 1, radii=fixed))
        results[radius] = _scaled(pool, laps=3 if options.quick else 8)
    return results


def head_to_head(options: Options) -> tuple[dict[int, Result], float]:
    """Time matchset, its strongest everyday rival and the conversion, nobody else, on balls of fixed radii.

    The frames are `clean` and the rival's color range is one for such frames: over a link it drifts into the
    background, and what a region costs that has lost the ball says nothing.

    Returns
    -------
    results : dict of int to dict of str to Times
        By radius.
    valid : float
        Frames in which the rival's error was below 5 px, %, where it did worst.
    """
    count = 20 if options.quick else 60
    results, valid = {}, 100.0
    for radius in RADII:
        clip = sharp_clip(options.seeds[0], float(radius), count + 1)
        pool = Pool.render(clip)
        both = contenders([peer(OURS), sharp_rival()], pool)
        results[radius] = duel([*both, convert(CONVERSION, pool.frames, 0)], laps=5 if options.quick else 20)
        score = pooled([compete(iter(clip), None, [sharp_rival()], clip.seed)[RIVAL]])
        valid = min(valid, score.valid_percent or 0.0)
    return results, valid


def sharp_clip(seed: int, radius: float, frames: int) -> Clip:
    """Build the sequence on which the strongest everyday rival is timed: `clean`, the radius fixed."""
    return sequence("clean", seed, frames, radii=(radius, radius))


def sharp_rival() -> Peer:
    """Return the strongest everyday rival with a color range for `clean` frames."""
    rival = peer(RIVAL)
    return msgspec.structs.replace(rival, parameters=type(rival.parameters)(**SHARP))


def against_size(options: Options) -> dict[tuple[int, int], Result]:
    """Time some of them on pictures of several sizes, the ball as large in each, `clean`."""
    results = {}
    for width, height in SIZES[: 3 if options.quick else None]:
        count = max(min(20_000_000 // (width * height), 60), 6)
        fixed = (RADIUS_PX, RADIUS_PX)
        clip = sequence("clean", options.seeds[0], count + 1, width=width, height=height, radii=fixed)
        results[width, height] = _scaled(Pool.render(clip), laps=max(240 // count, 2))
    return results


def _scaled(pool: Pool, laps: int) -> Result:
    """Time the light ones often and the heavy ones once."""
    chosen = present(SCALED)
    light = contenders([each for each in chosen if each.key in LIGHT], pool)
    few = Pool(pool.start, pool.frames[:10])
    heavy = contenders([each for each in chosen if each.key not in LIGHT], few)
    return duel([*light, convert(CONVERSION, pool.frames, 0)], laps) | duel(heavy, 1, warm_up=2)


def contenders(peers: Iterable[Peer], pool: Pool) -> list[Contender]:
    """Turn peers into contenders; each begins anew at the first frame with each turn through the pool."""
    return [
        Contender(
            name=each.key,
            frames=pool.frames,
            begin=_begin(each, pool.start),
            idle=_pipe_ns if each.key.startswith("visp") else int,
        )
        for each in peers
    ]


def _pipe_ns() -> int:
    return Visp.idle_ns


def _begin(one: Peer, start: Start) -> Callable[[], Callable[[ms.Frame], Any]]:
    def begin() -> Callable[[ms.Frame], Any]:
        step = one.follow(start)
        return lambda frame: step(frame.image)

    return begin
