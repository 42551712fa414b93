"""The paper's Table 1 again: every row, what it took there, what it takes here, or why it could not be run."""

from benchmarks.contest import times as contest_times
from benchmarks.contest.field import OURS, PAPER, missing
from benchmarks.contest.speed import PAPER_FPS
from benchmarks.options import Options
from benchmarks.results import Figure, Finding, Section, table

NO_CODE = "not run: no packaged implementation is known to us"
# name in print, ms in print, peer here, or why there is none
ROWS = (
    ("EDCircles", 9.9, "edge_drawing", "as OpenCV's EdgeDrawing, its successor"),
    ("GRCD-R", 52.0, "", NO_CODE),
    ("Isophote", 20.5, "", NO_CODE),
    ("ITCiD", 15.7, "", NO_CODE),
    ("PolynomialFitting", 16.9, "", NO_CODE),
    ("AR Aristo platform", 16.6, "", "not run: a platform of its own, not a program that takes frames"),
    ("RuneTag", 51.0, "", "not run: not packaged; in another run its decoder did not work; quoted under *Tag systems*"),
    ("AprilTag", 19.0, "april_tag", "AprilTag 3, on tag sequences"),
    ("ChromaTag", 1.4, "", "not run: not packaged; in another run it crashed on sequences; quoted under *Tag systems*"),
    ("Algorithm 1 (the paper)", 0.9, PAPER, "to the letter in NumPy, whole-frame color filter included"),
)
ADDED = (
    ("ArUco (not in the paper)", "aruco", "on tag sequences"),
    ("matchset", OURS, "in the same race"),
)


def run(options: Options) -> Section:
    """Set the times of this machine beside those of the print."""
    light, heavy = contest_times.everybody(options)
    rows, figures = [], []
    for name, printed, key, note in ROWS:
        why = missing(key) if key else ""
        here = "-" if not key or why else f"{heavy[key].median_us / 1e3:.2f} ({heavy[key].least_us / 1e3:.2f})"
        rows.append([name, f"{printed:g}", here, f"not run: {why}" if why else note])
        if here != "-":
            figures.append(Figure(name, heavy[key].median_us / 1e3, "ms", 2))
    for name, key, note in ADDED:
        if not missing(key):
            rows.append([name, "-", f"{heavy[key].median_us / 1e3:.3f} ({heavy[key].least_us / 1e3:.3f})", note])
    figures.append(Figure("matchset", heavy[OURS].median_us / 1e3, "ms", 3))
    fps = 1e6 / light[OURS].median_us
    text = (
        "Milliseconds per frame. In print: the authors' laptop (Intel 4810MQ, 2.8 GHz) and, for most rows, the figures "
        "of those papers on their machines. Here: median (minimum) of this machine, one thread, 640 × 480, among the "
        "heavy ones.\n\n"
        + table(["", "in print, ms", "here, ms", "note"], rows)
        + f"\nThe paper's {PAPER_FPS} frames per second on one core: here {fps:,.0f} with other light contenders in "
        "between.\n"
    )
    finding = Finding(name="table1", what="Table 1, the rows that could be run", figures=tuple(figures))
    return Section("The paper's Table 1", [finding], text)
