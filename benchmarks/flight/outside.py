"""What is outside of a flying computer, in processes of their own and in real time: transmitter, world and camera.

The transmitter is the tests' (`tests/links/arduino/pty_transmitter.py`), behind a pseudo-terminal. The world flies what
is on the air and takes a picture every 33 ms; time stamps are of the monotonic clock, which all processes share.
"""

import contextlib
import multiprocessing
import os
import sys
import time
from multiprocessing.shared_memory import SharedMemory
from multiprocessing.sharedctypes import Synchronized, SynchronizedArray
from pathlib import Path
from typing import Any, Self

import numpy as np

from matchset.camera.camera_model import CameraModel
from matchset.control.command import Command
from matchset.image.frame import Frame
from matchset.links.simulated import SimulatedChain
from matchset.links.simulation_parameters import FPS, STEPS_PER_FRAME, SimulationParameters
from matchset.sim.cameras import FIELD, WorldCameras
from matchset.sim.world import RATE

TESTS = Path(__file__).resolve().parents[2] / "tests" / "links" / "arduino"
RING = 8  # pictures that are kept
TRANSMITTER, WORLD = 10, 3  # real-time priorities, as of hardware; the loop's own is 5, and the world takes most time
CONTEXT = multiprocessing.get_context("spawn")
SHORTEST_SLEEP = 0.002  # s
GRABBER = 0.028  # s from the exposure to the picture, as long as it takes to render one and somewhat more


class Outside:
    """The processes, until the end of a `with` block.

    Parameters
    ----------
    world : SimulationParameters
        Two vehicles: one flies, one hangs on a rope.

    Attributes
    ----------
    path : str
        The transmitter's port.
    camera : RealTimeCamera
    failsafes : Synchronized of int
        How often the transmitter's failsafe acted.
    silence : Synchronized of float
        Longest time between two frames that it heard while armed, s.
    delay : Synchronized of float
        Longest time for which the transmitter's own process, which has no processor of its own here, did not run, s.
    crashed : Synchronized of int
        Whether the vehicle crashed.
    """

    def __init__(self, world: SimulationParameters) -> None:
        shape = world.height, world.width, 3
        self._memory = SharedMemory(create=True, size=RING * int(np.prod(shape)))
        self.failsafes, self.silence = CONTEXT.Value("i", 0), CONTEXT.Value("d", 0.0)
        self.delay = CONTEXT.Value("d", 0.0)
        self.crashed, self._stop = CONTEXT.Value("i", 0), CONTEXT.Value("i", 0)
        self._times, self._sticks = CONTEXT.Array("d", RING), CONTEXT.Array("d", 4)
        read, write = CONTEXT.Pipe(duplex=False)
        said, say = CONTEXT.Pipe(duplex=False)
        self._processes = [
            CONTEXT.Process(
                target=_transmit,
                args=(say, self._sticks, self.failsafes, (self.silence, self.delay), self._stop),
                daemon=True,
            ),
            CONTEXT.Process(
                target=_turn,
                args=(world, (self._memory.name, self._times), write, self._sticks, self.crashed, self._stop),
                daemon=True,
            ),
        ]
        for process in self._processes:
            process.start()
        self.path: str = said.recv()
        self.camera = RealTimeCamera(world.camera, self._memory, self._times, read)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.value = 1
        for process in self._processes:
            process.join(10.0)
            process.terminate()
        self._memory.close()
        self._memory.unlink()


class RealTimeCamera:
    """The newest picture of the world's process.

    Parameters
    ----------
    model : CameraModel
    memory : SharedMemory
        The last `RING` pictures.
    times : array
        When they were taken, s on the monotonic clock.
    read : connection
        Tells the number of each picture.
    """

    def __init__(self, model: CameraModel, memory: SharedMemory, times: "SynchronizedArray[float]", read: Any) -> None:
        self.model, self._times, self._read = model, times, read
        self._pictures: Any = np.ndarray((RING, model.height, model.width, 3), np.uint8, memory.buf)
        self._begin = time.monotonic()
        self.skipped = 0

    def read(self) -> Frame | None:
        """Return the newest picture; None if none comes in the time of one and a half."""
        if not self._read.poll(1.5 / FPS):
            return None
        index = self._read.recv()
        while self._read.poll(0):
            index = self._read.recv()
            self.skipped += 1
        slot = index % RING
        return Frame(self._pictures[slot].copy(), self._times[slot] - self._begin, index)

    def now(self) -> float:
        """Return the time on the clock of the pictures, s."""
        return time.monotonic() - self._begin


