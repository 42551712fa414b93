"""How long until the first answer: a fresh process, with the kernels in Numba's cache and without."""

import itertools
import os
import statistics
import subprocess
import sys
import tempfile
import time

import msgspec

from benchmarks.options import Options
from benchmarks.results import Figure, Finding, Goal, Section, table

# Prints when Python was up, when matchset was imported, when the tracker was made, and when it had answered.
PROGRAM = """
import time; marks = [time.time()]
import numpy as np, matchset as ms; marks.append(time.time())
image = np.full((480, 640, 3), 90, np.uint8)
image[np.hypot(*(np.indices((480, 640)) - [[[200]], [[300]]])) < 60] = (200, 60, 30)
tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(image, 300, 200)); marks.append(time.time())
assert tracker.update(ms.Frame(image)); marks.append(time.time())
print(marks)
"""
STAGES = ("Python", "import matchset", "ColorModel.pick and Tracker()", "first update", "all of it")
REPEATS, QUICK_REPEATS = 5, 2


def run(options: Options) -> Section:
    """Start a process with an empty cache, then some more with what it left there."""
    with tempfile.TemporaryDirectory(prefix="matchset_bench_") as cache:
        cold = start(cache)
        warm = [start(cache) for _ in range(QUICK_REPEATS if options.quick else REPEATS)]
    middle = [statistics.median(times) for times in zip(*warm, strict=True)]
    findings = [
        _finding("startup_cached", "kernels cached", middle[-1], 1.5),
        _finding("startup_cold", "kernels not cached", cold[-1], 15.0),
    ]
    rows = [[name, f"{a:.2f}", f"{b:.2f}"] for name, a, b in zip(STAGES, middle, cold, strict=True)]
    text = (
        f"From the start of the process to the first answer, s; cached: the median of {len(warm)}. The "
        "kernels are compiled when a `Tracker` is made, never by `update`.\n\n"
        + table(["", "cached", "not cached"], rows)
    )
    return Section("Start", findings, text)


def start(cache: str) -> list[float]:
    """Start a process and return the durations of its stages and of all of it, s."""
    environment = os.environ | {"NUMBA_CACHE_DIR": cache}
    begin = time.time()
    done = subprocess.run([sys.executable, "-c", PROGRAM], env=environment, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"the first call failed:\n{done.stderr}")
    marks = [begin, *msgspec.json.decode(done.stdout, type=list[float])]
    return [*(after - before for before, after in itertools.pairwise(marks)), marks[-1] - begin]


def _finding(name: str, how: str, seconds: float, most: float) -> Finding:
    return Finding(
        name=name,
        what=f"first answer of a fresh process, {how}",
        figures=(Figure("time", seconds, "s", 2),),
        bar=(Goal("time", high=most),),
    )
