"""Tag systems, apart: they need a made target. Cards of side 2 r on the ball's path, over the same link."""

import math
from collections.abc import Iterator

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from benchmarks.contest.field import TAGS, missing, peer
from benchmarks.contest.run import follow_with_all
from benchmarks.options import Options
from benchmarks.peers.tags import CARDS, Card
from benchmarks.results import Figure, Finding, Section, table
from benchmarks.tracking.accuracy import figures, pooled
from benchmarks.tracking.trial import PRESETS, Trial, sequence
from benchmarks.workers import spread
from matchset.image.frame import Frame
from matchset.sim.analog_link import degrade
from matchset.sim.clips.clip import Clip
from matchset.sim.clips.truth import ClipTruth, mean_circle
from matchset.sim.rendering.shutter import fields

Picture = npt.NDArray[np.float32]
ROLL = math.radians(20.0)  # it swings to and fro by this much
FINE = 4  # samples of a pixel along x and along y
CARD_PX = 400


class TagClip(msgspec.Struct, frozen=True):
    """Frames and truths of a card that takes the place of a clip's ball.

    Parameters
    ----------
    clip : Clip
        Gives room, path, link and noise.
    card : Card
        What flies instead: a square whose inscribed circle is the truth's.
    """

    clip: Clip
    card: Card

    def __iter__(self) -> Iterator[tuple[Frame, ClipTruth]]:
        clip, room = self.clip, self.clip.background()
        tag = self.card.picture(CARD_PX).astype(np.float32)
        for index in range(clip.frames):
            picture = room.copy()
            circles = []
            for rows, time in fields(index, clip.link.interlaced):
                circle = clip._outline(time).circle()
                circles.append(circle)
                angle = ROLL * math.sin(0.08 * time + clip.seed)
                _draw(picture, tag, (circle.x, circle.y, circle.radius), angle, slice(rows.start, None, rows.step))
            image = degrade(picture, clip.link, clip.seed * 1_000_003 + index)
            seen = clip.truth(index)
            yield Frame(image, index / clip.fps, index), msgspec.structs.replace(seen, circle=mean_circle(circles))


def _draw(picture: Picture, tag: Picture, circle: tuple[float, float, float], angle: float, rows: slice) -> None:
    """Draw a card over some rows of a picture; every pixel is the mean of FINE x FINE samples of it."""
    x, y, radius = circle
    half = math.ceil(1.5 * radius) + 2
    left, top = math.floor(x) - half, math.floor(y) - half
    size, scale = 2 * half + 1, 2.0 * radius * FINE / tag.shape[0]
    # Softened first, so that the samples do not miss what lies between them.
    soft = cv2.GaussianBlur(tag, (0, 0), max(0.4 / scale, 0.1)) if scale < 1.0 else tag
    c, s = scale * math.cos(angle), scale * math.sin(angle)
    middle = (tag.shape[0] - 1) / 2.0
    u, v = (FINE * (place - corner) + (FINE - 1) / 2.0 for place, corner in ((x, left), (y, top)))
    to_fine = np.array([[c, -s, u - c * middle + s * middle], [s, c, v - s * middle - c * middle]])
    shape = (size * FINE, size * FINE)
    paint = cv2.resize(cv2.warpAffine(soft, to_fine, shape), (size, size), interpolation=cv2.INTER_AREA)
    cover = cv2.resize(cv2.warpAffine(np.ones_like(tag), to_fine, shape), (size, size), interpolation=cv2.INTER_AREA)
    height, width = picture.shape[:2]
    low, high = (max(top, 0), max(left, 0)), (min(top + size, height), min(left + size, width))
    inside = np.zeros((height, width), np.float32)
    full = np.zeros((height, width), np.float32)
    here = slice(low[0], high[0]), slice(low[1], high[1])
    there = slice(low[0] - top, high[0] - top), slice(low[1] - left, high[1] - left)
    inside[here], full[here] = cover[there], paint[there]
    part = inside[rows, :, np.newaxis]
    picture[rows] = picture[rows] * (1.0 - part) + full[rows, :, np.newaxis]


FRAMES, QUICK_FRAMES = 140, 40
SEEDS, QUICK_SEEDS = 2, 1

QUOTED = (
    ("WhyCon (its own ring)", "0.158 ms (minimum 0.016), full frame, tracking", "0.06 px, 100 % below 5 px"),
    ("ChromaTag (its authors' 7 photos, 752 × 480)", "0.60-0.95 ms", "7 of 7 decoded; not run on sequences"),
    ("RuneTag (ellipse stage only)", "25.6 ms (minimum 11.3)", "its decoder did not run"),
)


class Tagged(msgspec.Struct, frozen=True):
    """A card to be followed by a tag system."""

    peer: str
    name: str
    seed: int
    frames: int


def run_tags(heat: Tagged) -> Trial:
    """Follow a card."""
    clip = TagClip(sequence(heat.name, heat.seed, heat.frames), CARDS[heat.peer])
    return follow_with_all(iter(clip), None, [peer(heat.peer)], heat.seed)[heat.peer]


def run(options: Options) -> Section:
    """Follow the cards."""
    seeds = options.seeds[: QUICK_SEEDS if options.quick else SEEDS]
    frames = QUICK_FRAMES if options.quick else FRAMES
    keys = [key for key in TAGS if not missing(key)]
    heats = [Tagged(key, name, seed, frames) for key in keys for name in PRESETS for seed in seeds]
    trials = spread(run_tags, heats, options.jobs)
    rows, findings = [], []
    for key in keys:
        scores = {
            name: pooled([t for heat, t in zip(heats, trials, strict=True) if (heat.peer, heat.name) == (key, name)])
            for name in PRESETS
        }
        rows += [[f"{peer(key).name}, `{name}`", *(f.text for f in figures(score))] for name, score in scores.items()]
        means = tuple(Figure(name, score.mean_error_px, "px", 2) for name, score in scores.items())
        valid = tuple(Figure(f"{name}, valid", s.valid_percent, "%", 1) for name, s in scores.items())
        findings.append(Finding(name=f"tags_{key}", what=f"{peer(key).name} on its own cards", figures=means + valid))
    if not rows:
        return Section("Tag systems", [], "Not run: " + "; ".join(f"{key}: {missing(key)}" for key in TAGS))
    head = ["", *(figure.name for figure in figures(scores["clean"]))]
    text = (
        f"Seeds {', '.join(map(str, seeds))}, {frames} frames each; error of the circle inscribed in the card, whose "
        "side is 2 r and which rolls by ± 20 degrees. A tag tells who it is, a ball does not; a tag must be printed, "
        "be turned to the camera and be flat. Their times stand among the heavy ones.\n\n"
        + table(head, rows)
        + "\n**Quoted, from another run** (2026-11-21; 2 vCPU AMD EPYC, other work beside it; 300 synthetic frames of "
        "640 × 480, another renderer; not to be compared with the figures above to the second digit): these need "
        "programs that are not packaged\n\n" + table(["", "time per frame", "accuracy"], [list(row) for row in QUOTED])
    )
    return Section("Tag systems", findings, text)
