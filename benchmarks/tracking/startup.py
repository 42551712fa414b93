"""How long until the first answer, in processor time of fresh processes, measured by turns.

``python -m benchmarks --only startup`` writes the section of the results.
``python -m benchmarks.tracking.startup FOLDER`` compares with another checkout of matchset in that folder, by turns.
"""

import os
import resource
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from benchmarks.options import Options
from benchmarks.results import Figure, Finding, Goal, Section, table

LIBRARIES = "import numba, cv2, numpy"
IMPORT = "import matchset"
HELP = "import sys; sys.argv[1:] = ['--help']; from matchset.cli import main; main()"
ANSWER = """
import numpy as np, matchset as ms
image = np.full((480, 640, 3), 90, np.uint8)
image[np.hypot(*(np.indices((480, 640)) - [[[200]], [[300]]])) < 60] = (200, 60, 30)
tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(image, 300, 200))
assert tracker.update(ms.Frame(image))
"""
REPEATS, QUICK_REPEATS = 7, 3


def run(options: Options) -> Section:
    """Start processes by turns: with an empty cache, then with what it left there."""
    with tempfile.TemporaryDirectory(prefix="matchset_bench_") as cache:
        cold = processor_time(ANSWER, cache)
        times = by_turns(
            {name: (program, cache, None) for name, program in PROGRAMS.items()},
            QUICK_REPEATS if options.quick else REPEATS,
        )
    python, ratio = times["Python alone"], times["first answer"] / times[LIBRARIES]
    own = {name: max(times[name] - python, 0.0) for name in ("import matchset", "matchset --help")}
    findings = [
        _finding("startup_import", "import matchset, beyond Python itself", own["import matchset"], "s", (0.05, 0.01)),
        _finding("startup_help", "matchset --help, beyond Python itself", own["matchset --help"], "s", (0.2, 0.1)),
        _finding("startup_cached", f"first answer, kernels kept, in units of `{LIBRARIES}`", ratio, "", (2.2, 1.6)),
        _finding("startup_cold", "first answer, no kernels kept", cold, "s", (15.0, 8.0)),
    ]
    rows = [[name, f"{seconds:.3f}"] for name, seconds in times.items()] + [
        ["first answer, nothing kept", f"{cold:.1f}"]
    ]
    text = (
        "Processor time of fresh processes, s, by turns; the median. The kernels are compiled when a tracker is made, "
        "never by `update`.\n\n" + table(["", "s"], rows)
    )
    return Section("Start", findings, text)


PROGRAMS = {
    "Python alone": "pass",
    "import matchset": IMPORT,
    "matchset --help": HELP,
    LIBRARIES: LIBRARIES,
    "first answer": ANSWER,
}


def by_turns(programs: dict[str, tuple[str, str, Path | None]], repeats: int) -> dict[str, float]:
    """Median processor time of programs that take turns, s; each is run once before, so that its kernels are kept."""
    for program in programs.values():
        processor_time(*program)
    times: dict[str, list[float]] = {name: [] for name in programs}
    for _ in range(repeats):
        for name, program in programs.items():
            times[name].append(processor_time(*program))
    return {name: statistics.median(each) for name, each in times.items()}


def processor_time(program: str, cache: str, checkout: Path | None = None) -> float:
    """Processor time of a fresh process that runs a program, s.

    Parameters
    ----------
    program : str
    cache : str
        Folder of the kept kernels.
    checkout : Path, optional
        Another checkout of matchset.
    """
    environment = os.environ | {"NUMBA_CACHE_DIR": cache}
    if checkout is not None:
        environment["PYTHONPATH"] = str(checkout / "src")
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([sys.executable, "-c", program], env=environment, capture_output=True, text=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode:
        raise RuntimeError(f"the first call failed:\n{done.stderr}")
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def _finding(name: str, what: str, value: float, unit: str, goals: tuple[float, float]) -> Finding:
    return Finding(
        name=name,
        what=what,
        figures=(Figure("processor time", value, unit, 3),),
        bar=(Goal("processor time", high=goals[0]),),
        prize=(Goal("processor time", high=goals[1]),),
    )


def main(arguments: Sequence[str]) -> None:
    """Compare with another checkout: kernels kept, by turns, and nothing kept, by turns."""
    other = Path(arguments[0])
    checkouts = {"this": Path(__file__).parents[2], "other": other}
    with tempfile.TemporaryDirectory() as first, tempfile.TemporaryDirectory() as second:
        caches = {"this": first, "other": second}
        kept = {name: (ANSWER, caches[name], checkout) for name, checkout in checkouts.items()}
        times = by_turns({**kept, LIBRARIES: (LIBRARIES, first, None)}, REPEATS)
        print("kernels kept:", {name: round(seconds, 3) for name, seconds in times.items()})
    cold: dict[str, list[float]] = {"this": [], "other": []}
    for _ in range(int(arguments[1]) if len(arguments) > 1 else 3):
        for name, checkout in checkouts.items():
            with tempfile.TemporaryDirectory() as empty:
                cold[name].append(processor_time(ANSWER, empty, checkout))
        print("nothing kept:", {name: [round(seconds, 1) for seconds in each] for name, each in cold.items()})


if __name__ == "__main__":
    main(sys.argv[1:])
