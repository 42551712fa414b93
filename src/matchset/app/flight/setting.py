"""What a flight's ticks do not say of it, because it does not change: `Setting`."""

from typing import NamedTuple

from matchset.app.flight.flight import Flight, FlightParameters
from matchset.camera.camera_model import CameraModel
from matchset.image.frame import Frame


class Setting(NamedTuple):
    """What is true for a whole flight, one that is flown or one that is replayed.

    Attributes
    ----------
    parameters : FlightParameters
    cameras : tuple of CameraModel
        One per follower.
    samples : tuple of Frame
        The pictures from which each follower learned its colors.
    """

    parameters: FlightParameters
    cameras: tuple[CameraModel, ...]
    samples: tuple[Frame, ...]

    @property
    def followers(self) -> int:
        """How many watch another."""
        return len(self.cameras)

    @property
    def radius(self) -> float:
        """Of the balls, m."""
        return self.parameters.pilot.target.radius


def setting_of(flight: Flight) -> Setting:
    """Tell the setting of a flight that is about to be flown."""
    return Setting(flight.parameters, tuple(pilot.camera.model for pilot in flight.pilots), flight.samples)
