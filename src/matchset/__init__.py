"""Find a known shape in bad video from about a thousand pixels, thousands of times a second.

Public names are loaded when they are first used (PEP 562), so ``import matchset`` takes a millisecond and loads neither
NumPy, OpenCV nor Numba. To read the package, begin with `tracking` (one frame after the other), then `fitting` (one
frame); below them lie `media`, `image`, `shapes` and `numeric`, above them `camera`, `localization`, `control`, `sim`,
`links` and `sharing`. On that library stand `app` (commands for files and cameras), `flight` and `live` (the page), and
on all of them `cli`. A folder imports only from those below it. Two folders have public names of their own:
`sim`, a simulated world, and `gym`, an environment for Gymnasium in it.
"""

from importlib import import_module

from matchset.numeric.imports import lazy_names

TYPE_CHECKING = False  # as in `typing`, which takes longer to import than this package
if TYPE_CHECKING:
    from typing import Any

    __version__: str

    from matchset import sim as sim
    from matchset.app.adapters.supervision_detections import to_supervision
    from matchset.app.course.table import table
    from matchset.app.drawing.draw import draw, draw_pose
    from matchset.app.pictures.track_video import write_video
    from matchset.camera.camera_model import CameraModel
    from matchset.flight import gym as gym
    from matchset.image.color import ColorModel
    from matchset.image.errors import LinkError
    from matchset.image.frame import Frame
    from matchset.localization.ball_target import BallTarget
    from matchset.localization.localizer import Localizer
    from matchset.localization.markers.marker_tracker import MarkerTracker
    from matchset.localization.neighbors.neighbor import Neighbor
    from matchset.localization.neighbors.neighbors import Neighbors
    from matchset.localization.pose import Pose
    from matchset.localization.pose_filter import PoseFilter
    from matchset.media.video import Video
    from matchset.shapes.circle import Circle
    from matchset.shapes.convex import Convex
    from matchset.shapes.ellipse import Ellipse
    from matchset.shapes.polygon import Polygon
    from matchset.shapes.quadrilateral import Quadrilateral
    from matchset.shapes.rectangle import Rectangle
    from matchset.sharing.network_tables import NetworkTables
    from matchset.sharing.share import Share
    from matchset.sharing.shared_target import SharedTarget
    from matchset.tracking.constants import TrackerConstants
    from matchset.tracking.detection import detect
    from matchset.tracking.many.multi_tracker import MultiTracker
    from matchset.tracking.many.target import Target
    from matchset.tracking.parameters import TrackerParameters
    from matchset.tracking.track import Lost, Track
    from matchset.tracking.tracker import Tracker

__all__ = [
    "BallTarget",
    "CameraModel",
    "Circle",
    "ColorModel",
    "Convex",
    "Ellipse",
    "Frame",
    "LinkError",
    "Localizer",
    "Lost",
    "MarkerTracker",
    "MultiTracker",
    "Neighbor",
    "Neighbors",
    "NetworkTables",
    "Polygon",
    "Pose",
    "PoseFilter",
    "Quadrilateral",
    "Rectangle",
    "Share",
    "SharedTarget",
    "Target",
    "Track",
    "Tracker",
    "TrackerConstants",
    "TrackerParameters",
    "Video",
    "detect",
    "draw",
    "draw_pose",
    "table",
    "to_supervision",
    "write_video",
]

# The same as the imports above; a test compares them.
_MODULES = {
    "BallTarget": "matchset.localization.ball_target",
    "CameraModel": "matchset.camera.camera_model",
    "Circle": "matchset.shapes.circle",
    "ColorModel": "matchset.image.color",
    "Convex": "matchset.shapes.convex",
    "Ellipse": "matchset.shapes.ellipse",
    "Frame": "matchset.image.frame",
    "LinkError": "matchset.image.errors",
    "Localizer": "matchset.localization.localizer",
    "Lost": "matchset.tracking.track",
    "MarkerTracker": "matchset.localization.markers.marker_tracker",
    "MultiTracker": "matchset.tracking.many.multi_tracker",
    "Neighbor": "matchset.localization.neighbors.neighbor",
    "Neighbors": "matchset.localization.neighbors.neighbors",
    "NetworkTables": "matchset.sharing.network_tables",
    "Polygon": "matchset.shapes.polygon",
    "Pose": "matchset.localization.pose",
    "PoseFilter": "matchset.localization.pose_filter",
    "Quadrilateral": "matchset.shapes.quadrilateral",
    "Rectangle": "matchset.shapes.rectangle",
    "Share": "matchset.sharing.share",
    "SharedTarget": "matchset.sharing.shared_target",
    "Target": "matchset.tracking.many.target",
    "Track": "matchset.tracking.track",
    "Tracker": "matchset.tracking.tracker",
    "TrackerConstants": "matchset.tracking.constants",
    "TrackerParameters": "matchset.tracking.parameters",
    "Video": "matchset.media.video",
    "detect": "matchset.tracking.detection",
    "draw": "matchset.app.drawing.draw",
    "draw_pose": "matchset.app.drawing.draw",
    "table": "matchset.app.course.table",
    "to_supervision": "matchset.app.adapters.supervision_detections",
    "write_video": "matchset.app.pictures.track_video",
}

# Public folders; what they offer is in their own `__all__`.
_FOLDERS = {"gym": "matchset.flight.gym", "sim": "matchset.sim"}

if not TYPE_CHECKING:  # a type checker that sees `__getattr__` takes every misspelled name for a public one

    def __getattr__(name: str) -> "Any":
        """Load a public name when it is first used; `__version__` is that of the installed package."""
        if name == "__version__":
            from importlib.metadata import version

            globals()[name] = version("matchset")
            return globals()[name]
        if name in _FOLDERS:
            return import_module(_FOLDERS[name])
        return lazy_names(__name__, _MODULES)(name)


def __dir__() -> list[str]:
    """List what is public, loaded yet or not, and what every module has."""
    return sorted({*(name for name in globals() if name.startswith("__")), *__all__, *_FOLDERS})
