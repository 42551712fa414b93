"""A long video in one and in stretches for two workers: `measure_split`."""

import csv
import math
import shutil
from pathlib import Path

import msgspec

from benchmarks.batch.batches import Work
from benchmarks.batch.load import Others
from benchmarks.batch.videos import Videos
from matchset.batch.results.store import RUN
from matchset.batch.workers.processes import Processes

SHAPE = "x", "y", "radius"
FAR = 0.1  # px: farther apart than this is told for itself


class Differences(msgspec.Struct, frozen=True):
    """Rows of one table against those of another.

    Parameters
    ----------
    rows : int
    bytes : int
        Rows that are not the same text.
    numbers : int
        Whose frame, time, found flag or identity differ; with rows that only one of both has.
    sigma : int
        Whose x, y or radius differ by more than one standard deviation of the row.
    far : int
        Whose center differs by more than `FAR`.
    most : float
        Largest distance of two centers, px.
    """

    rows: int
    bytes: int
    numbers: int
    sigma: int
    far: int
    most: float


class Split(msgspec.Struct, frozen=True):
    """What was measured.

    Parameters
    ----------
    minutes : float
        Length of the video.
    stretch : float
        Of a stretch, s.
    words : str
        What the batch says of the joined table.
    whole, split : float
        By one and by two workers, s.
    tasks : float
        Sum of the stretches' times, s.
    differences : Differences
    others : float or None
        Share of the processors that other programs used.
    seconds : float
    """

    minutes: float
    stretch: float
    words: str
    whole: float
    split: float
    tasks: float
    differences: Differences
    others: float | None
    seconds: float


def measure_split(video: Videos, few: Videos, out: Path, minutes: float, stretch: float) -> Split:
    """Follow a long video in one, and in stretches by two workers that are warm.

    Parameters
    ----------
    video : Videos
        The long one.
    few : Videos
        What workers follow before.
    out : Path
    minutes : float
        Its length.
    stretch : float
        Of a stretch, s.
    """
    shutil.rmtree(out, ignore_errors=True)
    warm = Work(msgspec.structs.replace(few, paths=few.paths[:4]), out / "few")
    whole, parts = Work(video, out / "whole"), Work(video, out / "split", stretch)
    with Processes(2) as pool, Others() as others:
        warm.run(pool)
        one, two = whole.run(pool), parts.run(pool)
    (name,) = (path.name for path in video.paths)
    tables = [_table(each.out / name / "tracks.csv") for each in (whole, parts)]
    words = str(msgspec.json.decode((parts.out / name / RUN).read_bytes())["reason"])
    found = differences(*tables)
    figures = one.seconds, two.seconds, sum(two.tasks), found
    return Split(minutes, stretch, words, *figures, others.share, round(others.seconds, 1))


def differences(one: list[dict[str, str]], other: list[dict[str, str]]) -> Differences:
    """Compare two tables of `track`."""
    bytes_, numbers, sigma, far, most = 0, abs(len(one) - len(other)), 0, 0, 0.0
    for a, b in zip(one, other, strict=False):
        bytes_ += a != b
        if any(a.get(name) != b.get(name) for name in ("frame", "time", "found", "identity")):
            numbers += 1
        elif a["found"] == "1":
            apart = {name: abs(float(a[name]) - float(b[name])) for name in SHAPE}
            sigma += any(value > float(a[f"{name}_std"]) for name, value in apart.items())
            distance = math.hypot(apart["x"], apart["y"])
            far, most = far + (distance > FAR), max(most, distance)
    return Differences(max(len(one), len(other)), bytes_, numbers, sigma, far, most)


def _table(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8", newline="") as text:
        return list(csv.DictReader(text))
