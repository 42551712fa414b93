"""The page of all followers and crowds: `page`, `table`, `completed`. Real pixels come first, rendered ones last."""

import re
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from benchmarks.crowds.bars import Bar
from benchmarks.crowds.cases import PAIR, REAL, RENDERED
from benchmarks.crowds.followers import NAMES, OWN, SMOOTH
from benchmarks.crowds.physics.clip import SCENES as PHYSICS
from benchmarks.crowds.rows import Row

HEAD = (
    "scene",
    "balls",
    "follower",
    "MOTA",
    "recall %",
    "renamed",
    "0.5 px %",
    "HOTA",
    "IDF1",
    "switches",
    "names",
    "doubled",
    "false %",
    "median ms",
    "99 % ms",
)
PAIR_HEAD = ("follower", "right names", "HOTA", "switches", "names", "doubled")
ABOUT = """Balls that look the same, with their truth, after one click on one of them. Means over the seeds.

*MOTA*: 1 less the missed, false and renamed over the balls to be found; *recall*; *renamed*: how often a ball got
another name. These three count as a user does: an answer is right within 10 px or half a radius of a ball's center,
whichever is more. *0.5 px*: balls that are answered so near, by the first name that they got. HOTA, IDF1 and
*switches* are those of TrackEval, by what the discs share; *false* is too. *Names*: how many were given; *doubled*:
answers on balls beyond one for each ball of a frame. Balls of which less than 30 % is seen count neither for nor
against.

*recipe*: the range of hue, saturation and value around the click, `cv2.inRange`, contours, `minEnclosingCircle`, then
norfair or ByteTrack. *Edge Drawing*: ellipses of `cv2.ximgproc` in the clicked color, then SORT. *trackpy*: `locate` in
a gray picture, or in one of how near colors are to the clicked one, then `link`. These look for themselves. *norfair*,
*ByteTrack*, *OC-SORT*, *SORT*: fed with the circles of `ms.detect`, as boxes with their support as confidence. Each has
the parameters that were best on seeds that are not reported: `benchmarks/crowds/peers/parameters.toml` says on which.
Their ms include the detection."""

ABOUT_REAL = """\
*composed*: real balls, cut out of labelled clips, in other real pictures, with balls of other colors and sizes that are
none of the crowd, coded as JPEG or MPEG-4; seeds from 650 on show other balls and places than those for tuning
(`benchmarks/crowds/composed`). *mire*: four equal discs on a box in hands, gray pictures; *colloids*: five particles
under a microscope, gray pictures; both labelled by hand (`benchmarks/crowds/labels`)."""

ABOUT_PHYSICS = """\
A physics engine moves the balls, and its renderer draws them (`benchmarks/crowds/physics`). None is tuned on."""

ABOUT_RENDERED = """\
By the renderer of `matchset.sim` (`typical` link, 640 x 480). *juggling*: up to five balls for each juggler, whose
hands hide what they hold. *billiards*: a plane, collisions. *swarm*: three dimensions, balls leave and come back.
*crossing*: all balls pass the middle of the view every 2 s. *pair*: one ball hides another one of its size for a
second; every third time that comes out where it went in."""

ABOUT_FILES = """`MultiTracker.smooth` explains a video as a whole, read forward and backward; its ms are those of both
readings. Beside it what `update` answers in the same crowds, which knows no later frame."""
SECTIONS = (
    ("Real pixels", ABOUT_REAL, tuple(REAL)),
    ("Another renderer", ABOUT_PHYSICS, tuple(PHYSICS)),
    ("Rendered", ABOUT_RENDERED, tuple(RENDERED)),
)
BARS = "Bars"
FILES = "Whole files"
TITLES = (BARS, *(title for title, _, _ in SECTIONS), FILES)  # of sections, in their order


