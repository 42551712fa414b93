"""Short videos of a ball for the tests of batches, and a pool that works in this process."""

import time
from collections.abc import Container
from pathlib import Path
from types import TracebackType
from typing import Self

import cv2
import numpy as np

from blue_ball import ball_picture
from matchset.batch.jobs.job import Job
from matchset.batch.jobs.work import do_job
from matchset.batch.workers.pool import Answer
from matchset.image.color import ColorModel


def write_ball(
    path: Path, seed: int = 0, frames: int = 12, size: tuple[int, int] = (160, 120), hidden: Container[int] = ()
) -> Path:
    """Write a video of a blue ball that goes to and fro, and is not there in some frames."""
    path.parent.mkdir(parents=True, exist_ok=True)
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"mp4v"), 30.0, size)
    for index in range(frames):
        x = 60.0 + 3.0 * seed + 20.0 * np.sin(0.05 * index + seed)
        writer.write(ball_picture((-100.0 if index in hidden else x, 60.0)))
    writer.release()
    return path


def write_balls(folder: Path, count: int, frames: int = 12) -> Path:
    """Write some of them, in two folders."""
    for number in range(count):
        write_ball(folder / f"day{number % 2}" / f"ball{number}.mp4", number % 5, frames)
    return folder


def write_color(path: Path) -> Path:
    """Write the color of that ball."""
    ColorModel.pick(ball_picture((60.0, 60.0)), 60, 60).save(path)
    return path


class HerePool:
    """Does one job at a time, here; a `Pool`."""

    def __init__(self, *_: object) -> None:
        self.notes = list[str]()
        self.jobs = list[Job]()
        self.done = list[Job]()

    @property
    def free(self) -> int:
        return 2 - len(self.jobs)

    @property
    def running(self) -> dict[str, float]:
        return {job.video: time.monotonic() for job in self.jobs}

    def give(self, job: Job) -> None:
        self.jobs.append(job)

    def answers(self, _: float) -> list[Answer]:
        answers = []
        for job in self.jobs:
            self.done.append(job)
            try:
                answers.append(Answer(job, do_job(job)))
            except OSError as error:
                answers.append(Answer(job, error=error))
        self.jobs = []
        return answers

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        pass
