"""The longest pause of a flight's loop in real time: `python -m benchmarks.pauses --minutes 10`.

A follower flies through its own loop, `Pilot` and `ArduinoLink` over a pseudo-terminal, recorded and viewed on a
terminal. World, camera and transmitter are processes of their own (`flight/outside.py`), as they would be on a table. A
pause is the time from one command that was sent to the next: 33 ms is the period of the pictures, and the failsafe acts
at 240 ms. As root the loop runs before all other programs (`raised_priority`), and so does what stands for hardware;
otherwise, on a machine with other work, the longest pause is that of the scheduler. A virtual machine may stand still
as a whole: `flight/standstills.py` sees that, and each pause is printed with how much of it that was. The bar is for
all of the pause.
"""

import argparse
import gc
import os
import shutil
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt

from benchmarks.flight.outside import DrainedTerminal, Outside
from benchmarks.flight.standstills import Witnesses
from matchset.flight.chain.chain_step import ChainStep, FlightSetup
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.chain.pilot import STAGES, Pilot, PilotStep
from matchset.flight.fly.output_files import FlightFiles
from matchset.flight.fly.outputs import FlightOutputs
from matchset.flight.real_time.memory import steady_memory
from matchset.flight.real_time.priority import raised_priority
from matchset.links.arduino.arduino_link import ArduinoLink
from matchset.links.simulated import SimulatedChain
from matchset.links.simulation_parameters import SimulationParameters
from matchset.localization.markers.ball_colors import learn_colors
from matchset.sim.vehicle import VehiclePose

BAR, PRIZE = 0.060, 0.035  # s
SEED = 300
WORST = 8  # pauses that are listed


class Measured(msgspec.Struct):
    """What one run saw.

    Parameters
    ----------
    sent : list of float
        When each command had been sent, s.
    added : list of float
        How long each step took to be handed to the outputs, s.
    steps : list of tuple of float
        Computing times of the stages of each step, s.
    phases : Counter of str
    collections : list of float
        How long each garbage collection took, s.
    crashed : bool
        Before it landed.
    raised : bool
        Whether the loop ran with priority.
    witnesses : Witnesses
        When the machine stood still.
    """

    sent: list[float]
    added: list[float]
    steps: list[tuple[float, ...]]
    phases: Counter[str]
    collections: list[float]
    crashed: bool = False
    raised: bool = False
    witnesses: Witnesses = msgspec.field(default_factory=Witnesses)


def fly(seconds: float, record: Path) -> tuple[Measured, Outside, FlightOutputs, ArduinoLink]:
    """Fly for a time; returns what was measured."""
    world = SimulationParameters(vehicles=2, seed=SEED)
    chain = SimulatedChain(world)
    sample, truth = chain.cameras[0].sample(), chain.truth()
    chain.close()
    parameters = FlightParameters(duration=seconds, world=world)
    measured = Measured([], [], [], Counter(), [])
    with measured.witnesses, Outside(world) as outside, DrainedTerminal():
        link = ArduinoLink(outside.path)
        pilot = Pilot(outside.camera, link, learn_colors(sample))
        setup = FlightSetup(parameters, (outside.camera.model,), (sample,))
        files = FlightFiles(record=record)
        with (
            FlightOutputs(setup, files, real_time=True) as outputs,
            steady_memory(),
            raised_priority() as measured.raised,
            link,
        ):
            gc.callbacks.append(_timing(measured.collections))
            while outside.camera.read() is None:  # the world has begun
                pass
            pilot.arm()
            end = time.monotonic() + seconds
            while time.monotonic() < end:
                step = pilot.step()
                measured.sent.append(time.monotonic())
                outputs.add(_chain_step(step, len(measured.sent), truth))
                measured.added.append(time.monotonic() - measured.sent[-1])
                measured.steps.append(step.stage_times)
                measured.phases[f"{step.safety.phase} {step.safety.reason}".strip()] += 1
            gc.callbacks.pop()
            measured.crashed = bool(outside.crashed.value)
    return measured, outside, outputs, link


def _chain_step(step: PilotStep, index: int, truth: tuple[VehiclePose, ...]) -> ChainStep:
    """Make the step of a chain of one; nobody knows the truth of a flight on a table."""
    return ChainStep(
        index=index,
        time=step.now,
        steps=(step,),
        truth=truth,
        truth_at_exposure=truth,
        true_positions=np.zeros((1, 3)),
        in_view=(True,),
        crashes=(),
    )


def _timing(collections: list[float]) -> Any:
    begin = 0.0

    def note(phase: str, _info: object) -> None:
        nonlocal begin
        if phase == "start":
            begin = time.monotonic()
        else:
            collections.append(time.monotonic() - begin)

    return note


