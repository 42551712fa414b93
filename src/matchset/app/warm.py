"""The command `warm`: compile every kernel ahead, for images of a system and for small computers."""

import functools
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from matchset.app.exit_codes import FOUND
from matchset.numeric.kept_code import kept_root

if TYPE_CHECKING:
    from matchset.image.color import ColorModel

FAMILIES = "circle", "ellipse", "rectangle", "quadrilateral", "polygon", "polygon, affine"


def warm() -> int:
    """Compile everything that any command may need and keep it on disk, so that no later start waits for the compiler.

    Sets of kernels that are kept already are loaded, not compiled.
    """
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    console, begin, lines = Console(stderr=True, highlight=False), time.monotonic(), []
    columns = TextColumn("compiling {task.description:16}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn()
    with Progress(*columns, console=console, disable=not console.is_terminal, transient=True) as progress:
        task = progress.add_task("", total=len(groups()))
        for name, compile_group in groups().items():
            progress.update(task, description=name)
            start = time.monotonic()
            compile_group()
            lines.append(f"{name:16} {time.monotonic() - start:6.1f} s")
            progress.advance(task)
    print("\n".join(lines))
    print(f"everything is compiled, {time.monotonic() - begin:.1f} s; kept in {kept_root()}")
    return FOUND


def groups() -> dict[str, Callable[[], object]]:
    """Name the sets of kernels, each with the function that compiles it by making and running what calls it."""
    return {
        **{name: functools.partial(_trackers, name) for name in FAMILIES},
        "click": _click,
        "localizer": _localizer,
        "markers": _markers,
        "neighbors": _neighbors,
        "pose filter": _pose_filter,
        "follower": _follower,
        "simulator": _simulator,
    }


def _trackers(name: str) -> None:
    """Trackers of one family, in color and gray, with few points and many, and a search."""
    import numpy as np

    from matchset.fitting.workspace import MAX_LINES
    from matchset.image.color import ColorModel
    from matchset.image.frame import Frame
    from matchset.shapes.circle import Circle
    from matchset.shapes.ellipse import Ellipse
    from matchset.shapes.polygon import Polygon
    from matchset.shapes.quadrilateral import Quadrilateral
    from matchset.shapes.rectangle import Rectangle
    from matchset.tracking.detection import detect
    from matchset.tracking.tracker import Tracker

    hexagon = [(np.cos(t), np.sin(t)) for t in np.pi / 3.0 * np.arange(6)]
    families: dict[str, Callable[[], type[Any]]] = {
        "circle": lambda: Circle,
        "ellipse": lambda: Ellipse,
        "rectangle": lambda: Rectangle,
        "quadrilateral": lambda: Quadrilateral,
        "polygon": lambda: Polygon.of(hexagon),
        "polygon, affine": lambda: Polygon.of(hexagon, "affine"),
    }
    family = families[name]()
    picture = np.full((64, 64, 3), 40, np.uint8)
    picture[20:44, 20:44] = 220
    gray = ColorModel(np.linspace(-4.0, 4.0, 256, dtype=np.float32))
    for color, image in ((_light(), picture), (gray, np.ascontiguousarray(picture[:, :, 0]))):
        tracker: Tracker[Any] = Tracker(family, color)
        for index in range(3):
            tracker.update(Frame(image, index / 30, index))
        Tracker(family, color, MAX_LINES)  # its workspace is laid out otherwise
        detect(Frame(image), family, color)


def _click() -> None:
    """Click on a disc and follow it; OpenCV then has its tables of CIE Lab, which are half of a first click's time."""
    import cv2
    import numpy as np

    from matchset.image.color import ColorModel
    from matchset.image.frame import Frame
    from matchset.shapes.circle import Circle
    from matchset.tracking.tracker import Tracker

    picture = np.full((64, 64, 3), 40, np.uint8)
    cv2.circle(picture, (32, 32), 12, (40, 90, 220), cv2.FILLED)
    tracker = Tracker(Circle, ColorModel.pick(picture, 32, 32), start=(32.0, 32.0))
    for index in range(3):
        tracker.update(Frame(picture, index / 30, index))


def _localizer() -> object:
    import numpy as np

    from matchset.camera.camera_model import CameraModel
    from matchset.localization.ball_target import BALLOON
    from matchset.localization.localizer import Localizer

    camera = CameraModel.from_fov(640, 480, 1.2)
    camera.rays(camera.project(np.array([[0.0, 0.0, 1.0]])))
    return Localizer(camera, BALLOON)


def _markers() -> object:
    from matchset.localization.ball_target import BALLOON
    from matchset.localization.markers.marker_tracker import MarkerTracker

    return MarkerTracker(_light(), BALLOON)


def _neighbors() -> object:
    import numpy as np

    from matchset.camera.camera_model import CameraModel
    from matchset.image.frame import Frame
    from matchset.localization.ball_target import BALLOON
    from matchset.localization.neighbors.neighbors import Neighbors

    neighbors = Neighbors(CameraModel.from_fov(640, 480, 1.2), BALLOON, _light(), _light())
    for index in range(3):  # a search of the whole picture
        neighbors.update(Frame(np.full((480, 640, 3), 40, np.uint8), index / 30, index))
    return neighbors


def _pose_filter() -> object:
    from matchset.localization.pose_filter import PoseFilter

    return PoseFilter()


def _follower() -> object:
    from matchset.control.follower import Follower

    return Follower()


def _simulator() -> None:
    """Fly two simulated vehicles for a moment, as their pilot would see it."""
    from matchset.control.command import Command
    from matchset.links.simulated import SimulatedChain
    from matchset.links.simulation_parameters import SimulationParameters

    chain = SimulatedChain(SimulationParameters(vehicles=2))
    camera, link = chain.cameras[0], chain.links[0]
    camera.sample()
    link.arm()
    for _ in range(3):
        camera.read()
        link.send(Command(throttle=0.5))
    chain.close()


def _light() -> "ColorModel":
    from matchset.image.color import ColorModel

    return ColorModel.hsv((0, 0, 128), (179, 255, 255))
