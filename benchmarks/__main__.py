"""Measure everything and write `benchmarks/RESULTS.md`: `python -m benchmarks`, or `make bench`."""

import importlib
import os
import time
from collections.abc import Callable
from pathlib import Path
from typing import Annotated

import msgspec
import typer
from rich.console import Console

from benchmarks.machine import Machine
from benchmarks.options import UNSEEN, Options, parse_seeds
from benchmarks.readme import fill
from benchmarks.report import json_line, page, show
from benchmarks.results import Section
from benchmarks.workers import one_thread

HERE = Path(__file__).resolve().parent
# What is timed comes first, while the machine is cool and nothing else runs.
MODULES = {
    "speed": "tracking.speed",
    "contest_speed": "contest.speed",
    "contest_table1": "contest.paper:run_table1",
    "contest_start": "contest.start",
    "shapes_speed": "shapes.speed",
    "startup": "tracking.startup",
    "memory": "tracking.memory",
    "live": "live.section",
    "accuracy": "tracking.accuracy",
    "covariance": "tracking.covariance",
    "reacquisition": "tracking.reacquisition",
    "false_locks": "tracking.false_locks",
    "real": "real.section",
    "real_copies": "real.copies.section",
    "contest_accuracy": "contest.accuracy",
    "contest_summary": "contest.summary",
    "contest_figure6": "contest.paper:run_figure6",
    "contest_tags": "contest.tags",
    "contest_real": "contest.real",
    "shapes_accuracy": "shapes.accuracy",
    "shapes_tags": "shapes.tags",
    "localization_speed": "localization.speed",
    "localization_range": "localization.range",
    "localization_methods": "localization.methods",
    "localization_markers": "localization.markers",
    "localization_covariance": "localization.covariance",
    "localization_prediction": "localization.prediction",
    "localization_neighbors": "localization.neighbors",
}
NAMES = tuple(MODULES)


def chosen(only: str) -> list[str]:
    """Read "speed,accuracy"; all of them if it is empty."""
    names = [name.strip().replace("-", "_") for name in only.split(",") if name.strip()]
    unknown = [name for name in names if name not in NAMES]
    if unknown:
        raise typer.BadParameter(f"{', '.join(unknown)}: choose from {', '.join(NAMES)}")
    return [name for name in NAMES if not names or name in names]


def section_of(name: str) -> Callable[[Options], Section]:
    """Find the function that measures a section: `run`, where `MODULES` names no other."""
    module, _, function = MODULES[name].partition(":")
    found: Callable[[Options], Section] = getattr(importlib.import_module(f"benchmarks.{module}"), function or "run")
    return found


def main(
    only: Annotated[str, typer.Option(help=f"Some of {', '.join(NAMES)}.")] = "",
    quick: Annotated[bool, typer.Option("--quick", help="Fewer frames: a first impression.")] = False,
    seeds: Annotated[str, typer.Option(help='Seeds of the sequences, as "100-103,200".')] = "",
    data: Annotated[Path, typer.Option(help="Real clips with truth.")] = HERE.parents[1] / "shared" / "data",
    jobs: Annotated[int, typer.Option(help="Processes for what is not timed.")] = min(2, os.cpu_count() or 1),
    output: Annotated[Path | None, typer.Option("-o", "--output", help="Page of results.")] = None,
    false_frames: Annotated[Path | None, typer.Option(help="Folder for frames with a false lock.")] = None,
    keep: Annotated[Path | None, typer.Option(help="Folder for finished sections: what is there is not run.")] = None,
) -> None:
    """Measure matchset. A full run writes benchmarks/RESULTS.md; the last line is one JSON document."""
    names = chosen(only)
    full = not only and not quick
    target = output or (HERE / "RESULTS.md" if full else None)
    options = Options(
        seeds=_seeds(seeds),
        quick=quick,
        data=data if data.is_dir() else None,
        jobs=jobs,
        pictures=target.parent / "pictures" if target else None,
        false_frames=false_frames,
    )
    sections = measure(names, options, keep)
    machine = Machine.here()
    show(sections, Console())
    if target is not None:
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(page(sections, machine), encoding="utf-8")
        typer.echo(f"written: {target}")
    if target == HERE / "RESULTS.md":
        typer.echo(fill(HERE.parent / "README.md", target))
    typer.echo(json_line(sections, machine))


def measure(names: list[str], options: Options, keep: Path | None = None) -> list[Section]:
    """Run the benchmarks of these names, one after the other.

    Parameters
    ----------
    names : list of str
    options : Options
    keep : Path, optional
        Folder for what is finished: an interrupted run goes on from there.

    Returns
    -------
    list of Section
    """
    one_thread()
    console = Console(stderr=True)
    sections = []
    for name in names:
        begin = time.perf_counter()
        file = None if keep is None else keep / f"{name}.msgpack"
        if file is not None and file.exists():
            sections.append(msgspec.msgpack.decode(file.read_bytes(), type=Section))
            continue
        with console.status(f"{name} ..."):
            sections.append(section_of(name)(options))
        if file is not None:
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_bytes(msgspec.msgpack.encode(sections[-1]))
        console.print(f"{name}: {time.perf_counter() - begin:.0f} s", highlight=False)
    return sections


def _seeds(text: str) -> tuple[int, ...]:
    try:
        return parse_seeds(text) if text else UNSEEN
    except ValueError as error:
        raise typer.BadParameter(str(error)) from error


if __name__ == "__main__":
    typer.run(main)
