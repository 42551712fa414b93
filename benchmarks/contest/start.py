"""What it takes to begin: start-up time and memory of each peer, each in a process of its own."""

import subprocess
import sys
import tempfile
import time
from pathlib import Path

import msgspec
import numpy as np

from benchmarks.contest.field import HEAVY, LIGHT, OURS, missing, peer
from benchmarks.contest.run import first_sight
from benchmarks.options import Options
from benchmarks.results import Figure, Finding, Section, quantity, table
from benchmarks.tracking.trial import sequence

FRAMES = 20
ROOT = Path(__file__).resolve().parents[2]


class Cost(msgspec.Struct, frozen=True):
    """Seconds from the start of the process to the first answer, and resident size after some frames, MB."""

    seconds: float
    megabytes: float


def run(options: Options) -> Section:
    """Start a process for each peer."""
    clip = sequence("typical", options.seeds[0], FRAMES)
    pairs = list(clip)
    start = first_sight(*pairs[0])
    with tempfile.TemporaryDirectory(prefix="matchset_bench_") as folder:
        file = Path(folder) / "frames.npz"
        np.savez(file, images=np.array([frame.image for frame, _ in pairs]), circle=start.circle)
        keys = [key for key in (*LIGHT, *HEAVY) if not missing(key)]
        times = 1 if options.quick else 2
        costs = {key: min((_cost(key, file) for _ in range(times)), key=lambda cost: cost.seconds) for key in keys}
    rows = [[peer(key).name, f"{c.seconds:.2f}", quantity(c.megabytes, "", 0)] for key, c in costs.items()]
    ours = costs[OURS]
    finding = Finding(
        name="cost_of_starting",
        what="start-up and memory of matchset; the peers' are in the table",
        figures=(Figure("start", ours.seconds, "s", 2), Figure("memory", ours.megabytes, "MB", 0)),
    )
    text = (
        f"From the start of a process to the first answer, the best of {times}, kernels cached; resident size after "
        f"{FRAMES} frames. Python, NumPy, OpenCV and the {FRAMES} frames in memory are in all of them; what ViSP's "
        "driver takes is not. matchset brings Numba and SciPy.\n\n" + table(["", "start, s", "memory, MB"], rows)
    )
    return Section("Start-up and memory beside the others", [finding], text)


def _cost(key: str, frames: Path) -> Cost:
    begin = time.time()
    command = [sys.executable, "-m", "benchmarks.contest.peer_process", key, str(frames)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"{key} failed in a process of its own:\n{done.stderr}")
    moment, megabytes = msgspec.json.decode(done.stdout.splitlines()[-1], type=tuple[float, float])
    return Cost(moment - begin, megabytes)
