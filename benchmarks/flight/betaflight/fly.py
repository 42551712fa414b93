"""Fly a follower on Betaflight, pictures and all: `make fly-betaflight`.

Renderer, tracker, localizer, follower, sticks, Betaflight, four motors, one rigid body. Exit code 1 if a flight falls.
"""

import argparse
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np

from benchmarks.flight.betaflight.sitl import configure, is_built, settings
from benchmarks.flight.betaflight.sticks import CRSF_SETTINGS, UdpSticks, crsf_link
from benchmarks.flight.betaflight.world import BetaflightCamera, BetaflightWorld
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.chain.pilot import Pilot
from matchset.flight.chain.score import SCORING
from matchset.links.simulation_parameters import FPS, SimulationParameters
from matchset.localization.markers.ball_colors import learn_colors
from matchset.localization.pose import Pose

RADIO_DELAY = 0.03  # s, as that of the simulated toy


class Case(NamedTuple):
    """What differs from one row of the table to the next.

    Attributes
    ----------
    link : str
        udp or crsf.
    p_yaw, i_yaw : int
        Betaflight's gains of the yaw rate: 45 and 80 are its defaults, with 80 this airframe's yaw oscillates; 8 and 2
        are sluggish.
    """

    link: str = "udp"
    p_yaw: int = 45
    i_yaw: int = 20


class Result(NamedTuple):
    """One flight: rms to the side, in height, in heading, m; why it ended early; share of pictures with the ball."""

    seed: int
    spread: tuple[float, float, float]
    end: str
    found: float
    seconds: float


CASES = {
    "udp": Case(),
    "crsf": Case(link="crsf"),
    "slow-yaw": Case(p_yaw=8, i_yaw=2),
}


def fly(case: Case, seed: int, duration: float) -> Result:
    """Fly one seed; the follower is told nothing, all its parameters are the defaults."""
    begin = time.perf_counter()
    world_parameters = SimulationParameters(vehicles=2, seed=seed)
    pilot_parameters = FlightParameters().pilot
    place = np.array((pilot_parameters.place.side, pilot_parameters.place.height, pilot_parameters.place.heading))
    with tempfile.TemporaryDirectory() as name:
        extra = list(CRSF_SETTINGS) if case.link == "crsf" else []
        yaw = [f"set p_yaw = {case.p_yaw}", f"set i_yaw = {case.i_yaw}"]
        configure(Path(name), [*settings(), *extra, *yaw])
        world = BetaflightWorld(world_parameters, Path(name), pilot_parameters.place)
        with world.sitl:
            link = UdpSticks(world, RADIO_DELAY) if case.link == "udp" else crsf_link(world, RADIO_DELAY)
            camera = BetaflightCamera(world, world_parameters)
            pilot = Pilot(camera, link, learn_colors(camera.sample()), pilot_parameters)
            pilot.arm()
            start, errors, end, found = world.now, [], "", 0
            steps = round(duration * FPS)
            for _ in range(steps):
                step = pilot.step()
                found += isinstance(step.pose, Pose)
                if world.now - start >= SCORING.transient:
                    errors.append(world.place(0) - place)
                landing = step.safety.phase in ("descending", "cut")
                end = world.crash or (f"{step.safety.phase}: {step.safety.reason}" if landing else "")
                if end:
                    break
    rms = np.sqrt(np.mean(np.square(errors), axis=0)) if errors else np.full(3, np.inf)
    spread = (float(rms[0]), float(rms[1]), float(rms[2]))
    return Result(seed, spread, end, found / steps, time.perf_counter() - begin)


def main() -> int:
    """Fly the cases and print a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", nargs="*", choices=CASES, default=list(CASES), help="cases, all by default")
    parser.add_argument("--seeds", default="110-114", help="first and last one")
    parser.add_argument("--duration", type=float, default=60.0, help="s of each flight")
    arguments = parser.parse_args()
    if not is_built():
        print("error: Betaflight is not built: .ci/setup-betaflight", file=sys.stderr)
        return 2
    first, _, last = arguments.seeds.partition("-")
    fell = 0
    print("| case | seed | side, cm | height, cm | heading, cm | ball found | ended early |")
    print("| --- | ---: | ---: | ---: | ---: | ---: | --- |", flush=True)
    for name in arguments.only:
        for seed in range(int(first), int(last or first) + 1):
            result = fly(CASES[name], seed, arguments.duration)
            fell += bool(result.end)
            cells = " | ".join(f"{100 * each:.1f}" for each in result.spread)
            print(f"| {name} | {seed} | {cells} | {100 * result.found:.0f} % | {result.end or 'no'} |", flush=True)
    return int(fell > 0)


if __name__ == "__main__":
    sys.exit(main())
