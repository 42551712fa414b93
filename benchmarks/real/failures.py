"""Where a run on a real clip failed, and why: `python -m benchmarks.real.failures CLIP --data DIR`.

For every tight row that is not valid, and every answer where the ball is absent: the truth, the answer or the reason
of the loss, the last frame with an answer, what a search and a fit at the true place give and which rules refuse them,
and an enlarged crop with the truth in green and the answer in red, the color's scores beside it. `--every` shows all
labelled rows.
"""

from pathlib import Path
from typing import Annotated

import cv2
import msgspec
import numpy as np
import typer

import matchset as ms
from benchmarks.common.start import Image
from benchmarks.real.clips import Clip, find_clips
from benchmarks.real.following import Answer, Follower, follow
from benchmarks.real.gates import examine, score_picture
from benchmarks.real.starts import BEGINNINGS, CLICKS, beginnings, start_at
from benchmarks.tracking.trial import circle
from benchmarks.workers import one_thread
from matchset.app.track.score import VALID_BELOW_PX, Circle3, TruthRow, error_px

HERE = Path(__file__).resolve().parent
GREEN, RED = (60, 220, 60), (40, 40, 255)
AROUND = 2.5  # radii from the center to the border of a crop
SIDE = 480  # px of a crop, once enlarged
FINE = 4  # bits of a pixel's fraction when circles are drawn


class Look(msgspec.Struct, frozen=True):
    """A labelled row and what the tracker said to it.

    Parameters
    ----------
    truth : TruthRow
    answer : (x, y, radius) or None
    reason : str
        Of the loss; empty where there is an answer.
    last : int or None
        The last frame up to here with an answer.
    evidence : list of str
        What is found at the true place, see `gates.examine`.
    """

    truth: TruthRow
    answer: Circle3 | None
    reason: str
    last: int | None
    evidence: list[str]

    @property
    def error(self) -> float | None:
        """Error of the answer, Eq. 10, px."""
        return error_px(self.answer, self.truth.circle) if self.answer and self.truth.circle else None

    @property
    def failed(self) -> bool:
        """A tight row that is not valid, or an answer where the ball is absent."""
        if self.truth.circle is None:
            return self.answer is not None
        return self.truth.tight and (self.error is None or not self.error < VALID_BELOW_PX)


def main(
    clip: Annotated[str, typer.Argument(help="Name of the clip.")],
    data: Annotated[Path, typer.Option(help="Folder with real clips.")] = HERE.parents[2] / "shared" / "data",
    click: Annotated[int, typer.Option(min=0, max=len(CLICKS) - 1, help="Place on the disc; 0: standard.")] = 0,
    start: Annotated[int, typer.Option(min=0, max=BEGINNINGS - 1, help="0: first tight row; 1, 2: later.")] = 0,
    output: Annotated[Path, typer.Option("-o", "--output", help="Folder for crops.")] = Path("runs") / "failures",
    every: Annotated[bool, typer.Option("--every", help="All labelled rows, not only failures.")] = False,
) -> None:
    """Print and draw the rows of a clip in which the tracker failed."""
    chosen = _clip_of(clip, data)
    rows = beginnings(chosen)
    if start >= len(rows):
        raise typer.BadParameter(f"{clip} has {len(rows)} frames to begin at, got {start}")
    one_thread()
    begin = start_at(rows[start], click, start)
    folder = output / f"{clip}_{click}_{start}"
    folder.mkdir(parents=True, exist_ok=True)
    looks = look_at(chosen, Follower(begin), folder, every)
    typer.echo(f"{clip}: click {click} at ({begin.x:.1f}, {begin.y:.1f}) in frame {begin.frame}")
    for look in looks:
        typer.echo("\n    ".join([headline(look), *look.evidence]))
    typer.echo(f"{len(looks)} rows shown; crops: {folder}")


def look_at(clip: Clip, follower: Follower, folder: Path, every: bool = False) -> list[Look]:
    """Follow a clip from one click and draw the labelled rows in which the tracker failed.

    Parameters
    ----------
    clip : Clip
    follower : Follower
    folder : Path
        For crops, ``FRAME.png``.
    every : bool
        All labelled rows, not only failures.

    Returns
    -------
    list of Look
    """
    truths = {row.frame: row for row in clip.truths}
    looks: list[Look] = []
    last: int | None = None
    for frame, (answer,) in follow(clip, [follower]):
        if answer is None:
            continue
        last = frame.index if answer else last
        truth = truths.get(frame.index)
        if truth is None:
            continue
        look = Look(truth, circle(answer.shape) if isinstance(answer, ms.Track) else None, words_of(answer), last, [])
        if not (every or look.failed):
            continue
        picture = crop(frame.image, look)
        if follower.tracker is not None:
            color = follower.tracker.color
            picture = np.hstack((picture, crop(score_picture(frame.image, color), look)))
            if truth.circle is not None:
                look = msgspec.structs.replace(look, evidence=examine(frame.image, color, truth.circle))
        looks.append(look)
        cv2.imwrite(str(folder / f"{frame.index:05d}.png"), picture)
    return looks


def words_of(answer: Answer) -> str:
    """Write the reason of a loss, and what else is said of it; empty for a track."""
    if isinstance(answer, ms.Track):
        return ""
    expected = (
        "" if answer.predicted is None else "; expected at ({:.0f}, {:.0f}, {:.1f})".format(*circle(answer.predicted))
    )
    detail = str(getattr(answer, "detail", "") or "")
    return " | ".join(part for part in (answer.reason, detail) if part) + expected


def crop(image: Image, look: Look) -> Image:
    """Cut the ball out and enlarge it, with the truth in green and the answer in red."""
    height, width = image.shape[:2]
    x, y, radius = look.truth.circle or look.answer or (0.5 * width, 0.5 * height, 0.25 * height)
    half = AROUND * radius
    scale = SIDE / (2.0 * half)
    # pixel centers are at integers, before and after
    place = np.array([[scale, 0.0, scale * (half - x) - 0.5], [0.0, scale, scale * (half - y) - 0.5]])
    picture = cv2.warpAffine(image, place, (SIDE, SIDE), flags=cv2.INTER_NEAREST)
    for shape, color in ((look.truth.circle, GREEN), (look.answer, RED)):
        if shape is not None:
            at = [round((1 << FINE) * (scale * (s - c + half) - 0.5)) for s, c in zip(shape[:2], (x, y), strict=True)]
            cv2.circle(picture, at, round((1 << FINE) * scale * shape[2]), color, 1, cv2.LINE_AA, FINE)
    return np.asarray(picture, np.uint8)


def headline(look: Look) -> str:
    """Write a row in one line."""
    truth = _circle_text(look.truth.circle) + (" lowconf" if look.truth.lowconf else "")
    answer = look.reason if look.answer is None else _circle_text(look.answer)
    error = "" if look.error is None else f", error {look.error:.1f} px"
    last = "never answered" if look.last is None else f"last answered {look.last}"
    return f"frame {look.truth.frame}: truth {truth}; {answer}{error}; {last}"


def _circle_text(circle3: Circle3 | None) -> str:
    return "absent" if circle3 is None else "({:.1f}, {:.1f}, {:.1f})".format(*circle3)


def _clip_of(name: str, data: Path) -> Clip:
    clips, skipped = find_clips(data if data.is_dir() else None)
    for clip in clips:
        if clip.name == name:
            return clip
    why = [each for each in skipped if f"`{name}`" in each]
    raise typer.BadParameter((why or [f"no clip {name!r} in {data}: {', '.join(clip.name for clip in clips)}"])[0])


if __name__ == "__main__":
    typer.run(main)
