"""A camera and a link for the steps that a pilot takes before it is armed: `RehearsalCamera`, `RehearsalLink`.

A first step takes longer than any other: code is loaded, memory is touched for the first time, libraries set themselves
up. In the air that time may be longer than the transmitter's failsafe.
"""

import cv2
import numpy as np
import numpy.typing as npt

from matchset.camera.camera_model import CameraModel
from matchset.control.command import Command
from matchset.image.color import ColorModel
from matchset.image.color_learning import bin_centers
from matchset.image.frame import Frame
from matchset.links.link import Link, LinkStatus
from matchset.localization.ball_target import BallTarget

Picture = npt.NDArray[np.uint8]

FPS = 30.0  # format: pictures a second
# format: what the pictures show, in turn: nothing, the ball, the ball without its marker, the ball elsewhere
SHOWN = ("nothing", "ball", "ball", "plain", "nothing", "ball", "elsewhere", "elsewhere", "elsewhere", "elsewhere")


class RehearsalCamera:
    """Pictures of the camera's size with a painted ball, as a flight may bring them: seen, without marker, lost.

    Parameters
    ----------
    model : CameraModel
    ball, marker : ColorModel
        Of the ball with its marker, and of the marker.
    target : BallTarget
    position : tuple of 3 floats
        Of the ball's center in the camera frame, m.
    """

    def __init__(
        self,
        model: CameraModel,
        ball: ColorModel,
        marker: ColorModel,
        target: BallTarget,
        position: tuple[float, float, float],
    ) -> None:
        self.model, self._index = model, 0
        self._pictures = _pictures(model, (ball, marker), target, np.array(position))

    def __len__(self) -> int:
        """Return how many pictures it has."""
        return len(SHOWN)

    def read(self) -> Frame | None:
        """Return the next picture; None after the last."""
        self._index += 1
        if self._index > len(SHOWN):
            return None
        picture = self._pictures[SHOWN[self._index - 1]].copy()
        picture[:, 0] = self._index  # none comes twice
        return Frame(picture, self._index / FPS, self._index)

    def now(self) -> float:
        """Return the time on the clock of the pictures, s."""
        return (self._index + 1) / FPS


class RehearsalLink(Link):
    """A link to nobody; implements `matchset.links.link.Link`."""

    uri = "rehearsal://"

    def arm(self) -> None:
        """Do nothing."""

    def send(self, command: Command) -> Command:
        """Return the command."""
        return command

    def status(self) -> LinkStatus:
        """Return that it is armed."""
        return LinkStatus("armed", "rehearsal", 0, 0.0)

    def cut(self) -> None:
        """Do nothing."""

    def land(self, duration: float = 1.5) -> None:
        """Do nothing."""

    def close(self) -> None:
        """Do nothing."""


def _pictures(
    model: CameraModel, colors: tuple[ColorModel, ColorModel], target: BallTarget, position: npt.NDArray[np.float64]
) -> dict[str, Picture]:
    """Paint the pictures; the colors are those of the ball with its marker, and of the marker."""
    ball, marker = (each.log_odds for each in colors)
    values = bin_centers() if colors[0].channels == 3 else np.arange(256.0)[:, np.newaxis]
    background, blue, purple = (
        np.rint(values[k]).tolist() for k in (ball.argmin(), (ball - marker).argmax(), marker.argmax())
    )
    plain = np.empty((model.height, model.width, len(background)), np.uint8)
    plain[:] = background
    if not model.visible(position[np.newaxis])[0]:
        position = np.array((0.0, 0.0, float(np.linalg.norm(position))))
    x, y = model.project(position[np.newaxis])[0]
    scale = model.fx / float(np.linalg.norm(position))
    pictures: dict[str, Picture] = {"nothing": plain}
    for name, center in (("plain", (x, y)), ("ball", (x, y)), ("elsewhere", (x + 3.0 * scale * target.radius, y))):
        picture = plain.copy()
        _disc(picture, center, scale * target.radius, blue)
        if name != "plain":
            _disc(picture, center, 0.5 * scale * target.marker_diameter, purple)
        pictures[name] = picture
    return {name: each if each.shape[2] == 3 else each[:, :, 0] for name, each in pictures.items()}


def _disc(picture: Picture, center: tuple[float, float], radius: float, color: list[float]) -> None:
    at = round(16.0 * center[0]), round(16.0 * center[1])
    cv2.circle(picture, at, round(16.0 * radius), color, cv2.FILLED, cv2.LINE_AA, shift=4)