def _run_as_hardware(level: int) -> None:
    """Wait for no program, where the system allows it."""
    with contextlib.suppress(AttributeError, OSError):
        os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(level))


def _transmit(
    say: Any,
    sticks: "SynchronizedArray[float]",
    failsafes: "Synchronized[int]",
    longest: "tuple[Synchronized[float], Synchronized[float]]",
    stop: "Synchronized[int]",
) -> None:
    """Play the transmitter; its sticks are what is on the air."""
    sys.path.append(str(TESTS))
    from pty_transmitter import PtyTransmitter

    _run_as_hardware(TRANSMITTER)
    with PtyTransmitter() as transmitter:
        port, heard, last, seen = transmitter.port, 0, time.monotonic(), "locked"
        silence, delay = longest
        looked = time.monotonic()
        say.send(transmitter.path)
        while not stop.value:
            time.sleep(SHORTEST_SLEEP)
            armed = port.state in ("armed", "holding")
            throttle, pitch, yaw, roll = port._sticks if armed else (0, 0, 0, 0)
            sticks[:] = [roll / 127.0, pitch / 127.0, yaw / 127.0, throttle / 255.0]
            now, count = time.monotonic(), len(port.heard)
            delay.value, looked = max(delay.value, now - looked), now
            if count != heard:
                if armed and heard:
                    silence.value = max(silence.value, now - last)
                heard, last = count, now
            if port.state == "failsafe" and seen != "failsafe":
                failsafes.value += 1
            seen = port.state


def _turn(
    parameters: SimulationParameters,
    pictures: "tuple[str, SynchronizedArray[float]]",
    write: Any,
    sticks: "SynchronizedArray[float]",
    crashed: "Synchronized[int]",
    stop: "Synchronized[int]",
) -> None:
    """Let the world's time pass as fast as the clock, and take a picture every 33 ms."""
    chain = SimulatedChain(parameters)
    world, memory, images = chain.world, SharedMemory(pictures[0]), chain.images
    assert isinstance(images, WorldCameras)
    ring: Any = np.ndarray((RING, parameters.height, parameters.width, 3), np.uint8, memory.buf)
    world.advance(STEPS_PER_FRAME + FIELD)
    for _ in range(3):
        images.image(0, STEPS_PER_FRAME)  # compiles
    _run_as_hardware(WORLD)
    begin, index = time.monotonic() - world.time, 2
    while not stop.value:
        due = STEPS_PER_FRAME * index + FIELD
        step = min(int((time.monotonic() - begin) * RATE), due)
        if step > world.step:
            roll, pitch, yaw, throttle = sticks[:]
            world.send(0, Command(roll, pitch, yaw, throttle))
            world.advance(step)
            crashed.value = bool(world.crashes)
        if world.step < due:
            time.sleep(SHORTEST_SLEEP)
            continue
        taken = STEPS_PER_FRAME * index
        ring[index % RING] = images.image(0, taken)
        pictures[1][index % RING] = begin + taken / RATE
        time.sleep(max(begin + taken / RATE + GRABBER - time.monotonic(), 0.0))
        write.send(index)
        late = int((time.monotonic() - begin) * FPS) - index
        index += max(late, 1)  # a busy machine: pictures are missing, as from a grabber
    chain.close()
    del ring
    memory.close()


class DrainedTerminal:
    """A terminal on stderr that somebody looks at, until the end of a `with` block: a process that reads it."""

    def __enter__(self) -> Self:
        import pty
        import subprocess

        end, slave = pty.openpty()
        self._reader = subprocess.Popen(["cat"], stdin=end, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(end)
        sys.stderr.flush()
        self._kept = os.dup(2)
        os.dup2(slave, 2)
        os.close(slave)
        return self

    def __exit__(self, *_: object) -> None:
        sys.stderr.flush()
        os.dup2(self._kept, 2)
        os.close(self._kept)
        self._reader.kill()
        self._reader.wait()
