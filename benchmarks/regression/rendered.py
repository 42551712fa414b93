"""Accuracy on what is rendered: false locks on seeds that nobody tunes on, and shapes: `measure_false_locks`."""

from benchmarks.options import Options
from benchmarks.regression.figures import ERROR, NEVER, NOTHING, Figure
from benchmarks.shapes.cases import THIRD
from benchmarks.shapes.trial import ShapeTask, follow_shape, lost_percent, mean_error
from benchmarks.tracking.false_locks import tasks, watch

UNTUNED = (707, 909)
"""Seeds of false locks that no change was ever tried on; `make bench` has 100."""
FALSE_LOCKS, SHAPES = "false locks", "shapes"
CASES = {
    "quadrilateral": ("quadrilateral", 0.0, "px"),
    "hidden hexagon": ("affine hexagon", THIRD, "% of the area"),
    "hidden square": ("square", THIRD, "px"),
    "hidden quadrilateral": ("quadrilateral", THIRD, "px"),
}
SHAPE_SEEDS, SHAPE_FRAMES = (101, 103), 30


def measure_false_locks() -> list[Figure]:
    """Count answers in a thousand frames without the ball for each seed."""
    figures = []
    for seed in UNTUNED:
        tallies = [watch(task) for task in tasks(Options(seeds=(seed,), quick=True))]
        where = FALSE_LOCKS, f"seed {seed}"
        searching = sum(len(each.false) for each in tallies if not each.task.leaving)
        left = sum(len(each.false) for each in tallies if each.task.leaving)
        figures.append(Figure.of(where, "while searching", searching, NEVER))
        figures.append(Figure.of(where, "after a ball left", left, NEVER))
        followed = sum(each.task.leaving and not each.followed for each in tallies)
        figures.append(Figure.of(where, "balls not held until they left", followed, NEVER))
    return figures


def measure_shapes() -> list[Figure]:
    """Mean error and frames without an answer of other shapes than a ball, which begin with a click too."""
    figures = []
    for name, (case, share, unit) in CASES.items():
        trials = [follow_shape(ShapeTask(case, "typical", seed, SHAPE_FRAMES, share)) for seed in SHAPE_SEEDS]
        answers = [each for trial in trials for each in trial.ours]
        figures.append(Figure.of((SHAPES, name), f"mean error, {unit}", mean_error(answers), ERROR))
        lost = lost_percent(answers)
        figures.append(Figure.of((SHAPES, name), "not answered, %", lost, NOTHING, noise=100.0 / len(answers)))
    return figures