def describe(measured: Measured, outside: Outside, outputs: FlightOutputs, link: ArduinoLink) -> list[str]:
    """Write what was measured in lines."""
    pauses: npt.NDArray[np.float64] = np.diff(measured.sent)
    longest = float(pauses.max())
    verdict = "prize" if longest <= PRIZE else "bar held" if longest <= BAR else "bar NOT held"
    quantiles = ", ".join(
        f"{name} {1e3 * np.quantile(pauses, q):.1f}" for name, q in (("median", 0.5), ("99 %", 0.99), ("99.9 %", 0.999))
    )
    lines = [
        f"longest pause {1e3 * longest:.1f} ms of {len(pauses)} ({verdict}); ms: {quantiles}",
        f"longer than {1e3 * BAR:.0f} ms: {int((pauses > BAR).sum())}; failsafes: {outside.failsafes.value}; longest "
        f"silence at the transmitter {1e3 * outside.silence.value:.1f} ms, which itself did not run for up to "
        f"{1e3 * outside.delay.value:.1f} ms",
        *_without_standstills(measured, pauses),
    ]
    for k in np.argsort(pauses)[::-1][:WORST].tolist():
        stages = ", ".join(
            f"{name} {1e3 * spent:.1f}" for name, spent in zip(STAGES, measured.steps[k + 1], strict=True)
        )
        still = measured.witnesses.within(*measured.sent[k : k + 2])
        lines.append(
            f"  {1e3 * pauses[k]:.1f} ms at step {k + 1}: the machine stood still {1e3 * still:.1f}, "
            f"outputs {1e3 * measured.added[k]:.1f}, {stages}"
        )
    computing = np.array([sum(each[1:]) for each in measured.steps])
    collected = measured.collections or [0.0]
    lines += [
        f"from picture to command, ms: median {1e3 * np.median(computing):.1f}, longest {1e3 * computing.max():.1f}",
        f"handing over to the outputs, ms: median {1e3 * np.median(measured.added):.2f}, "
        f"longest {1e3 * max(measured.added):.1f}",
        f"garbage collections {len(measured.collections)}, longest {1e3 * max(collected):.1f} ms",
        f"pictures skipped {outside.camera.skipped}; crashed {measured.crashed}; raised priority {measured.raised}; "
        f"frames sent {link.firmware.sent}, answered {link.firmware.answered}",
        "phases: " + ", ".join(f"{name} {count}" for name, count in measured.phases.most_common()),
        *[f"note: {note}" for note in outputs.notes],
    ]
    return lines


def _without_standstills(measured: Measured, pauses: npt.NDArray[np.float64]) -> list[str]:
    """Write how long the machine stood still, and the pauses without that."""
    still = np.array([measured.witnesses.within(*measured.sent[k : k + 2]) for k in range(len(pauses))])
    longest = max((end - begin for begin, end in measured.witnesses.seen), default=0.0)
    own = pauses - still
    return [
        f"the machine stood still {len(measured.witnesses.seen)} times, up to {1e3 * longest:.1f} ms; longest pause "
        f"without that {1e3 * own.max():.1f} ms, longer than {1e3 * BAR:.0f} ms: {int((own > BAR).sum())}"
    ]


def stolen() -> float:
    """Return how long a virtual machine's cores have waited for the real ones, s; 0 where nobody tells."""
    try:
        return float(Path("/proc/stat").read_text(encoding="utf-8").split()[8]) / os.sysconf("SC_CLK_TCK")
    except (OSError, IndexError, ValueError):
        return 0.0


def main() -> int:
    """Fly, print, and return 0 if the bar was held."""
    parser = argparse.ArgumentParser(description="the longest pause of a flight's loop in real time")
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument(
        "--folder", type=Path, default=None, help="for the recording, 1.2 GB a minute, removed at the end"
    )
    options = parser.parse_args()
    folder = Path(tempfile.mkdtemp(prefix="pauses", dir=options.folder))
    print(f"{options.minutes:g} minutes; load before {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores", flush=True)
    before, begin = stolen(), time.monotonic()
    try:
        results = fly(60.0 * options.minutes, folder / "flight.mcap")
        size = (folder / "flight.mcap").stat().st_size
    finally:
        shutil.rmtree(folder)
    took = time.monotonic() - begin
    print("\n".join(describe(*results)))
    print(f"stolen by other guests of the machine: {100.0 * (stolen() - before) / took:.1f} % of a core")
    print(f"recording {size / 1e9:.1f} GB; load after {', '.join(f'{load:.1f}' for load in os.getloadavg())}")
    measured, outside = results[:2]
    return 0 if float(np.diff(measured.sent).max()) <= BAR and not outside.failsafes.value else 1


if __name__ == "__main__":
    sys.exit(main())
