"""What `matchset batch` costs and how it grows: `make bench-batch`, or `python -m benchmarks.batch FOLDER`.

Videos are rendered into FOLDER once. The figures of each section are kept there as soon as they are known, so that
sections can be measured one by one; the page is written of what is kept.
"""

import sys
from pathlib import Path
from typing import Annotated

import msgspec
import typer

from benchmarks.batch.kept import Kept
from benchmarks.batch.killed import measure_killed
from benchmarks.batch.overhead import measure_overhead
from benchmarks.batch.page import page
from benchmarks.batch.simulation.basis import FILE, Basis, basis_of
from benchmarks.batch.simulation.predicted import predict
from benchmarks.batch.simulation.tables import simulation_part
from benchmarks.batch.speed import measure_speed
from benchmarks.batch.split import measure_split
from benchmarks.batch.tasks import measure_tasks
from benchmarks.batch.videos import lengths, long_video, short_videos, tiny_videos
from benchmarks.machine import Machine
from benchmarks.workers import one_thread

SECTIONS = "speed", "overhead", "tasks", "split", "killed"
PAGE = Path(__file__).resolve().parents[1] / "BATCH.md"
EMPTY, CLUSTERS = 400, (2, 1_600, 16_000)  # tasks that do nothing, and workers of Dask


def main(
    folder: Annotated[Path, typer.Argument(help="For videos, results and figures; 3 GB with an hour of video.")],
    only: Annotated[str, typer.Option(help=f"Some of {', '.join(SECTIONS)}; 'none': the page alone.")] = ",".join(
        SECTIONS
    ),
    rounds: Annotated[int, typer.Option(min=1, help="How often the same is measured.")] = 3,
    minutes: Annotated[float, typer.Option(min=0.5, help="Length of the long video.")] = 60.0,
    stretch: Annotated[float, typer.Option(min=10.0, help="Its stretches, s.")] = 600.0,
    store: Annotated[
        bool, typer.Option("--store", help=f"Keep what the simulation begins with in {FILE.name}.")
    ] = False,
    output: Annotated[Path | None, typer.Option("-o", help=f"Write the page there: {PAGE.name}.")] = None,
) -> None:
    """Measure, keep, and print the page."""
    one_thread()
    chosen = [each.strip() for each in only.split(",") if each.strip() not in ("", "none")]
    if unknown := set(chosen) - set(SECTIONS):
        raise typer.BadParameter(f"a section is one of {', '.join(SECTIONS)}, got {sorted(unknown)[0]!r}")
    path = folder.absolute() / "figures.json"
    cache, out, kept = folder.absolute() / "videos", folder.absolute() / "results", Kept.load(path)
    for section in chosen:
        print(f"{section} ...", file=sys.stderr)
        if section == "speed":
            kept.speed = measure_speed(short_videos(cache), out / section, rounds)
        elif section == "overhead":
            kept.overhead = measure_overhead(short_videos(cache, 2), out / section, rounds)
        elif section == "tasks":
            kept.tasks = measure_tasks(short_videos(cache), out / section, EMPTY, CLUSTERS)
        elif section == "split":
            long, few = long_video(cache, minutes), short_videos(cache)
            kept.split = measure_split(long, few, out / section, minutes, stretch)
        else:
            kept.killed = measure_killed(tiny_videos(cache), out / section)
        here = Machine.here()
        kept.where[section] = f"{here.date}, commit {here.commit}, {here.processor}, {here.cores} cores"
        kept.save(path)
        print(msgspec.json.encode(getattr(kept, section)).decode(), file=sys.stderr)
    text = page(kept, *_simulated(kept, cache, store))
    if output:
        output.write_text(text, encoding="utf-8")
    print(text)


def _simulated(kept: Kept, cache: Path, store: bool) -> list[str]:
    """Write what the simulation says, from what was measured here and what is kept in the repository."""
    whole = kept.speed is not None and kept.overhead is not None and kept.tasks is not None
    if store:
        videos = short_videos(cache).paths
        sizes = [path.stat().st_size for path in videos]
        basis_of(kept, sizes, [lengths()[int(path.name.partition("-")[0])] for path in videos]).save()
    if not FILE.is_file():
        return []
    return [simulation_part(Basis.load(), predict(kept) if whole else None)]


if __name__ == "__main__":
    typer.run(main)
