"""A pilot compiles everything in its constructor: no step of an armed vehicle waits, whatever the picture."""

import os
import subprocess
import sys

PROGRAM = """
import gc

import msgspec
import numpy as np
from numba.core.dispatcher import Dispatcher

from matchset.flight.chain.flight import FlightParameters
from matchset.flight.chain.pilot import Pilot
from matchset.localization.markers.ball_colors import learn_colors
from matchset.flight.recording.devices import RecordedCamera, RecordedLink
from matchset.links.simulated import SimulatedChain, SimulationParameters
from matchset.localization.pose import Pose


def compiled():
    kernels = (each for each in gc.get_objects() if isinstance(each, Dispatcher))
    return {(each.py_func.__module__, each.py_func.__name__, key) for each in kernels for key in each.overloads}


chain = SimulatedChain(SimulationParameters(vehicles=2, seed=5))
camera = chain.cameras[0]
colors = learn_colors(camera.sample())
frames = [camera.read() for _ in range(14)]
chain.close()

recorded, link = RecordedCamera(camera.model), RecordedLink(1)
pilot = Pilot(recorded, link, colors)
before = compiled()
reasons = set()
for index, frame in enumerate(frames):
    if index in (5, 6):
        frame = msgspec.structs.replace(frame, image=np.full_like(frame.image, 90))
    if index > 8:  # another ball, far from where the neighbor should be: the tracker is restarted
        frame = msgspec.structs.replace(frame, image=np.roll(frame.image, 170, axis=1))
    recorded.frame, recorded.time = None if index == 7 else frame, frame.time + 0.067
    if index == 2:
        pilot.arm()
    step = pilot.step()
    link.confirmed = step.command
    reasons.add(getattr(step.ball, "reason", "found") + " " + type(step.pose).__name__)
assert any("found Pose" in reason for reason in reasons), reasons
assert len(reasons) >= 3, reasons
late = compiled() - before
assert not late, late
"""


def test_a_step_compiles_nothing() -> None:
    done = subprocess.run([sys.executable, "-c", PROGRAM], env=os.environ, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
