"""What `test_no_threads.py` runs in a process of its own: prints threads and processor times as one line of JSON.

It is run by its path, with nothing set: no numbers of threads, no limits. All calls are made twice; the first round
compiles, or loads what was compiled. Threads are counted over both rounds, times in the second.
"""

import json
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from scenes import BLUE, at, scene

import matchset as ms

FRAMES = 36
AWAY = range(12, 19), range(29, FRAMES)
COVERED, NOISY = range(5, 10), range(18, 27)
LARGER = 2  # 640 x 480: libraries start threads for large pictures only
NOISE = 40.0  # gray levels: enough to make fits ambiguous


def threads() -> int:
    """Threads of this process, by the kernel's word."""
    status = Path("/proc/self/status").read_text(encoding="utf-8")
    return next(int(line.split()[1]) for line in status.splitlines() if line.startswith("Threads:"))


def pictures() -> tuple[list[ms.Frame], tuple[float, float]]:
    """A ball that moves, is half covered, is gone, comes back in noise and leaves for good; made by NumPy alone."""
    random, frames = np.random.default_rng(0), []
    for k in range(FRAMES):
        x, y, radius = 60.0 + 5.0 * k, 120.0 + 40.0 * np.sin(k / 8.0), 24.0
        image = scene(seed=k) if any(k in away for away in AWAY) else scene((x, y, radius), seed=k)
        if k in COVERED:
            image[:, int(x) : int(x + radius) + 2] = 90
        if k in NOISY:
            image = (image + random.normal(0.0, NOISE, image.shape)).clip(0, 255).astype(np.uint8)
        image[20:60, 200:260] = BLUE  # something else of its color
        frames.append(at(image.repeat(LARGER, 0).repeat(LARGER, 1), k))
    return frames, (LARGER * 50.0, LARGER * 120.0)


def calls() -> dict[str, Callable[[], Any]]:
    """All that is asked of the package, by name."""
    frames, click = pictures()
    color = ms.ColorModel.pick(frames[0].image, *click)

    def track() -> int:
        tracker = ms.Tracker(ms.Circle, color, start=click)
        return sum(isinstance(tracker.update(frame), ms.Lost) for frame in frames)

    return {
        "pick": lambda: ms.ColorModel.pick(frames[0].image, *click),
        "update": track,
        "detect": lambda: [len(ms.detect(frame, ms.Circle, color)) for frame in frames[::6]],
    }


def main() -> None:
    """Print what each call did."""
    found: dict[str, dict[str, float]] = {"import": {"threads": threads()}}
    every = calls()
    for _ in range(2):
        for name, call in every.items():
            before, process, thread = threads(), time.process_time(), time.thread_time()
            answer = call()
            own, all_of_them = time.thread_time() - thread, time.process_time() - process
            started = threads() - before + found.get(name, {}).get("started", 0)
            found[name] = {"started": started, "own": own, "all": all_of_them}
            if name == "update":
                found[name]["lost"] = answer
    print(json.dumps(found))


if __name__ == "__main__":
    main()
