"""Steps of the Gymnasium environment per second of processor time: ``python -m benchmarks.flight.gym_speed``."""

import json
import statistics
import time
from typing import Any

import gymnasium
import numpy as np

import matchset as ms

STEPS, ROUNDS = 60, 5  # format: of each row
ROWS: tuple[dict[str, Any], ...] = (
    {"observation": "picture"},
    {"observation": "pose"},
    {"observation": "picture", "width_px": 160, "height_px": 120},
    {"observation": "picture", "width_px": 160, "height_px": 120, "pal": "clean"},
)
HOVER = np.array((0.0, 0.0, 0.0, 0.58), np.float32)


def steps_per_second(words: dict[str, Any]) -> float:
    """Measure the median of some rounds, each a flight of its own; `reset` is not counted.

    Parameters
    ----------
    words : dict
        Parameters of the environment.
    """
    env = gymnasium.make("matchset/Follow-v0", **words)
    rates = []
    for seed in range(ROUNDS + 1):
        env.reset(seed=seed)
        begin = time.process_time()
        for _ in range(STEPS):
            if env.step(HOVER)[2]:
                raise RuntimeError(f"seed {seed} crashed: choose other sticks")
        rates.append(STEPS / (time.process_time() - begin))
    return statistics.median(rates[1:])


def main() -> None:
    """Print a table and, as the last line, JSON."""
    gymnasium.register_envs(ms.gym)
    found = {}
    for words in ROWS:
        name = ", ".join(str(value) for value in words.values())
        found[name] = round(steps_per_second(words), 1)
        print(f"{name:30} {found[name]:8.1f} steps/s")
    print(json.dumps(found))


if __name__ == "__main__":
    main()
