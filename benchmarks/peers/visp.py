"""ViSP (GPL), driven in a process of its own: its moving-edge ellipse and its dot tracker."""

import math
import mmap
import subprocess
import tempfile
import time
import weakref
from pathlib import Path
from typing import ClassVar

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from benchmarks.common.start import Choices, Circle3, Image, Method, Start, Step
from benchmarks.common.target_color import hsv_mask, hsv_range

Gray = npt.NDArray[np.uint8]
DRIVER = Path(__file__).resolve().parents[2] / ".bench" / "visp_driver"


class Visp:
    """A running driver; `picture` is the memory it looks at.

    Parameters
    ----------
    height, width : int
        Size of the picture.

    Raises
    ------
    FileNotFoundError
        If the driver was not built: `.ci/setup-visp` says why.

    Attributes
    ----------
    idle_ns : int
        Time that all of them have spent in the pipe, ns: the round trips less what the driver itself took.
    """

    idle_ns: ClassVar[int] = 0

    def __init__(self, height: int, width: int) -> None:
        if not DRIVER.exists():
            raise FileNotFoundError(f"{DRIVER} was not built")
        folder = "/dev/shm" if Path("/dev/shm").is_dir() else None
        with tempfile.NamedTemporaryFile(dir=folder, prefix="matchset_bench_") as file:
            file.truncate(height * width)
            self.picture: Gray = np.frombuffer(mmap.mmap(file.fileno(), height * width), np.uint8).reshape(
                height, width
            )
            self._process = subprocess.Popen(
                [str(DRIVER), file.name, str(width), str(height)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                bufsize=0,
            )
            self._read()  # "ready": it has opened the file, which may go now
        weakref.finalize(self, self._process.kill)

    def ask(self, words: str) -> Circle3 | None:
        """Send a line and return the circle that comes back, px; None: lost."""
        assert self._process.stdin is not None
        begin = time.perf_counter_ns()
        self._process.stdin.write(words.encode() + b"\n")
        took, *answer = self._read().split()
        Visp.idle_ns += time.perf_counter_ns() - begin - int(took)
        if len(answer) != 3:
            return None
        x, y, radius = (float(number) for number in answer)
        return (x, y, radius) if math.isfinite(x + y + radius) and radius > 0.0 else None

    def _read(self) -> str:
        assert self._process.stdout is not None
        line = bytearray()
        while not line.endswith(b"\n"):
            piece = self._process.stdout.read(256)
            if not piece:
                raise RuntimeError("the ViSP driver has ended")
            line += piece
        return line.decode()


class EllipseParameters(msgspec.Struct, frozen=True):
    """What it sees, the gray picture or the HSV mask; search range, px; sample step, degrees; contrast; color."""

    mask: bool = True
    range: int = 20
    step: float = 4.0
    threshold: float = 10000.0
    hue: int = 15
    saturation: float = 0.5
    value: float = 0.4


ELLIPSE_CHOICES: Choices = {
    "mask": (True, False),
    "hue": (8, 16, 30, 45, 60),
    "saturation": (0.15, 0.3, 0.45, 0.6),
    "range": (12, 20, 30),
    "step": (4.0, 10.0),
    "threshold": (5000.0, 10000.0, 20000.0),
}


def follow_ellipse(start: Start, parameters: EllipseParameters) -> Step:
    """Begin with eight true points of the rim; what is lost is not searched for."""
    bounds = hsv_range(start, parameters.hue, parameters.saturation, parameters.value)
    visp = Visp(*start.image.shape[:2])

    def show(image: Image) -> None:
        if parameters.mask:
            np.copyto(visp.picture, hsv_mask(image, bounds, 3))
        else:
            cv2.cvtColor(image, cv2.COLOR_BGR2GRAY, dst=visp.picture)

    def step(image: Image) -> Circle3 | None:
        show(image)
        return visp.ask("track")

    show(start.image)
    x, y, r = start.circle
    visp.ask(f"ellipse {x} {y} {r} {parameters.range} {parameters.step} {parameters.threshold}")
    return step


HALF_PIXEL = 0.5  # its border runs through the middles of the outermost pixels


class DotParameters(msgspec.Struct, frozen=True):
    """The color's range, and the opening, px."""

    hue: int = 30
    saturation: float = 0.5
    value: float = 0.4
    opening: int = 5


DOT_CHOICES: Choices = {
    "hue": (8, 16, 22, 30, 45, 60),
    "saturation": (0.15, 0.3, 0.45, 0.6),
    "value": (0.1, 0.2, 0.35, 0.5),
    "opening": (0, 3, 5),
}


def follow_dot(start: Start, parameters: DotParameters) -> Step:
    """Begin half a radius beside the middle, where no marker is; what is lost is looked for where it was."""
    bounds = hsv_range(start, parameters.hue, parameters.saturation, parameters.value)
    visp = Visp(*start.image.shape[:2])

    def step(image: Image) -> Circle3 | None:
        np.copyto(visp.picture, hsv_mask(image, bounds, parameters.opening))
        found = visp.ask("track")
        return None if found is None else (found[0], found[1], found[2] + HALF_PIXEL)

    np.copyto(visp.picture, hsv_mask(start.image, bounds, parameters.opening))
    x, y, r = start.circle
    visp.ask(f"dot {x - 0.5 * r} {y} {r}")
    return step


PEERS = {
    "visp_ellipse": Method("ViSP vpMeEllipse", "circle", EllipseParameters, ELLIPSE_CHOICES, follow_ellipse),
    "visp_dot": Method("ViSP vpDot2 on the HSV mask", "circle", DotParameters, DOT_CHOICES, follow_dot),
}
