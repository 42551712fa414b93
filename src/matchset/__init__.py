"""Find a known shape in bad video from a few hundred pixels, thousands of times a second."""

from matchset.image.color import ColorModel
from matchset.image.device import LinkError
from matchset.image.frame import Frame
from matchset.image.video import Video
from matchset.localization.camera_model import CameraModel
from matchset.shapes.circle import Circle
from matchset.tracking.detect import detect
from matchset.tracking.track import Lost, Track
from matchset.tracking.tracker import Tracker

__all__ = [
    "CameraModel",
    "Circle",
    "ColorModel",
    "Frame",
    "LinkError",
    "Lost",
    "Track",
    "Tracker",
    "Video",
    "detect",
]
