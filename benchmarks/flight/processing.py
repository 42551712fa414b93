"""How long a follower computes from picture to command: pictures of a flight in memory, nothing else running."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from matchset.control.command import Command
from matchset.flight.chain.flight import Flight
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.chain.pilot import STAGES, Pilot
from matchset.flight.recording.devices import RecordedCamera, RecordedLink
from matchset.image.frame import Frame
from matchset.links.simulation_parameters import FPS, SimulationParameters

SECONDS = 10.0  # of flight
BEGIN = FPS  # pictures that are left out: the ball is found, everything is loaded


class Seen(NamedTuple):
    """A turn of one follower's loop as it was flown."""

    now: float
    frame: Frame | None
    command: Command


def processing(seed: int, seconds: float = SECONDS) -> npt.NDArray[np.float64]:
    """Fly, then fly every follower again, alone, by the pictures that it saw.

    Parameters
    ----------
    seed : int
    seconds : float
        Length of the flight.

    Returns
    -------
    ndarray of shape (pictures, stages)
        Computing time of each stage after the capture, s, of all followers' pictures.
    """
    parameters = FlightParameters(duration=seconds, world=SimulationParameters(seed=seed))
    with Flight(parameters) as flight:
        models, colors = [camera.model for camera in flight.chain.cameras], flight.colors
        seen: list[list[Seen]] = [[] for _ in models]
        for chain_step in flight:
            for turns, step in zip(seen, chain_step.steps, strict=True):
                turns.append(Seen(step.now, step.frame, step.command))
    spent: list[tuple[float, ...]] = []
    for number, turns in enumerate(seen):
        camera, link = RecordedCamera(models[number]), RecordedLink(number + 1)
        pilot = Pilot(camera, link, colors[number], parameters.loop)
        pilot.arm()
        for turn in turns:
            camera.time, camera.frame, link.confirmed = turn
            step = pilot.step()
            if step.frame is not None and step.frame.index > BEGIN:
                spent.append(step.stage_times[1:])
    return np.array(spent)


def in_words(spent: npt.NDArray[np.float64]) -> str:
    """Median and least of a picture, and the medians of its stages."""
    total = 1e6 * spent.sum(axis=1)
    stages = ", ".join(
        f"{name} {each:.0f}" for name, each in zip(STAGES[1:], 1e6 * np.median(spent, axis=0), strict=True)
    )
    return f"{np.median(total):.0f} µs a picture (median), {total.min():.0f} at best; medians of {stages}"


if __name__ == "__main__":
    print(in_words(processing(100)))
