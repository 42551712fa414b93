"""The page of all followers and crowds: `page`, `table`."""

from collections.abc import Sequence

import numpy as np

from benchmarks.crowds.bars import Bar
from benchmarks.crowds.cases import PAIR
from benchmarks.crowds.followers import NAMES, OWN, SMOOTH
from benchmarks.crowds.rows import Row

HEAD = (
    "scene",
    "balls",
    "follower",
    "HOTA",
    "IDF1",
    "switches",
    "names",
    "doubled",
    "missed %",
    "false %",
    "median ms",
    "99 % ms",
)
PAIR_HEAD = ("follower", "right names", "HOTA", "switches", "names", "doubled")
ABOUT = """Balls that look the same, rendered with exact truth (`typical` link, 640 x 480), and a real clip; scored by
TrackEval. Means over the seeds. Balls of which less than 30 % is seen count neither for nor against. *Switches*: how
often a ball got another name; *names*: how many were given; *doubled*: answers on balls beyond one for each ball of a
frame; all of one crowd. Peers are fed with the circles of `ms.detect`, the same for all, as boxes with their support as
confidence, and have the parameters that were best on seeds 100 and 101 (`benchmarks/crowds/peers/parameters.toml`).
Their ms include the detection.

*juggling*: up to five balls for each juggler, whose hands hide what they hold. *billiards*: a plane, collisions.
*swarm*: three dimensions, balls leave and come back. *crossing*: all balls pass the middle of the view every 2 s.
*pair*: one ball hides another one of its size for a second; every third time that comes out where it went in.
*mire*: four equal discs on a box in hands, gray pictures, labelled by hand (`benchmarks/crowds/labels`).
*composed*: real balls, cut out of labelled clips, in other real pictures, with balls of other colors and sizes that are
none of the crowd, coded as JPEG or MPEG-4; seeds below 650 are for tuning (`benchmarks/crowds/composed`)."""

ABOUT_FILES = """`MultiTracker.smooth` explains a video as a whole, read forward and backward; its ms are those of both
readings. Beside it what `update` answers in the same crowds, which knows no later frame."""


def page(rows: Sequence[Row], where: str, judged: Sequence[Bar] = ()) -> str:
    """Write the page."""
    parts = ["# Crowds of equal balls", where, ABOUT]
    if judged:
        head = ["| what | bar | measured | reached |", "| --- | --- | --- | --- |"]
        parts += ["## Bars", "\n".join([*head, *(bar.line() for bar in judged)]), "## All"]
    live = [row for row in rows if row.follower != SMOOTH]
    parts.append(table([row for row in live if row.case.scene != PAIR]))
    pairs = [row for row in live if row.case.scene == PAIR]
    if pairs:
        parts += ["## One hides the other for a second", pair_table(pairs)]
    whole = {row.case for row in rows if row.follower == SMOOTH}
    if whole:
        parts += [
            "## Whole files",
            ABOUT_FILES,
            table([row for row in rows if row.case in whole and row.follower in OWN]),
        ]
    return "\n\n".join(parts) + "\n"


def table(rows: Sequence[Row]) -> str:
    """Write a line for each scene, number of balls and follower; the best HOTA of a crowd is bold."""
    groups = _grouped(rows)
    hotas = {key: _mean(group, "hota") for key, group in groups.items()}
    lines: list[tuple[str, ...]] = [HEAD]
    for (crowd, key), group in groups.items():
        hota = hotas[crowd, key]
        best = hota > max(value for (other, _), value in hotas.items() if other == crowd) - 5e-4
        figures = [f"**{hota:.3f}**" if best else f"{hota:.3f}", f"{_mean(group, 'idf1'):.3f}"]
        figures += [f"{_mean(group, name):.1f}" for name in ("switches", "names", "doubled")]
        figures += [f"{100.0 * _mean(group, name):.1f}" for name in ("missed", "false")]
        figures += [
            f"{np.mean([row.median_ms for row in group]):.1f}",
            f"{np.mean([row.most_ms for row in group]):.1f}",
        ]
        lines.append((f"{crowd[0]}, {crowd[2]:g} s", str(crowd[1]), NAMES[key], *figures))
    return _markdown(lines)


def pair_table(rows: Sequence[Row]) -> str:
    """Write a line for each follower: in how many scenes both have their names at the end."""
    lines: list[tuple[str, ...]] = [PAIR_HEAD]
    for (_, key), group in _grouped(rows).items():
        right = f"{sum(row.right is True for row in group)} of {len(group)}"
        figures = [f"{_mean(group, 'hota'):.3f}", *(f"{_mean(group, each):.1f}" for each in PAIR_HEAD[3:])]
        lines.append((NAMES[key], right, *figures))
    return _markdown(lines)


def _mean(rows: Sequence[Row], name: str) -> float:
    return float(np.mean([getattr(row.score, name) for row in rows]))


def _grouped(rows: Sequence[Row]) -> dict[tuple[tuple[str, int, float], str], list[Row]]:
    groups: dict[tuple[tuple[str, int, float], str], list[Row]] = {}
    for row in rows:
        groups.setdefault(((row.case.scene, row.case.balls, row.case.seconds), row.follower), []).append(row)
    return groups


def _markdown(lines: Sequence[tuple[str, ...]]) -> str:
    rows = [f"| {' | '.join(line)} |" for line in lines]
    return "\n".join([rows[0], f"|{' --- |' * len(lines[0])}", *rows[1:]])
