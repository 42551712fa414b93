"""A camera and a link that repeat what was recorded; a `Pilot` cannot tell them from real ones."""

from matchset.camera.camera_model import CameraModel
from matchset.control.command import Command
from matchset.image.frame import Frame
from matchset.links.link import Link, LinkStatus


class RecordedCamera:
    """A camera that returns the recorded picture and the recorded time; both are set before each step.

    Attributes
    ----------
    model : CameraModel
    frame : Frame or None
    time : float
    """

    def __init__(self, model: CameraModel) -> None:
        self.model = model
        self.frame: Frame | None = None
        self.time = 0.0

    def read(self) -> Frame | None:
        """Return the recorded picture; None if none came."""
        return self.frame

    def now(self) -> float:
        """Return the recorded time, s."""
        return self.time


class RecordedLink(Link):
    """A link that confirms the recorded command; implements `matchset.links.link.Link`. Nothing moves.

    Attributes
    ----------
    confirmed : Command
        What the link confirmed when the step was recorded.
    """

    def __init__(self, number: int) -> None:
        self.uri = f"recording://{number}"
        self.confirmed = Command()

    def arm(self) -> None:
        """Do nothing."""

    def send(self, command: Command) -> Command:  # noqa: ARG002 - the safety state of the step has it
        """Return what was confirmed."""
        return self.confirmed

    def status(self) -> LinkStatus:
        """Return that it flies: where the recorded one refused, the replay stops the pilot itself."""
        return LinkStatus("armed", "recording", 0, 0.0)

    def cut(self) -> None:
        """Do nothing."""

    def land(self, duration: float = 1.5) -> None:
        """Do nothing."""

    def close(self) -> None:
        """Do nothing."""
