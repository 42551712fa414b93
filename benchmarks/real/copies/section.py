"""The section `real_copies` of the results: worse copies of the real clips, followed from nine starts and searched."""

import tempfile
from collections.abc import Sequence
from pathlib import Path

import msgspec
import numpy as np

from benchmarks.options import Options
from benchmarks.real import scores
from benchmarks.real.clips import Clip, find_clips
from benchmarks.real.copies.copy import Copy, write_copy
from benchmarks.real.detection import Detected, Seeker, detection_finding, detection_table
from benchmarks.real.following import Recorder, Run, follow
from benchmarks.real.starts import QUICK_CLICKS, starts_of
from benchmarks.results import Finding, Section
from benchmarks.workers import spread

TITLE = "Worse copies of real footage"

CODED = (
    Copy("green_ball_hand", 320, 34),
    Copy("green_ball_hand", 480, 32, every=4),
    Copy("green_bounce", 640, 32),
    Copy("green_hand_a", 320, 30, every=3),
    Copy("green_hand_a", 426, 36),
    Copy("green_hand_b", 480, 36),
    Copy("green_throw", 640, 30),
    Copy("red_pendulum", 240, 34),
    Copy("tennis_throw", 640, 32),
    Copy("yellow_occlusion", 426, 36),
)
"""Coded hard."""

LIT = (
    Copy("green_ball_hand", 640, 28, every=5, jumps=True),
    Copy("green_hand_a", 640, 28, every=5, jumps=True),
    Copy("green_thrown", 640, 28, jumps=True),
    Copy("red_pendulum", 360, 28, every=3, jumps=True),
    Copy("yellow_occlusion", 640, 28, jumps=True),
)
"""In light that jumps."""

PALE = (
    Copy("green_ball_hand", 640, 20, saturation=0.3),
    Copy("green_bounce", 960, 20, saturation=0.3),
    Copy("green_hand_a", 960, 20, saturation=0.3),
    Copy("green_hand_b", 960, 20, saturation=0.3),
    Copy("green_throw", 848, 20, saturation=0.3),
    Copy("tennis_throw", 960, 20, saturation=0.3),
    Copy("green_hand_a", 960, 20, saturation=0.0),
    Copy("green_throw", 848, 20, saturation=0.0),
    Copy("green_thrown", 960, 20, saturation=0.0),
    Copy("red_pendulum", 360, 20, saturation=0.0),
    Copy("yellow_occlusion", 960, 20, saturation=0.0),
)
"""With little color, or none."""


class Task(msgspec.Struct, frozen=True):
    """A clip, the copy to be made of it, the folder for that, and whether a few starts will do."""

    clip: Clip
    copy: Copy
    folder: Path
    quick: bool = False


class Followed(msgspec.Struct, frozen=True):
    """A copy, what became of the clicks in it, and what searches found."""

    clip: Clip
    runs: list[Run]
    detected: Detected


def run(options: Options) -> Section:
    """Measure the copies of all clips that are there."""
    clips, skipped = find_clips(options.data)
    known = {clip.name: clip for clip in clips}
    notes = "".join(f"- {each}\n" for each in skipped)
    copies = [copy for copy in (*CODED, *LIT, *PALE) if copy.clip in known]
    if not copies:
        return Section(TITLE, [Finding(name="real_copies", what="; ".join(skipped), figures=())], notes)
    with tempfile.TemporaryDirectory() as name:
        tasks = [Task(known[copy.clip], copy, Path(name), options.quick) for copy in copies]
        followed = dict(zip([copy.name for copy in copies], spread(measure, tasks, options.jobs), strict=True))
    groups = {"coded": CODED, "lit": LIT, "pale": PALE}
    found = {
        group: [followed[copy.name] for copy in members if copy.name in followed] for group, members in groups.items()
    }
    return Section(
        TITLE,
        [finding for group, members in found.items() if members for finding in findings_of(group, members)],
        text_of([each for members in found.values() for each in members]) + notes,
    )


def measure(task: Task) -> Followed:
    """Make a copy, follow the ball in it from three clicks in three frames, and search its labelled frames."""
    clip = write_copy(task.copy, task.clip, task.folder)
    starts = [start for start in starts_of(clip, task.quick) if start.click in QUICK_CLICKS]
    recorder, seeker = Recorder(clip, starts), Seeker(clip)
    for frame, answers in follow(clip, recorder.followers):
        recorder.take(frame.index, answers)
        seeker.take(frame)
    return Followed(clip, recorder.runs(), seeker.detected())


def findings_of(group: str, members: Sequence[Followed]) -> list[Finding]:
    """Figures of a group of copies, each copy counting the same; no goal was set for them."""
    clips, runs = [each.clip for each in members], {each.clip.name: each.runs for each in members}
    by_copy = [scores.distribution([(each.clip, run) for run in each.runs]) for each in members]
    valid = float(np.mean([figures[0].value for figures in by_copy]))
    starts = scores.starts_finding(clips, runs)
    first = msgspec.structs.replace(starts.figures[0], name="mean valid by copy", value=valid)
    searched = detection_finding(clips, {each.clip.name: each.detected for each in members})
    return [
        msgspec.structs.replace(starts, name=f"real_copies_{group}", figures=(first, *starts.figures[1:]), bar=()),
        msgspec.structs.replace(searched, name=f"real_copies_{group}_detection", bar=()),
    ]


def text_of(members: Sequence[Followed]) -> str:
    """Say how it was measured, and what each copy gave."""
    clips, runs = [each.clip for each in members], {each.clip.name: each.runs for each in members}
    return (
        "The real clips as worse cameras would have taken them: smaller, through libx264 at the quality that is named, "
        "with one picture of several (and all that are labelled), and with exposure and white balance that change "
        "every seven pictures (the logarithm of the brightness between -0.5 and 0.4, the channels by 10 %), or with "
        "30 % of the color or none. Three clicks in three frames each; a row is valid within 5 px.\n\n"
        f"{scores.starts_table(clips, runs)}\n"
        f"{detection_table(clips, {each.clip.name: each.detected for each in members})}\n"
    )
