"""Draw what `matchset locate` makes: `python docs/pictures/located.py`, from the root of the repository."""

import math
import tempfile
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt
from PIL import Image
from scipy.spatial.transform import Rotation

import matchset as ms
from matchset.app.cli_options import TargetOptions
from matchset.app.locate.command import LocateOptions, MarkerOptions, locate
from matchset.sim.clips.ball_flight_clip import BallFlightClip

CAMERA = ms.CameraModel(
    width=640, height=480, fx=450.0, fy=450.0, cx=319.5, cy=239.5, distortion=(-0.2, 0.0, 0.0, 0.0, 0.0)
)
FRAMES, SHOWN = 150, 62


def place(time: float) -> npt.NDArray[np.float64]:
    """Wander through the room, m."""
    return np.array((0.7 * math.sin(1.1 * time), 0.2 * math.sin(1.9 * time), 1.9 + 0.6 * math.cos(1.4 * time)))


def turn(time: float) -> Rotation:
    """Face the camera (half a turn about y) and swing."""
    return Rotation.from_euler("y", 180.0 + 35.0 * math.sin(1.3 * time), degrees=True)


def locate_flight(folder: Path) -> None:
    """Render the flight and run the command on it."""
    video = cv2.VideoWriter(str(folder / "flight.avi"), cv2.VideoWriter.fourcc(*"FFV1"), 30.0, (640, 480))
    for frame in BallFlightClip(camera=CAMERA, place=place, turn=turn, frames=FRAMES, seed=104, preset="typical"):
        video.write(frame.image)
    video.release()
    CAMERA.save(folder / "camera.toml")
    options = LocateOptions(
        source=str(folder / "flight.avi"),
        target=TargetOptions(pick="319,254"),
        marker=MarkerOptions(marker_pick="319,239"),
        camera=folder / "camera.toml",
        diameter=0.28,
        out=folder / "out",
        video=folder / "out.avi",
    )
    locate(options)


def main() -> None:
    """Write docs/pictures/located.jpg."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        locate_flight(folder)
        shown = cv2.VideoCapture(str(folder / "out.avi"))
        shown.set(cv2.CAP_PROP_POS_FRAMES, SHOWN)
        frame = np.asarray(shown.read()[1])
        path = np.asarray(cv2.imread(str(folder / "out" / "poses.png")))
    wide = round(path.shape[1] * frame.shape[0] / path.shape[0])
    small = cv2.resize(path, (wide, frame.shape[0]), interpolation=cv2.INTER_AREA)
    both = np.hstack((frame, small))[..., ::-1]
    target = Path(__file__).with_name("located.jpg")
    Image.fromarray(np.ascontiguousarray(both)).save(target, quality=90, subsampling=0)
    print(f"{target}: {target.stat().st_size // 1000} kB")


if __name__ == "__main__":
    main()
