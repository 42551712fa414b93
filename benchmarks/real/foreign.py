"""Does it see a ball where another one is: the color of one clip, searched for in frames of the others.

Two clips count as foreign to each other if their balls differ by more than `DIFFERENT` in chroma and by more than
`TURNED` in hue. Other videos below `stills` show no ball at all and are foreign to every clip.
"""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

import cv2
import msgspec
import numpy as np

import matchset as ms
from benchmarks.common.start import Image
from benchmarks.options import Options
from benchmarks.real.clips import Clip
from benchmarks.results import Figure, Finding, Goal, table
from benchmarks.tracking.trial import circle
from benchmarks.workers import spread
from matchset.app.track.score import Circle3
from matchset.image.color_learning import chroma

DIFFERENT = 0.15
"""Chroma distance that two colors must exceed: 2.5 times the widest smoothing that a color model gives its target's
density (`ColorParameters.widest`, 0.06); of a Gaussian 4 % of the peak are left there."""
TURNED = 30.0
"""Degrees of hue in CIELAB that they must exceed too: one painted ball spreads over 15 in four clips (127 to 142). A
pale and a saturated green differ in chroma, and yet a ball of the one is a ball of the other's color."""
INNER = 0.6  # radii: away from a blurred rim
FRAMES, QUICK_FRAMES = 4_000, 200
SHOWN = 3  # pictures of a pair at most
BAR = (Goal("false per 1,000", high=1.0),)
PURPLE = (190, 40, 255)


class Ball(msgspec.Struct, frozen=True):
    """The color of a clip's ball.

    Parameters
    ----------
    chroma : tuple of 2 floats
        u and v of its median color, see `matchset.image.color_learning.chroma`.
    hue : float
        Angle of that color in the plane of CIELAB's a and b, degrees.
    color : ColorModel
        From the standard click.
    """

    chroma: tuple[float, float]
    hue: float
    color: ms.ColorModel


class Hunt(msgspec.Struct, frozen=True):
    """A video, the colors to be sought in it, and how many of its frames to search.

    Parameters
    ----------
    name : str
    video : Path
    length : int
        Its frames.
    colors : dict of str to ColorModel
        By the name of the clip they come from.
    frames : int
        How many to search, spread evenly; not more than there are.
    pictures : Path or None
        Folder for pictures of false locks.
    """

    name: str
    video: Path
    length: int
    colors: dict[str, ms.ColorModel]
    frames: int
    pictures: Path | None = None


class Tally(msgspec.Struct, frozen=True):
    """A color, a video that does not show it, how many frames were searched, and those that were answered."""

    color: str
    video: str
    searched: int
    false: list[int]


def count_false_locks(
    clips: Sequence[Clip], balls: Mapping[str, Ball], data: Path | None, options: Options, searches: int | None = None
) -> list[Tally]:
    """Search for every color in all that is foreign to it.

    Parameters
    ----------
    clips : sequence of Clip
    balls : mapping of str to Ball
        By clip; clips without a color are missing.
    data : Path or None
        Its folder `stills` holds videos without any ball.
    options : Options
    searches : int, optional
        How many, about; as many as `options` asks for.

    Returns
    -------
    list of Tally
    """
    hunts = [_hunt(clip.name, clip.video, foreign_to(clip.name, balls)) for clip in clips if clip.name in balls]
    if data is not None:
        every = {name: ball.color for name, ball in balls.items()}
        hunts += [_hunt(video.stem, video, every) for video in sorted(data.glob("stills/*.mp4"))]
    hunts = [hunt for hunt in hunts if hunt.colors]
    wanted = searches or (QUICK_FRAMES if options.quick else FRAMES)
    share = frames_each([(hunt.length, len(hunt.colors)) for hunt in hunts], wanted)
    if options.false_frames is not None:
        options.false_frames.mkdir(parents=True, exist_ok=True)
    tasks = [msgspec.structs.replace(hunt, frames=share, pictures=options.false_frames) for hunt in hunts]
    return [tally for tallies in spread(search, tasks, options.jobs) for tally in tallies]


def foreign_to(name: str, balls: Mapping[str, Ball]) -> dict[str, ms.ColorModel]:
    """Colors of the other clips' balls that differ from this clip's ball."""
    return {other: ball.color for other, ball in balls.items() if differ(balls[name], ball)}


def differ(one: Ball, other: Ball) -> bool:
    """Say whether two balls differ in color so much that neither should be taken for the other."""
    turned = abs((one.hue - other.hue + 180.0) % 360.0 - 180.0)
    return math.dist(one.chroma, other.chroma) > DIFFERENT and turned > TURNED


