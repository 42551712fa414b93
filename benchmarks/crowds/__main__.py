"""Who keeps which name in a crowd of equal balls: `make bench-crowds`, or `python -m benchmarks.crowds`.

Each crowd of each follower is kept in `crowds.kept` as soon as it is known: a run that was stopped goes on. What is
asked for is printed as a page, and written to a file if one is named: sections there that it does not report stay.
"""

import itertools
import sys
from pathlib import Path
from typing import Annotated

import typer

from benchmarks.crowds.bars import TIMED, bars, cost_ratio
from benchmarks.crowds.cases import EVERY, RENDERED, Case, cases, drawn_otherwise, real
from benchmarks.crowds.composed.footage import folder as real_clips
from benchmarks.crowds.composed.scenes import COMPOSED
from benchmarks.crowds.followers import NAMES, Field, absent
from benchmarks.crowds.labelled import NAMES as CLIPS
from benchmarks.crowds.labelled import folder, how_to_get
from benchmarks.crowds.page import completed, page
from benchmarks.crowds.physics.clip import SCENES as PHYSICS
from benchmarks.crowds.physics.world import engine
from benchmarks.crowds.rows import Kept, follow
from benchmarks.machine import Machine
from benchmarks.options import parse_seeds
from benchmarks.workers import one_thread

FOLDER = Path(__file__).resolve().parents[1]
KEPT = FOLDER / "crowds.kept"
PAGE = FOLDER / "CROWDS.md"
GROUPS = ("real", "physics", "rendered")


def main(
    groups: Annotated[
        str, typer.Option(help=f"Some of {', '.join(GROUPS)}: which crowds are reported; what follows is of the last.")
    ] = ",".join(GROUPS),
    scenes: Annotated[str, typer.Option(help=f"Some of {', '.join(EVERY)}.")] = ",".join(RENDERED),
    balls: Annotated[str, typer.Option(help="How many, with commas.")] = "2,5,10,20",
    seeds: Annotated[str, typer.Option(help="As '200-204'; peers were tuned on 100 and 101.")] = "200-204",
    followers: Annotated[str, typer.Option(help=f"Some of {', '.join(NAMES)}.")] = ",".join(NAMES),
    seconds: Annotated[float, typer.Option(min=1.0, help="Length of a crowd, s.")] = 10.0,
    judge: Annotated[
        bool, typer.Option("--bars", help="Also what the bars ask for: 60 s of crossings, 100 pairs, the cost.")
    ] = False,
    output: Annotated[Path | None, typer.Option("-o", help=f"Write the page there: {PAGE.name}.")] = None,
) -> None:
    """Follow crowds, and print the table."""
    one_thread()
    try:
        rendered = cases(_words(scenes), [int(each) for each in _words(balls)], seconds, parse_seeds(seeds))
        listed = _here(_grouped(_words(groups), rendered))
        keys = _known(_words(followers))
    except ValueError as error:
        raise typer.BadParameter(str(error)) from None
    kept, here = Kept(KEPT), Machine.here()
    machine = f"{here.processor}, {here.cores} cores"
    if judge:
        listed += [case for case in TIMED if case not in listed]
    with Field() as field:
        for number, case in enumerate(listed, 1):
            missing = [key for key in keys if kept.get(case, key) is None]
            if missing:
                print(f"{number} of {len(listed)}: {case.scene}, {case.balls} balls, seed {case.seed}", file=sys.stderr)
                follow(case, missing, field, machine, kept.add)
    rows = [row for case in listed for key in keys if (row := kept.get(case, key))]
    where = f"{here.date}, commit {here.commit}, {machine}. Written by `make bench-crowds`."
    text = page(rows, where, bars(rows, cost_ratio()) if judge else ())
    if output:
        old = output.read_text(encoding="utf-8") if output.exists() else ""
        output.write_text(completed(text, old), encoding="utf-8")
    print(text)


def _words(text: str) -> list[str]:
    return [each.strip() for each in text.split(",") if each.strip()]


def _grouped(groups: list[str], rendered: list[Case]) -> list[Case]:
    """Return the crowds of some groups, each once, in the order of `GROUPS`."""
    for group in groups:
        if group not in GROUPS:
            raise ValueError(f"a group is one of {', '.join(GROUPS)}, got {group!r}")
    found = [real() if "real" in groups else [], drawn_otherwise() if "physics" in groups else []]
    found.append(rendered if "rendered" in groups else [])
    return list(dict.fromkeys(itertools.chain(*found)))


def _here(listed: list[Case]) -> list[Case]:
    """Those whose pictures are here; say which are not."""
    reasons = {scene: _missing(scene) for scene in dict.fromkeys(case.scene for case in listed)}
    for scene, reason in reasons.items():
        if reason:
            print(f"{scene} is left out: {reason}", file=sys.stderr)
    return [case for case in listed if not reasons[case.scene]]


def _missing(scene: str) -> str:
    """Why the pictures of a scene cannot be had here; empty if they can."""
    if scene in CLIPS and not folder(scene).is_dir():
        return f"no {folder(scene)}: {how_to_get(scene)}"
    if scene in COMPOSED and not real_clips().is_dir():
        return f"no {real_clips()}"
    try:
        if scene in PHYSICS:
            engine()
    except ImportError as error:
        return str(error)
    return ""


def _known(keys: list[str]) -> list[str]:
    """Those that are here; say which are not."""
    for key in keys:
        if key not in NAMES:
            raise ValueError(f"a follower is one of {', '.join(NAMES)}, got {key!r}")
        if reason := absent(key):
            print(f"{NAMES[key]} is left out: {reason}", file=sys.stderr)
    return [key for key in keys if not absent(key)]


if __name__ == "__main__":
    typer.run(main)
