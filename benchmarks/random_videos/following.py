"""Everybody on a random video: `follow`."""

from functools import cache
from pathlib import Path

import msgspec
from training.rendering.photographs import PhotographParameters, Photographs

from benchmarks.common.start import Start
from benchmarks.contest.field import OURS, peer
from benchmarks.contest.run import answers_of, begun, frames_of
from benchmarks.random_videos.video import FRAMES_PER_SECOND, VideoParameters, frames
from matchset.app.track.score import Score, TruthRow, score

PEERS = (OURS, "hobby", "contour_moments", "cam_shift", "region_bgr")
PHOTOGRAPHS = PhotographParameters(longest=1600, variety=(20.0, 30.0, 45.0))
"""Larger than for learning, and no clear sky: pictures that have something to be taken for a ball."""


class Task(msgspec.Struct, frozen=True):
    """A video to be followed: its seed, the folder of photographs, and by whom."""

    seed: int
    folder: Path
    limits: VideoParameters = VideoParameters()
    peers: tuple[str, ...] = PEERS


@cache
def photographs_in(folder: Path) -> Photographs:
    """Read a folder of photographs once."""
    return Photographs.read([folder], PHOTOGRAPHS)


def follow(task: Task) -> dict[str, Score]:
    """Let everybody follow a video, from its first frame, which does not count."""
    video = frames(task.seed, photographs_in(task.folder), task.limits)
    frame, first = next(video)
    if first.circle is None:
        raise ValueError(f"the ball of video {task.seed} is hidden in its first frame")
    start = Start(frame.image, first.circle, fps=FRAMES_PER_SECOND)
    steps, truths = {key: begun(peer(key), start) for key in task.peers}, list[TruthRow]()
    return {key: score(found, truths) for key, found in answers_of(steps, frames_of(video, truths)).items()}
