"""The contract of every camera that a vehicle is flown by: `Camera`."""

from typing import Protocol

from matchset.camera.camera_model import CameraModel
from matchset.image.frame import Frame


class Camera(Protocol):
    """Where pictures come from.

    Attributes
    ----------
    model : CameraModel
    """

    model: CameraModel

    def read(self) -> Frame | None:
        """Return the newest picture; None if none came in the time of one."""

    def now(self) -> float:
        """Return the time on the clock of the pictures, s."""
