"""Tag systems, apart: they need a made target. Cards of side 2 r on the ball's path, over the same link."""

from benchmarks.contest.field import TAGS, missing, peer
from benchmarks.contest.run import Tagged, run_tags
from benchmarks.options import Options
from benchmarks.results import Figure, Finding, Section, table
from benchmarks.tracking.accuracy import figures, pooled
from benchmarks.tracking.sequences import PRESETS
from benchmarks.workers import spread

FRAMES, QUICK_FRAMES = 140, 40
SEEDS, QUICK_SEEDS = 2, 1

QUOTED = (
    ("WhyCon (its own ring)", "0.158 ms (minimum 0.016), full frame, tracking", "0.06 px, 100 % below 5 px"),
    ("ChromaTag (its authors' 7 photos, 752 × 480)", "0.60-0.95 ms", "7 of 7 decoded; not run on sequences"),
    ("RuneTag (ellipse stage only)", "25.6 ms (minimum 11.3)", "its decoder did not run"),
)


def run(options: Options) -> Section:
    """Follow the cards."""
    seeds = options.seeds[: QUICK_SEEDS if options.quick else SEEDS]
    frames = QUICK_FRAMES if options.quick else FRAMES
    keys = [key for key in TAGS if not missing(key)]
    heats = [Tagged(key, name, seed, frames) for key in keys for name in PRESETS for seed in seeds]
    trials = spread(run_tags, heats, options.jobs)
    rows, findings = [], []
    for key in keys:
        scores = {
            name: pooled([t for heat, t in zip(heats, trials, strict=True) if (heat.peer, heat.name) == (key, name)])
            for name in PRESETS
        }
        rows += [[f"{peer(key).name}, `{name}`", *(f.text for f in figures(score))] for name, score in scores.items()]
        means = tuple(Figure(name, score.mean_error_px, "px", 2) for name, score in scores.items())
        valid = tuple(Figure(f"{name}, valid", s.valid_percent, "%", 1) for name, s in scores.items())
        findings.append(Finding(name=f"tags_{key}", what=f"{peer(key).name} on its own cards", figures=means + valid))
    if not rows:
        return Section("Tag systems", [], "Not run: " + "; ".join(f"{key}: {missing(key)}" for key in TAGS))
    head = ["", *(figure.name for figure in figures(scores["clean"]))]
    text = (
        f"Seeds {', '.join(map(str, seeds))}, {frames} frames each; error of the circle inscribed in the card, whose "
        "side is 2 r and which rolls by ± 20 degrees. A tag tells who it is, a ball does not; a tag must be printed, "
        "be turned to the camera and be flat. Their times stand among the heavy ones.\n\n"
        + table(head, rows)
        + "\n**Quoted, from another run** (2026-11-21; 2 vCPU AMD EPYC, other work beside it; 300 synthetic frames of "
        "640 × 480, another renderer; not to be compared with the figures above to the second digit): these need "
        "programs that are not packaged\n\n" + table(["", "time per frame", "accuracy"], [list(row) for row in QUOTED])
    )
    return Section("Tag systems", findings, text)
