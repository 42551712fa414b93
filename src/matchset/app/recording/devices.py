"""A camera and a link that say again what was recorded: they cannot be told from real ones, and move nothing."""

from types import TracebackType
from typing import Self

from matchset.camera.camera_model import CameraModel
from matchset.control.command import Command
from matchset.image.frame import Frame
from matchset.links.link import LinkStatus


class RecordedCamera:
    """Delivers the picture that it was given, at the time that was recorded.

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


class RecordedLink:
    """Answers what the real link answered; implements `matchset.links.link.Link`, and moves nothing.

    Attributes
    ----------
    confirmed : Command
        What the link confirmed when the step was recorded.
    """

    def __init__(self, number: int) -> None:
        self.uri = f"recording://{number}"
        self.confirmed = Command()

    def arm(self) -> None:
        """Nothing is there to be armed."""

    def send(self, command: Command) -> Command:  # noqa: ARG002 - what was wanted stands in the step's memory
        """Return what was confirmed."""
        return self.confirmed

    def status(self) -> LinkStatus:
        """Return that this is a recording."""
        return LinkStatus("locked", "recording", 0, 0.0)

    def land(self, duration: float = 1.5) -> None:
        """Nothing is there to land."""

    def close(self) -> None:
        """Nothing is there to let go of."""

    def __enter__(self) -> Self:
        """Return the link."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Nothing is there to let go of."""
