"""kill -9 at random moments: `python -m benchmarks.lost.killed` (50 moments of each format).

Films and tables are those of `matchset track`, a real process; it is behind by what its table has more than its film.
A recording is written by a process of its own at 30 steps a second, which says how many it was given. What must hold:
every file can be read, plays at its rate, and lacks 1 s at most.
"""

import functools
import os
import pickle
import signal
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, NamedTuple

import numpy as np
import typer

from benchmarks.lost.content import content_of
from benchmarks.lost.runs import FPS, RUNS, Run, start, write_clip
from matchset.flight.chain.chain_step import FlightSetup
from matchset.flight.chain.flight import Flight
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.recording.writer import RecordingWriter
from matchset.links.simulation_parameters import SimulationParameters

FRAMES = 1500
MOST_LOST = 1.0  # s
FIRST = 8  # pictures: those that wait for the encoder and those of the first piece; before it a film is a header alone
FILMS = "webm", "mp4", "avi"
TIME_OUT = 120.0  # s
LOOK = 0.002  # s, between two looks at a file that grows


class Killed(NamedTuple):
    """What a killed program left.

    Attributes
    ----------
    given : int
        Rows, pictures or steps that were to be written.
    kept : int
        Those that can be read.
    wrong : str
        What should not be, or empty.
    """

    given: int
    kept: int
    wrong: str = ""

    @property
    def lost(self) -> float:
        """What is lost, s of the film."""
        return (self.given - self.kept) / FPS


def kill_film(run: Run, clip: Path, folder: Path, rows: int) -> dict[str, Killed]:
    """Kill `matchset track` after so many rows of its table; return what is left of film and table."""
    film, table = folder / run.files[0], folder / "out" / "tracks.csv"
    for path in (film, table):
        path.unlink(missing_ok=True)
    process = start(run, clip, folder, folder)
    until = time.monotonic() + TIME_OUT
    while _lines(table) < rows and process.poll() is None and time.monotonic() < until:
        time.sleep(LOOK)
    process.kill()
    process.communicate()
    given = content_of(table).number
    return {film.suffix: _left(film, given), ".csv": Killed(given, given)}


def _lines(path: Path) -> int:
    return path.read_bytes().count(b"\n") if path.exists() else 0


def _left(path: Path, given: int) -> Killed:
    if given <= MOST_LOST * FPS and (not path.exists() or path.stat().st_size == 0):
        return Killed(given, 0)
    try:
        content = content_of(path)
    except ValueError as error:
        return Killed(given, 0, str(error) if given > FIRST else "")
    wrong = ""
    if path.suffix != ".mcap" and content.number > 3 and not abs(content.rate - FPS) < 1.0:
        wrong = f"{path} plays at {content.rate:.1f} frames/s"
    if (given - content.number) / FPS > MOST_LOST:
        wrong = f"{path} holds {content.number} of {given}"
    return Killed(given, content.number, wrong)


def record_until_killed(write: Callable[[int], None], after: float) -> int:
    """Call `write` 30 times a second in a process of its own, kill it after a time, s; return the number of calls."""
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            for number in range(round(FPS * TIME_OUT)):
                os.write(writer, b".")
                write(number)
                time.sleep(1.0 / FPS)
        finally:
            os._exit(1)
    os.close(writer)
    time.sleep(after)
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    with os.fdopen(reader, "rb") as told:
        return len(told.read())


def kill_recording(setup: FlightSetup, steps: list[bytes], path: Path, after: float) -> Killed:
    """Kill a process that records, after a time, s; `steps` are pickled steps of a flight."""
    path.unlink(missing_ok=True)

    def write(number: int) -> None:
        if number == 0:
            write.out = RecordingWriter(path, setup)  # type: ignore[attr-defined]
        write.out.write(pickle.loads(steps[number % len(steps)]), [True] * setup.followers)  # type: ignore[attr-defined]

    return _left(path, record_until_killed(write, after))


@functools.cache
def flown() -> tuple[FlightSetup, list[bytes]]:
    """Fly for a second; return what is fixed, and the pickled steps."""
    with Flight(FlightParameters(duration=1.0, world=SimulationParameters(vehicles=3, seed=4))) as flight:
        return flight.setup, [pickle.dumps(step) for step in flight]


def main(
    moments: Annotated[int, typer.Option(min=1, help="How often each is killed.")] = 50,
    seed: Annotated[int, typer.Option(help="Of the moments.")] = 100,
) -> None:
    """Kill programs at random moments and look at what is left."""
    rng, bad = np.random.default_rng(seed), 0
    found: dict[str, list[Killed]] = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_clip(clip := folder / "clip.avi", FRAMES)
        for title in FILMS:
            for rows in rng.integers(2, FRAMES - 100, moments):
                for kind, killed in kill_film(RUNS[title], clip, folder, int(rows)).items():
                    found.setdefault(kind, []).append(killed)
        setup, steps = flown()
        for after in rng.uniform(1.0, 4.0, moments):
            found.setdefault(".mcap", []).append(kill_recording(setup, steps, folder / "a.mcap", after))
    for kind, all_killed in found.items():
        wrong = [each.wrong for each in all_killed if each.wrong]
        bad += len(wrong)
        lost = np.array([each.lost for each in all_killed])
        print(f"{kind:6s} killed {len(lost)} times: lost {np.median(lost):.2f} s, at most {lost.max():.2f} s; {wrong}")
    raise typer.Exit(bad > 0)


if __name__ == "__main__":
    typer.run(main)
