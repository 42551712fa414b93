"""The best parameters for EdgeDrawing's ellipses, on seeds that are not scored: `python -m benchmarks.shapes.search`.

What is searched for is the least mean of min(error, 5 px) over all frames, center and semi-axes together; no answer
counts as 5 px. All is varied one by one, each to the best of its values, in two rounds.
"""

import itertools
from typing import Any

import msgspec
import numpy as np

from benchmarks.shapes.accuracy import WORLDS
from benchmarks.shapes.cases import CASES
from benchmarks.shapes.ellipses import CHOICES, EllipseParameters, ellipse_method
from benchmarks.shapes.trial import scalar
from benchmarks.workers import one_thread

SEEDS, FRAMES, MOST_PX, ROUNDS = range(4), 16, 5.0, 2


def main() -> None:
    """Print what was tried, and the best of it."""
    one_thread()
    case = CASES["ellipse"]
    clips = [
        case.clip(preset, seed, FRAMES, share) for (preset, share), seed in itertools.product(WORLDS.values(), SEEDS)
    ]
    sequences = [(clip, list(clip)) for clip in clips]
    losses: dict[EllipseParameters, float] = {}

    def loss(parameters: EllipseParameters) -> float:
        if parameters not in losses:
            errors: list[float] = []
            for clip, pairs in sequences:
                find = ellipse_method("ellipse", pairs[0][0].image, pairs[0][1], parameters)
                for frame, _ in pairs:
                    found = find(frame.image)
                    wrong = scalar(None if found is None else case.errors(clip, frame.index, found))
                    errors.append(min(wrong, MOST_PX))
            losses[parameters] = float(np.mean(errors))
            print(f"{losses[parameters]:.3f} px  {parameters}", flush=True)
        return losses[parameters]

    best = EllipseParameters()
    for _ in range(ROUNDS):
        for name, values in CHOICES.items():
            changed: list[dict[str, Any]] = [{name: value} for value in values]
            best = min((best, *(msgspec.structs.replace(best, **each) for each in changed)), key=loss)
    print(f"best: {loss(best):.3f} px  {best}")


if __name__ == "__main__":
    main()
