"""Times of `Tracker.update` on real clips, as a user has them: `measure`.

Each clip is followed in a fresh process without a variable that limits threads. The tracker is deterministic, so
picture k costs the same work in each run: of the runs the least time of each picture is taken, which leaves out what
the machine disturbed, and then quantiles over the pictures. Beside two busy processes the processor time of the thread
decides: how long it waits for a core is not its doing.
"""

import contextlib
import os
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence

import msgspec
import numpy as np
import numpy.typing as npt

from benchmarks.machine import ROOT
from benchmarks.real.clips import Clip
from benchmarks.real.starts import start_at
from benchmarks.regression.clock import Clocked, Task
from benchmarks.regression.figures import INFORMATION, MEDIAN, TAIL, THREADS, WORST, Figure, Kind

PICTURES, SHOWN = 200, 40  # after the click, and those of them with the ball where it leaves for good
RUNS, BUSY_RUNS, BUSY = 3, 2, 2
GONE_FROM, GONE = "green_hand_a", "gone for good"
QUICK = ("green_throw", "green_thrown", "yellow_occlusion")
ALONE, BESIDE = "time alone", "time beside two busy processes"
FIGURES = (ALONE, BESIDE)
HOW = (
    f"`Tracker.update` on the first {PICTURES} pictures from the standard click on, in a fresh process without any "
    f"variable that limits threads; of {RUNS} runs ({BUSY_RUNS} beside busy processes) the least time of each picture, "
    "then quantiles over pictures. *Wall*: on the clock; *thread*: processor time of the calling thread; *all threads "
    "/ own*: processor time of the process over that of the thread, 1 without hidden threads; *conversion*: from BGR "
    "to HSV of such a picture on one thread, the yardstick. "
    f"*{GONE}*: {SHOWN} pictures of `{GONE_FROM}` with the ball, "
    "then its pictures without it, over and over."
)
QUANTILES: tuple[tuple[str, float, Kind], ...] = (
    ("median", 0.5, MEDIAN),
    ("90 %", 0.9, TAIL),
    ("99 %", 0.99, TAIL),
    ("worst", 1.0, WORST),
)
LOOP = "import os\nparent = os.getppid()\nwhile os.getppid() == parent:\n    for _ in range(100_000):\n        pass\n"
LONGEST = 3600  # s, of one process
Floats = npt.NDArray[np.float64]


def unlimited(environment: Mapping[str, str]) -> dict[str, str]:
    """Return an environment without the variables that limit threads."""
    return {
        name: value
        for name, value in environment.items()
        if not name.endswith("_NUM_THREADS") and name not in ("OPENCV_FOR_THREADS_NUM", "OMP_THREAD_LIMIT")
    }


@contextlib.contextmanager
def busy(count: int = BUSY) -> Iterator[list[int]]:
    """Keep processors busy with loops of Python, which end with this process at the latest.

    Yields
    ------
    list of int
        Their numbers.
    """
    loops = [subprocess.Popen([sys.executable, "-c", LOOP]) for _ in range(count)]
    try:
        yield [each.pid for each in loops]
    finally:
        for each in loops:
            each.kill()
            each.wait()


def in_process(task: Task) -> Clocked:
    """Measure a task in a fresh process, as a user would start one.

    Raises
    ------
    ValueError
        If that failed, with what it wrote.
    """
    done = subprocess.run(
        [sys.executable, "-m", "benchmarks.regression.clock"],
        input=msgspec.json.encode(task),
        capture_output=True,
        cwd=ROOT,
        env=unlimited(os.environ),
        timeout=LONGEST,
        check=False,
    )
    if done.returncode:
        raise ValueError(f"{task.video} could not be clocked: {done.stderr.decode(errors='replace')}")
    return msgspec.json.decode(done.stdout, type=Clocked)


def least(runs: Sequence[Sequence[Sequence[int]]]) -> Floats:
    """Least time of each picture over the runs.

    Parameters
    ----------
    runs : array of shape (runs, pictures, 3), ns

    Returns
    -------
    ndarray of shape (pictures, 3)
        ms.
    """
    return np.asarray(np.array(runs, np.float64).min(axis=0) / 1e6)


def quantile(values: Floats, share: float) -> float:
    """Quantile of times: one that was measured, the larger of two."""
    return float(np.quantile(values, share, method="higher"))


def figures_of(where: tuple[str, str], found: Clocked, wall_decides: bool = True) -> list[Figure]:
    """Name the numbers of a clip."""
    times = least(found.update)
    figures = []
    for column, name in ((0, "wall"), (1, "thread")):
        for words, share, kind in QUANTILES:
            chosen = kind if column or wall_decides else INFORMATION
            figures.append(Figure.of(where, f"{name} {words}, ms", quantile(times[:, column], share), chosen))
    pick = np.array(found.pick, np.float64).min(axis=0) / 1e6
    every = np.array(found.update, np.float64)
    ratio = float((every[..., 2].sum(axis=1) / every[..., 1].sum(axis=1)).min())
    conversion = float(np.median(found.conversion)) / 1e6
    return [
        *figures,
        Figure.of(where, "pick, thread, ms", float(pick[1]), TAIL),
        Figure.of(where, "all threads / own", ratio, THREADS),
        Figure.of(where, "lost pictures", found.lost, INFORMATION),
        Figure.of(where, "conversion, ms", conversion, INFORMATION),
    ]


def task_of(clip: Clip, runs: int = RUNS) -> Task:
    """Make the task of a clip: its pictures from the standard click on."""
    start = start_at(clip.tight[0], click=0)
    return Task(str(clip.video.resolve()), list(range(start.frame, start.frame + PICTURES)), (start.x, start.y), runs)


def gone(clip: Clip, runs: int = RUNS) -> Task:
    """Make the task of a ball that leaves for good: pictures with it, then those known not to show it, again and again.

    Raises
    ------
    ValueError
        If all rows of the clip show the ball.
    """
    absent = [row.frame for row in clip.truths if row.circle is None]
    if not absent:
        raise ValueError(f"{clip.name} has no row without the ball")
    task = task_of(clip, runs)
    empty = [absent[k % len(absent)] for k in range(PICTURES - SHOWN)]
    return msgspec.structs.replace(task, pictures=task.pictures[:SHOWN] + empty)


def measure(clips: Sequence[Clip], quick: bool = False) -> list[Figure]:
    """Clock all clips, alone and beside two busy processes; with `quick` three of them, alone."""
    if quick:
        few = [clip for clip in clips if clip.name in QUICK]
        return [figure for clip in few for figure in figures_of((ALONE, clip.name), in_process(task_of(clip)))]
    figures = [
        each for name, task in tasks(clips, RUNS).items() for each in figures_of((ALONE, name), in_process(task))
    ]
    with busy():
        for name, task in tasks(clips, BUSY_RUNS).items():
            figures += figures_of((BESIDE, name), in_process(task), wall_decides=False)
    return figures


def tasks(clips: Sequence[Clip], runs: int) -> dict[str, Task]:
    """Make the tasks of all clips, and of a ball that leaves one for good."""
    made = [(clip.name, task_of(clip, runs)) for clip in clips]
    return dict(made + [(GONE, gone(clip, runs)) for clip in clips if clip.name == GONE_FROM])
