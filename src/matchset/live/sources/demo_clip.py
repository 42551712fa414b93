"""The clip of the menu that is always there: `demo_clip` renders it once, with its camera beside it."""

import contextlib
import math
import os
import tempfile
from collections.abc import Callable
from pathlib import Path

import cv2
import msgspec
import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from matchset.camera.camera_model import CameraModel
from matchset.sim.clips.ball_flight_clip import BallFlightClip

MARKER = math.radians(140.0)  # geometry: between the camera's axis and the direction to the marker


class DemoParameters(msgspec.Struct, frozen=True, kw_only=True):
    """What the demo clip shows. All chosen by hand: a ball that is in view all the time, and easy to click.

    Parameters
    ----------
    width, height : int
        px
    fov : float
        Horizontal field of view, rad.
    frames : int
    fps : float
        Frames per second.
    seed : int
        Decides the room.
    """

    width: int = 640
    height: int = 480
    fov: float = math.radians(60.0)
    frames: int = 300
    fps: float = 30.0
    seed: int = 3


def demo_clip(
    parameters: DemoParameters | None = None, folder: Path | None = None, stopped: Callable[[], bool] = lambda: False
) -> Path:
    """Return the demo clip; the first time it is rendered, which takes some ten seconds.

    Parameters
    ----------
    parameters : DemoParameters, optional
    folder : Path, optional
        Where it is kept; without it where the system keeps what can be made again.

    stopped : callable, optional
        Asked after each frame whether it is wanted no more.

    Returns
    -------
    Path
        A video; beside it stands its camera, of the same name with the ending .toml.

    Raises
    ------
    ValueError
        If it cannot be written, or was stopped.
    """
    wanted = parameters or DemoParameters()
    camera = CameraModel.from_fov(wanted.width, wanted.height, wanted.fov)
    path = (folder or cache_folder()) / f"ball-{wanted.width}x{wanted.height}-{wanted.frames}.avi"
    if not (path.is_file() and path.with_suffix(".toml").is_file()):
        camera.save(path.with_suffix(".toml"))
        _render(wanted, camera, path, stopped)
    return path


def place(time: float) -> npt.NDArray[np.float64]:
    """Where the ball is in the camera's frame at a time, m: it goes around, near and far."""
    angle = 0.8 * time
    return np.array((0.55 * math.sin(angle), 0.25 * math.cos(1.3 * angle), 1.8 + 0.4 * math.sin(0.5 * angle)))


def turn(_: float) -> Rotation:
    """Return how the ball is turned: its marker is beside the middle, where a person clicks."""
    return Rotation.from_euler("y", MARKER)


def cache_folder() -> Path:
    """Return a folder for what can be made again; it exists and can be written."""
    home = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    for parent in (home, tempfile.gettempdir()):
        folder = Path(parent) / "matchset"
        with contextlib.suppress(OSError):
            folder.mkdir(parents=True, exist_ok=True)
            if os.access(folder, os.W_OK):
                return folder
    raise ValueError(f"the demo clip cannot be written: neither {home} nor {tempfile.gettempdir()} can")


def _render(wanted: DemoParameters, camera: CameraModel, path: Path, stopped: Callable[[], bool]) -> None:
    """Write the video whole or not at all: its name appears when it is finished."""
    unfinished = path.with_name(f"{path.stem}-{os.getpid()}.avi")
    codec, size = cv2.VideoWriter.fourcc(*"MJPG"), (wanted.width, wanted.height)
    writer = cv2.VideoWriter(str(unfinished), codec, wanted.fps, size)
    try:
        clip = BallFlightClip(
            camera=camera, place=place, turn=turn, frames=wanted.frames, fps=wanted.fps, seed=wanted.seed
        )
        for frame in clip:
            writer.write(frame.image)
            if stopped():
                raise ValueError("the demo clip is not made: the program ends")
        writer.release()
        unfinished.replace(path)
    except OSError as error:
        raise ValueError(f"the demo clip cannot be written: {error}") from error
    finally:
        writer.release()
        unfinished.unlink(missing_ok=True)
