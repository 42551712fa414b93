"""A frame of the video of a flight: every camera with what was measured in it, and the map: `FlightPicture`."""

import math

import cv2
import numpy as np
import numpy.typing as npt

from matchset.app.drawing.annotate import Caption, as_color, write_captions
from matchset.app.drawing.text import draw_text
from matchset.app.locate.annotate_pose import draw_located
from matchset.camera.camera_model import CameraModel
from matchset.flight.chain.chain_step import ChainStep, FlightSetup
from matchset.flight.chain.pilot import PilotStep
from matchset.flight.report.measured_view import MeasuredView
from matchset.flight.report.step_text import age_text, position_text, state_text
from matchset.flight.report.top_view import TopView

Picture = npt.NDArray[np.uint8]

# geometry: largest width of the whole, px
MAX_WIDTH = 1440
EMPTY, DARK = 252, 30  # format: gray of an empty cell, and of a camera without a picture


class FlightPicture:
    """Puts the pictures of a step together in a grid: the cameras in the order of the chain, then the map.

    Parameters
    ----------
    setup : FlightSetup
    widest : int
        Largest width of the whole, px; no cell is larger than a camera's picture.

    Attributes
    ----------
    size : tuple of two ints
        Width and height of the whole, px, both even.
    """

    def __init__(self, setup: FlightSetup, widest: int = MAX_WIDTH) -> None:
        self._setup = setup
        self._columns = _columns(setup.followers + 1)
        camera = setup.cameras[0]
        width = min(camera.width, widest // self._columns) // 2 * 2
        self._cell = width, round(width * camera.height / camera.width) // 2 * 2
        rows = math.ceil((setup.followers + 1) / self._columns)
        self.size = self._cell[0] * self._columns, self._cell[1] * rows
        self._map: TopView = (TopView if setup.has_truth else MeasuredView)(setup, self._cell)

    def draw(self, chain_step: ChainStep) -> Picture:
        """Draw a step, BGR; steps must come in their order, since the map shows paths."""
        cells = [self._fitted(picture) for picture in self._annotated(chain_step)]
        cells.append(self._map.draw(chain_step))
        whole = np.full((self.size[1], self.size[0], 3), EMPTY, np.uint8)
        width, height = self._cell
        for number, cell in enumerate(cells):
            row, column = divmod(number, self._columns)
            whole[row * height : (row + 1) * height, column * width : (column + 1) * width] = cell
        return whole

    def _annotated(self, chain_step: ChainStep) -> list[Picture]:
        radius = self._setup.radius
        return [
            annotate_step(step, number, camera, radius)
            for number, (step, camera) in enumerate(zip(chain_step.steps, self._setup.cameras, strict=True), 1)
        ]

    def _fitted(self, picture: Picture) -> Picture:
        if (picture.shape[1], picture.shape[0]) == self._cell:
            return picture
        return np.asarray(cv2.resize(picture, self._cell, interpolation=cv2.INTER_AREA), np.uint8)


def _columns(cells: int) -> int:
    """Count the cells of a row: up to three side by side, then as near to a square as possible."""
    return cells if cells <= 3 else math.ceil(math.sqrt(cells))


def annotate_step(step: PilotStep, number: int, camera: CameraModel, radius: float, captions: bool = True) -> Picture:
    """Draw a step of a follower's loop into a copy of its picture.

    Parameters
    ----------
    step : PilotStep
    number : int
        Of the follower, from 1.
    camera : CameraModel
        Model of the camera that took it.
    radius : float
        Of the ball, m.
    captions : bool
        Whether to write the follower, the phase of the safety filter and the estimated position below.

    Returns
    -------
    ndarray of shape (h, w, 3), uint8
        BGR: the ball's outline with its match-set, dashed where it is predicted; its markers, axes and distance. All
        dark where no picture came.
    """
    image = _picture(step, camera)
    draw_located(image, step.ball, step.markers, step.pose, camera, radius)
    if captions:
        _write(image, step, number)
    return image


def _write(image: Picture, step: PilotStep, number: int) -> None:
    bad = step.safety.phase != "flying"
    write_captions(
        image,
        Caption(f"{number} watches {number + 1}   {state_text(step)}", f"{step.now:.2f} s", bad),
        Caption(position_text(step.control), f"age {age_text(step.age)}", bad),
    )


def _picture(step: PilotStep, camera: CameraModel) -> Picture:
    if step.frame is not None:
        return as_color(step.frame.image)
    image = np.full((camera.height, camera.width, 3), DARK, np.uint8)
    draw_text(image, "no picture came", (0.38 * camera.width, 0.45 * camera.height), max(camera.height // 24, 10))
    return image
