"""Does it see a ball where there is none: rooms full of blue things, but without a disc.

Half of the frames are searched by a tracker that has never seen a ball in this room; its color was learned
from one click in another sequence. In the other half a tracker follows a ball that leaves the picture; then
the room without the ball goes on, and changes. Only frames count in which nothing of the ball can be seen.
"""

from pathlib import Path

import cv2
import msgspec

import matchset as ms
from benchmarks.options import Options
from benchmarks.results import Figure, Finding, Goal, Section, table
from benchmarks.tracking.trial import clicked, sequence
from benchmarks.workers import spread
from matchset.sim.clips.clip import Clip

FRAMES, QUICK_FRAMES = 10_000, 1_000
SEARCHED = 100  # frames of a task that starts searching, in two rooms
GONE = 30  # by this frame a leaving ball is out of the picture
ABSENT = 100  # frames after that, in two rooms
SPREAD = 1_000  # seeds of two runs of this benchmark lie so far apart
SHOWN = 3  # pictures per task at most


class Task(msgspec.Struct, frozen=True):
    """A piece of the work: a seed, whether a ball leaves first, and where to put pictures of false locks."""

    seed: int
    leaving: bool
    pictures: Path | None = None


class Tally(msgspec.Struct, frozen=True):
    """What became of a task.

    Parameters
    ----------
    task : Task
    absent : int
        Frames in which nothing of the ball can be seen.
    false : list of int
        Those of them that were answered.
    followed : bool
        The ball was held to within 10 frames of its departure.
    """

    task: Task
    absent: int
    false: list[int]
    followed: bool


def run(options: Options) -> Section:
    """Count false locks."""
    if options.false_frames is not None:
        options.false_frames.mkdir(parents=True, exist_ok=True)
    tallies = spread(watch, tasks(options), options.jobs)
    halves = [[tally for tally in tallies if tally.task.leaving == leaving] for leaving in (False, True)]
    absent = sum(tally.absent for tally in tallies)
    total = sum(len(tally.false) for tally in tallies)
    goal = (Goal("false locks", high=0.0),)
    finding = Finding(
        name="false_locks",
        what=f"false locks in {absent:,} rendered frames without the ball, settings of `hard`",
        figures=(
            Figure("false locks", total, "", 0),
            Figure("while searching", sum(len(tally.false) for tally in halves[0]), "", 0),
            Figure("after a ball left", sum(len(tally.false) for tally in halves[1]), "", 0),
        ),
        bar=goal,
        prize=goal,
    )
    return Section("False locks", [finding], _text(halves))


def tasks(options: Options) -> list[Task]:
    """List the pieces of work; half of them search, half lose a ball."""
    count = (QUICK_FRAMES if options.quick else FRAMES) // (SEARCHED + ABSENT)
    first = SPREAD * options.seeds[0]
    searches = [Task(first + k, leaving=False, pictures=options.false_frames) for k in range(count)]
    leaves = [Task(first + 500 + k, leaving=True, pictures=options.false_frames) for k in range(count)]
    return searches + leaves


def watch(task: Task) -> Tally:
    """Run a tracker over the frames of a task and note where it saw a ball that is not there."""
    clip = _clip(task)
    color = None if task.leaving else foreign_color(task.seed)
    tracker: ms.Tracker[ms.Circle] | None = None
    absent, false, last_held = 0, [], -1000
    for frame, truth in clip:
        if color is not None and frame.index % clip.scene_frames == 0:
            tracker = ms.Tracker(ms.Circle, color)
        tracker = tracker or clicked(frame, clip.first_click)
        answer = tracker.update(frame)
        if truth.circle is not None:
            last_held = frame.index if answer else last_held
            continue
        absent += 1
        if isinstance(answer, ms.Track):
            false.append(frame.index)
            if task.pictures is not None and len(false) <= SHOWN:
                _save(frame, answer, task)
    gone = clip.frames - absent
    return Tally(task, absent, false, followed=task.leaving and gone - last_held <= 10)


def _clip(task: Task) -> Clip:
    if not task.leaving:
        return sequence("hard", task.seed, SEARCHED, ball=False, scene_frames=SEARCHED // 2)
    frames = GONE + ABSENT
    return sequence("hard", task.seed, frames, away=((GONE, frames),), scene_frames=frames // 2)


def foreign_color(seed: int) -> ms.ColorModel:
    """Learn the color from one click in the first frame of a sequence with another path and another room."""
    clip = sequence("hard", seed + SPREAD // 4, 1)
    frame, _ = next(iter(clip))
    return ms.ColorModel.pick(frame.image, *clip.first_click)


def _save(frame: ms.Frame, answer: ms.Track[ms.Circle], task: Task) -> None:
    assert task.pictures is not None
    shape, picture = answer.shape, frame.image.copy()
    cv2.circle(picture, (round(shape.x), round(shape.y)), round(shape.radius), (190, 40, 255), 2, cv2.LINE_AA)
    kind = "left" if task.leaving else "searching"
    cv2.imwrite(str(task.pictures / f"{kind}_{task.seed}_{frame.index:03d}.png"), picture)
    cv2.imwrite(str(task.pictures / f"{kind}_{task.seed}_{frame.index:03d}_plain.png"), frame.image)


def _text(halves: list[list[Tally]]) -> str:
    rows = []
    for name, tallies in zip(("starts searching", "a ball has just left"), halves, strict=True):
        numbers = (
            len(tallies),
            sum(tally.absent for tally in tallies),
            sum(len(tally.false) for tally in tallies),
            sum(bool(tally.false) for tally in tallies),
        )
        rows.append([name, *map(str, numbers)])
    followed = sum(tally.followed for tally in halves[1])
    worst = [tally for half in halves for tally in half if tally.false]
    places = ", ".join(f"{tally.task.seed} ({len(tally.false)})" for tally in worst[:20])
    return (
        "Each sequence shows two rooms with blue posters, bars and rims. A searching tracker begins anew in "
        "every room, with a color learned from one click in another sequence. Of the balls that left, "
        f"{followed} of {len(halves[1])} were followed to within ten frames of the last that shows them.\n\n"
        + table(["", "sequences", "frames without ball", "false locks", "sequences with one"], rows)
        + (f"\nSeeds with false locks (how many frames): {places}\n" if places else "")
    )
