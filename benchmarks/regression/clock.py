"""A tracker clocked in a process of its own, as a user has it: `python -m benchmarks.regression.clock < TASK`.

It imports what a user imports and sets nothing: no numbers of threads, no environment. The pictures are decoded
before, so that no thread of a decoder is at work; what is clocked is `ColorModel.pick` and then `Tracker.update` on
each picture, in as many runs as are asked for.
"""

import sys
import time
from collections.abc import Callable, Sequence
from typing import Any

import cv2
import msgspec

import matchset as ms

Clocks = tuple[int, int, int]


class Task(msgspec.Struct, frozen=True):
    """What is to be clocked.

    Parameters
    ----------
    video : str
    pictures : list of int
        Numbers of pictures of the video, in the order in which the tracker sees them.
    click : (float, float)
        Into the first of them, px.
    runs : int
        How often all of it.
    """

    video: str
    pictures: list[int]
    click: tuple[float, float]
    runs: int


class Clocked(msgspec.Struct, frozen=True):
    """What was clocked, ns.

    Parameters
    ----------
    pick : list of (int, int, int)
        Of each run: wall time, processor time of the calling thread, processor time of all threads.
    update : list of list of (int, int, int)
        The same of each picture of each run.
    conversion : list of int
        From BGR to HSV on one thread, of each picture; the least of some.
    lost : int
        Pictures of the last run without a track.
    """

    pick: list[Clocks]
    update: list[list[Clocks]]
    conversion: list[int]
    lost: int


def clocked(call: Callable[[], Any]) -> tuple[Clocks, Any]:
    """Call something, and read three clocks before and after."""
    everybody, own, wall = time.process_time_ns(), time.thread_time_ns(), time.perf_counter_ns()
    answer = call()
    took = time.perf_counter_ns() - wall, time.thread_time_ns() - own, time.process_time_ns() - everybody
    return took, answer


def load(task: Task) -> list[ms.Frame]:
    """Decode the pictures of a task; those that the video does not have are left out."""
    wanted = set(task.pictures)
    with ms.Video(task.video) as video:
        fps = video.fps or 30.0
        images = {}
        for frame in video:
            if frame.index in wanted:
                images[frame.index] = frame.image.copy()
            if frame.index >= max(wanted):
                break
    there = [images[number] for number in task.pictures if number in images]
    return [ms.Frame(image, k / fps, k) for k, image in enumerate(there)]


def follow(frames: Sequence[ms.Frame], click: tuple[float, float]) -> tuple[Clocks, list[Clocks], int]:
    """Click into the first picture and follow to the last."""
    pick, color = clocked(lambda: ms.ColorModel.pick(frames[0].image, *click))
    tracker, update, lost = ms.Tracker(ms.Circle, color, start=click), list[Clocks](), 0
    for frame in frames:
        took, answer = clocked(lambda frame=frame: tracker.update(frame))  # type: ignore[misc]
        update.append(took)
        lost += not answer
    return pick, update, lost


def convert(frames: Sequence[ms.Frame], runs: int) -> list[int]:
    """Convert each picture, on one thread: the yardstick, taken after all else is done."""
    cv2.setNumThreads(1)
    return [
        min(clocked(lambda frame=frame: cv2.cvtColor(frame.image, cv2.COLOR_BGR2HSV))[0][1] for _ in range(runs))  # type: ignore[misc]
        for frame in frames
    ]


def measure(task: Task) -> Clocked:
    """Clock all that a task asks for."""
    frames = load(task)
    runs = [follow(frames, task.click) for _ in range(task.runs)]
    return Clocked(
        [pick for pick, _, _ in runs], [update for _, update, _ in runs], convert(frames, task.runs), runs[-1][2]
    )


if __name__ == "__main__":
    task = msgspec.json.decode(sys.stdin.buffer.read(), type=Task)
    sys.stdout.buffer.write(msgspec.json.encode(measure(task)))
