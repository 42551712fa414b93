"""Faults of cameras, air and disk: `FaultyCamera`, `blow`, `limited_files`."""

import math
from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import numpy as np
import numpy.typing as npt

from benchmarks.soak.plan import Fault
from matchset.image.frame import Frame
from matchset.links.camera import Camera
from matchset.links.simulation_parameters import FPS
from matchset.numeric.record import fields
from matchset.sim.quadrotor import STATE
from matchset.sim.world import World

OLDEST = 2.0  # s, of the pictures that are kept for stale ones


class FaultyCamera:
    """A camera whose grabber repeats pictures, delivers old ones as new, drops them, or delivers noise.

    Parameters
    ----------
    camera : Camera
        The true one.
    faults : sequence of Fault
        Those of pictures act here.
    seed : tuple of int
        Of the noise.

    Attributes
    ----------
    model : CameraModel
    fault : str
        Kind of the fault in the last picture; empty if there was none.
    """

    def __init__(self, camera: Camera, faults: Sequence[Fault], seed: tuple[int, ...]) -> None:
        self.model, self.fault = camera.model, ""
        self._camera, self._faults = camera, tuple(fault for fault in faults if fault.kind != "gust")
        self._rng = np.random.default_rng(seed)
        self._images: deque[npt.NDArray[np.uint8]] = deque(maxlen=round(OLDEST * FPS))
        self._shown: npt.NDArray[np.uint8] | None = None

    def now(self) -> float:
        """Return the time on the clock of the pictures, s."""
        return self._camera.now()

    def read(self) -> Frame | None:
        """Return the newest picture, or what the fault makes of it."""
        frame = self._camera.read()
        self.fault = ""
        if frame is None:
            return None
        self._images.append(frame.image)
        fault = next((each for each in self._faults if each.acts(frame.time)), None)
        if fault is None:
            self._shown = frame.image
            return frame
        self.fault = fault.kind
        if fault.kind == "dropped":
            return None
        self._shown = self._wrong(fault, frame.image)
        return Frame(self._shown, frame.time, frame.index)

    def _wrong(self, fault: Fault, image: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint8]:
        if fault.kind == "noise":
            return self._rng.integers(0, 256, image.shape, dtype=np.uint8)
        if fault.kind == "frozen":
            return image if self._shown is None else self._shown
        back = min(round(fault.strength[0] * FPS), len(self._images) - 1)
        return self._images[-1 - back]


def blow(world: World, faults: Sequence[Fault], before: float) -> None:
    """Let the gusts change the speed of all vehicles but the one on the rope, for the time since `before`, s."""
    for fault in faults:
        if fault.kind == "gust" and fault.acts(world.time):
            for state in world.states[:-1]:
                fields(state, STATE).velocity[:] += np.array(fault.strength) * (world.time - before)


@contextmanager
def limited_files(megabytes: float) -> Iterator[None]:
    """Let no file grow beyond so many MB in the block: writing fails as on a full disk. Nothing outside Unix."""
    try:
        import resource
    except ImportError:
        yield
        return
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    if megabytes < math.inf:
        resource.setrlimit(resource.RLIMIT_FSIZE, (round(1e6 * megabytes), before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