def ball_of(image: Image, disc: Circle3, color: ms.ColorModel) -> Ball:
    """Take the median color of the middle of a disc.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3), uint8
    disc : (x, y, radius)
        Where the ball is, px.
    color : ColorModel
        As it was learned.

    Returns
    -------
    Ball
    """
    x, y, radius = disc
    rows, columns = np.indices(image.shape[:2])
    inside = image[np.hypot(columns - x, rows - y) < max(INNER * radius, 1.0)]
    middle = np.median(inside, axis=0).astype(np.float32).reshape(1, 1, 3)
    u, v, _ = chroma(middle)[0, 0].tolist()
    _, a, b = cv2.cvtColor(middle / np.float32(255.0), cv2.COLOR_BGR2LAB)[0, 0].tolist()
    return Ball((u, v), math.degrees(math.atan2(b, a)), color)


def frames_each(lengths: Sequence[tuple[int, int]], wanted: int) -> int:
    """Least number of frames of each video, so that all searches together are as many as wanted.

    Parameters
    ----------
    lengths : sequence of (int, int)
        Frames of each video, and how many colors are sought in it.
    wanted : int
        How many searches; fewer if all frames are not enough.

    Returns
    -------
    int
    """
    most = max((length for length, _ in lengths), default=0)
    return next(
        (n for n in range(most) if sum(min(n, length) * colors for length, colors in lengths) >= wanted),
        most,
    )


def search(hunt: Hunt) -> list[Tally]:
    """Let one tracker for each color look at the frames of a hunt, none of them told where to begin."""
    trackers = {name: ms.Tracker(ms.Circle, color) for name, color in hunt.colors.items()}
    false: dict[str, list[int]] = {name: [] for name in trackers}
    chosen = {k * hunt.length // hunt.frames for k in range(hunt.frames)} if hunt.frames < hunt.length else None
    searched = 0
    with ms.Video(hunt.video) as video:
        for frame in video:
            if chosen is not None and frame.index not in chosen:
                continue
            searched += 1
            for name, tracker in trackers.items():
                answer = tracker.update(frame)
                if isinstance(answer, ms.Track):
                    false[name].append(frame.index)
                    if hunt.pictures is not None and len(false[name]) <= SHOWN:
                        _save(frame, answer, hunt.pictures / f"{name}_in_{hunt.name}_{frame.index:05d}.png")
    return [Tally(name, hunt.name, searched, frames) for name, frames in false.items()]


def foreign_finding(tallies: Sequence[Tally]) -> Finding:
    """Hold the false answers against the goal."""
    searched = sum(tally.searched for tally in tallies)
    if not searched:
        return Finding(name="real_false_locks", what="false locks on real frames: no two colors differ", figures=())
    total = sum(len(tally.false) for tally in tallies)
    return Finding(
        name="real_false_locks",
        what=f"false locks in {searched:,} searches of real frames that do not show a ball of this color",
        figures=(
            Figure("false per 1,000", 1000.0 * total / searched, "", 1),
            Figure("false locks", total, "", 0),
            Figure("pairs with one", sum(bool(tally.false) for tally in tallies), "", 0, aside=True),
        ),
        bar=BAR,
    )


def foreign_table(tallies: Sequence[Tally]) -> str:
    """Write the pairs with false locks as a table, and sums by color."""
    rows = []
    for color in sorted({tally.color for tally in tallies}):
        own = [tally for tally in tallies if tally.color == color]
        bad = ", ".join(f"{tally.video} {len(tally.false)} (first: {tally.false[0]})" for tally in own if tally.false)
        false = sum(len(tally.false) for tally in own)
        rows.append([color, str(len(own)), str(sum(tally.searched for tally in own)), str(false), bad or "-"])
    return table(["color of", "videos", "searches", "false locks", "where"], rows)


def _hunt(name: str, video: Path, colors: dict[str, ms.ColorModel]) -> Hunt:
    with ms.Video(video) as frames:
        return Hunt(name, video, frames.length or 0, colors, 0)


def _save(frame: ms.Frame, answer: ms.Track[ms.Circle], path: Path) -> None:
    x, y, radius = circle(answer.shape)
    picture = frame.image.copy()
    cv2.circle(picture, (round(x), round(y)), round(radius), PURPLE, 2, cv2.LINE_AA)
    cv2.imwrite(str(path), picture)
