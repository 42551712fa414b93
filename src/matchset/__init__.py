"""Find a known shape in bad video from a few hundred pixels, thousands of times a second."""

from matchset.camera.camera_model import CameraModel
from matchset.image.color import ColorModel
from matchset.image.errors import LinkError
from matchset.image.frame import Frame
from matchset.image.video import Video
from matchset.localization.ball_target import BallTarget
from matchset.localization.localizer import Localizer
from matchset.localization.markers.marker_tracker import MarkerTracker
from matchset.localization.neighbors.ball_track import Neighbor
from matchset.localization.neighbors.neighbors import Neighbors
from matchset.localization.pose import Pose
from matchset.localization.pose_filter import PoseFilter
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
