"""Everybody on real footage: the clips of `--data DIR`, scored by their truth files."""

from pathlib import Path

from benchmarks.contest.field import OURS, PEERS, missing, peer
from benchmarks.contest.run import follow_real_clip
from benchmarks.options import Options
from benchmarks.results import Figure, Finding, Section, table
from benchmarks.tracking.accuracy import figures
from matchset.app.track.score import Score, read_truth, score

QUICK_PEERS = ("matchset", "region_bgr", "contour_moments")
TITLE = "Real footage, beside what people use"


def run(options: Options) -> Section:
    """Follow every clip that has a truth."""
    folders = [] if options.data is None else sorted(path.parent for path in options.data.glob("*/truth.csv"))
    if not folders:
        skipped = Finding(name="contest_real", what="real clips: skipped, not found (`--data DIR`)", figures=())
        return Section(TITLE, [skipped], "Skipped: the real clips are not here.")
    findings, tables = [], []
    for folder in folders:
        scores = scored(folder, QUICK_PEERS if options.quick else PEERS)
        findings.append(_finding(folder.name, scores))
        rows = [[peer(key).name, *(figure.text for figure in figures(each))] for key, each in scores.items()]
        head = ["", *(figure.name for figure in figures(scores[OURS]))]
        tables.append(f"\n**{folder.name}**, {scores[OURS].tight} rows with the ball well known\n\n{table(head, rows)}")
    text = (
        "Everybody is told the circle of the first row with the ball well known, matchset a click on its left half; "
        "that row itself does not count. The peers' parameters are those of the rendered sequences, their color is "
        "learned from the disc of that row. The truth is good to 0.5 px where sharp, to 1-2 px where blurred.\n"
    )
    return Section(TITLE, findings, text + "\n".join(tables))


def scored(folder: Path, keys: tuple[str, ...]) -> dict[str, Score]:
    """Follow a clip with some peers and score them."""
    truths = read_truth(folder / "truth.csv")
    first = next(truth.frame for truth in truths if truth.tight)
    answers = follow_real_clip(folder, truths, [peer(key) for key in keys if not missing(key)])
    return {key: score(each, truths, start=first + 1) for key, each in answers.items()}


def _finding(name: str, scores: dict[str, Score]) -> Finding:
    others = {key: s.valid_percent or 0.0 for key, s in scores.items() if key != OURS}
    best = max(others, key=lambda key: others[key])
    return Finding(
        name=f"contest_{name}",
        what=f"`{name}`, everybody from the same first row; most valid of the others: {peer(best).name}",
        figures=(
            Figure("mean", scores[OURS].mean_error_px, "px", 2),
            Figure("valid", scores[OURS].valid_percent, "%", 1),
            Figure("its mean", scores[best].mean_error_px, "px", 2),
            Figure("its valid", others[best], "%", 1),
        ),
    )
