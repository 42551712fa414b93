"""Draw what `matchset locate` makes: `python docs/pictures/located.py`, from the root of the repository.

A frame of its video as a picture, and the two figures of `poses.png` as SVG, for light and dark pages.
"""

import itertools
import math
import tempfile
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

import matchset as ms
from matchset.app.cli_options import TargetOptions
from matchset.app.drawing.plot_style import write_svg
from matchset.app.exit_codes import StopRequest
from matchset.app.locate.annotate_pose import annotate_pose
from matchset.app.locate.loop import PathLog, locate_frames
from matchset.app.locate.options import LocateOptions, MarkerOptions
from matchset.app.locate.path_picture import coordinates_figure, top_figure
from matchset.app.locate.what_options_name import ball_target, locator_for
from matchset.sim.clips.ball_flight_clip import BallFlightClip

CAMERA = ms.CameraModel(
    width=640, height=480, fx=450.0, fy=450.0, cx=319.5, cy=239.5, distortion=(-0.2, 0.0, 0.0, 0.0, 0.0)
)
FRAMES, SHOWN = 150, 62
RADIUS, QUALITY = 0.14, 82  # m; WebP


def place(time: float) -> npt.NDArray[np.float64]:
    """Wander through the room, m."""
    return np.array((0.7 * math.sin(1.1 * time), 0.2 * math.sin(1.9 * time), 1.9 + 0.6 * math.cos(1.4 * time)))


def turn(time: float) -> Rotation:
    """Face the camera (half a turn about y) and swing."""
    return Rotation.from_euler("y", 180.0 + 35.0 * math.sin(1.3 * time), degrees=True)


def flight(folder: Path) -> LocateOptions:
    """Render the flight; return the options of the command for it."""
    video = cv2.VideoWriter(str(folder / "flight.avi"), cv2.VideoWriter.fourcc(*"FFV1"), 30.0, (640, 480))
    for frame in BallFlightClip(camera=CAMERA, place=place, turn=turn, frames=FRAMES, seed=104, preset="typical"):
        video.write(frame.image)
    video.release()
    return LocateOptions(
        source=str(folder / "flight.avi"),
        target=TargetOptions(pick="319,254"),
        marker=MarkerOptions(marker_pick="319,239"),
        diameter=2.0 * RADIUS,
    )


def locate_as_the_command(options: LocateOptions) -> tuple[PathLog, npt.NDArray[np.uint8]]:
    """Do what the command does with its options; return the path, and the annotated frame to show."""
    ball, path = ball_target(options.diameter, None, None, True), PathLog()
    with StopRequest() as stop, ms.Video(options.source) as video:
        locator, taken = locator_for(options, video, CAMERA, ball)
        located = list(path.record(locate_frames(itertools.chain(taken, video), locator, gaps=True, stop=stop)))
    shown = located[SHOWN]
    assert shown.frame is not None
    return path, annotate_pose(shown.frame, shown, CAMERA, RADIUS)


def main() -> None:
    """Write docs/pictures/located.webp, located_top.svg and located_coordinates.svg."""
    with tempfile.TemporaryDirectory() as name:
        path, shown = locate_as_the_command(flight(Path(name)))
    folder = Path(__file__).parent
    cv2.imwrite(str(folder / "located.webp"), shown, [cv2.IMWRITE_WEBP_QUALITY, QUALITY])
    write_svg(top_figure(path, CAMERA), folder / "located_top.svg")
    write_svg(coordinates_figure(path), folder / "located_coordinates.svg")
    for each in sorted(folder.glob("located*.[sw]*")):
        print(f"{each}: {each.stat().st_size // 1000} kB")


if __name__ == "__main__":
    main()
