"""Find a known shape in bad video from a few hundred pixels, thousands of times a second."""

from matchset.image.color import ColorModel
from matchset.image.device import LinkError
from matchset.image.frame import Frame
from matchset.image.video import Video
from matchset.localization.camera_model import CameraModel
from matchset.localization.filter import PoseFilter
from matchset.localization.localizer import Localizer
from matchset.localization.marker_tracker import MarkerTracker
from matchset.localization.neighbor import Neighbor
from matchset.localization.neighbors import Neighbors
from matchset.localization.pose import Pose
from matchset.localization.target import BallTarget
from matchset.shapes.circle import Circle
from matchset.shapes.convex import Convex
from matchset.shapes.ellipse import Ellipse
from matchset.shapes.polygon import Polygon
from matchset.shapes.quadrilateral import Quadrilateral
from matchset.shapes.rectangle import Rectangle
from matchset.tracking.detect import detect
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
    "Neighbor",
    "Neighbors",
    "Polygon",
    "Pose",
    "PoseFilter",
    "Quadrilateral",
    "Rectangle",
    "Track",
    "Tracker",
    "Video",
    "detect",
]