def page(rows: Sequence[Row], where: str, judged: Sequence[Bar] = ()) -> str:
    """Write the page; each section says when and where it was measured, `where`, and on which seeds."""
    parts = ["# Crowds of equal balls", ABOUT]
    if judged:
        head = ["| what | bar | measured | reached |", "| --- | --- | --- | --- |"]
        parts += [f"## {BARS}", where, "\n".join([*head, *(bar.line() for bar in judged)])]
    live = [row for row in rows if row.follower != SMOOTH]
    for title, about, scenes in SECTIONS:
        group = [row for row in live if row.case.scene in scenes]
        pairs = [row for row in group if row.case.scene == PAIR]
        if group:
            others = [row for row in group if row.case.scene != PAIR]
            parts += [f"## {title}", about, where + _seeds(others), table(others)]
        if pairs:
            parts += ["### One hides the other for a second", pair_table(pairs)]
    whole = {row.case for row in rows if row.follower == SMOOTH}
    if whole:
        both = [row for row in rows if row.case in whole and row.follower in OWN]
        parts += [f"## {FILES}", ABOUT_FILES, where + _seeds(both), table(both)]
    return "\n\n".join(parts) + "\n"


def completed(text: str, old: str) -> str:
    """Add to a page those sections of an older one that it lacks; they keep what they say of when they were measured.

    Parameters
    ----------
    text, old : str
        Pages.

    Returns
    -------
    str
    """
    head, sections = _split(text)
    sections = _split(old)[1] | sections
    return "".join([head, *(sections[title] for title in TITLES if title in sections)]).rstrip() + "\n"


def _split(text: str) -> tuple[str, dict[str, str]]:
    """Return what stands before the first section, and each section by its title."""
    starts = [found.start() for found in re.finditer(r"^## ", text, re.MULTILINE)]
    ends = [*starts, len(text)]
    parts = [text[begin:end].rstrip() + "\n\n" for begin, end in pairwise(ends)]
    return text[: ends[0]], {part[3 : part.index("\n")]: part for part in parts}


def _seeds(rows: Sequence[Row]) -> str:
    """Say on which seeds rows are, the means of which stand in the table; a labelled clip has none."""
    seeds = sorted({row.case.seed for row in rows if row.case.seconds})
    return f" Seeds {', '.join(map(str, seeds))}." if seeds else ""


def table(rows: Sequence[Row]) -> str:
    """Write a line for each scene, number of balls and follower; the best MOTA and HOTA of a crowd are bold."""
    groups = _grouped(rows)
    lines: list[tuple[str, ...]] = [HEAD]
    for (crowd, key), group in groups.items():
        rivals = [others for (other, _), others in groups.items() if other == crowd]
        where = f"{crowd[0]}, {crowd[2]:g} s" if crowd[2] else crowd[0]
        lines.append((where, str(crowd[1]), NAMES[key], *_figures(group, rivals)))
    return _markdown(lines)


def _figures(group: Sequence[Row], rivals: Sequence[Sequence[Row]]) -> list[str]:
    """Write the figures of a follower and a crowd, in the order of `HEAD`."""
    share = {name: f"{100.0 * _mean(group, name):.1f}" for name in ("recall", "close", "false")}
    count = {name: f"{_mean(group, name):.1f}" for name in ("renamed", "switches", "names", "doubled")}
    figures = [_best(group, rivals, "mota"), share["recall"], count["renamed"], share["close"]]
    figures += [_best(group, rivals, "hota"), f"{_mean(group, 'idf1'):.3f}", count["switches"], count["names"]]
    figures += [count["doubled"], share["false"]]
    return figures + [f"{np.mean([getattr(row, name) for row in group]):.1f}" for name in ("median_ms", "most_ms")]


def _best(group: Sequence[Row], rivals: Sequence[Sequence[Row]], name: str) -> str:
    """Write a figure, bold if no rival has more."""
    figure = _mean(group, name)
    best = figure > max(_mean(each, name) for each in rivals) - 5e-4
    return f"**{figure:.3f}**" if best else f"{figure:.3f}"


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
