"""The pictures of the bench with where the ball is in each: `rendered`, `random_videos`, `real`."""

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

import matchset as ms
from benchmarks.clicks.scenes import KINDS, Bytes, Circle3, draw
from benchmarks.random_videos.following import photographs_in
from benchmarks.random_videos.video import VideoParameters, frames
from benchmarks.real.clips import find_clips
from benchmarks.real.starts import beginnings


class Shown(NamedTuple):
    """A picture of a group, its name, the ball in it and a spot printed on that, px."""

    group: str
    name: str
    image: Bytes
    circle: Circle3
    spot: Circle3 | None = None


def rendered(seeds: Iterable[int]) -> Iterator[Shown]:
    """Draw each kind of scene with each seed."""
    for kind in KINDS:
        for seed in seeds:
            yield Shown(kind, f"{kind} {seed}", *draw(kind, seed))


def random_videos(folder: Path, seeds: Iterable[int]) -> Iterator[Shown]:
    """Draw the first picture of random videos before photographs of a folder."""
    for seed in seeds:
        frame, truth = next(frames(seed, photographs_in(folder), VideoParameters()))
        if truth.circle is not None:
            yield Shown("random video", str(seed), frame.image, truth.circle)


def real(data: Path) -> Iterator[Shown]:
    """Read the three pictures of each labelled clip at which it is clicked (`benchmarks.real.starts`)."""
    for clip in find_clips(data)[0]:
        rows = {row.frame: row for row in beginnings(clip)}
        with ms.Video(clip.video) as video:
            for frame in video:
                row = rows.pop(frame.index, None)
                if row is not None and row.circle is not None:
                    yield Shown(clip.name, f"{clip.name} {frame.index}", frame.image, row.circle)
                if not rows:
                    break
