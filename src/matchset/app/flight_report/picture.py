"""A flight as pictures: every camera with what it saw, side by side, and the chain from above: `FlightPicture`."""

import math

import cv2
import numpy as np
import numpy.typing as npt

from matchset.app.flight.flight import Tick
from matchset.app.flight.setting import Setting
from matchset.app.flight_report.draw_step import annotate_step
from matchset.app.flight_report.top_view import TopView

Picture = npt.NDArray[np.uint8]

WIDEST = 1440  # px of all cells of a row together
EMPTY = 252


class FlightPicture:
    """Puts the pictures of a tick together, in a grid: the cameras in the order of the chain, then the map.

    Parameters
    ----------
    setting : Setting
    widest : int
        Width that the whole must not exceed, px; no cell gets larger than a camera's picture.

    Attributes
    ----------
    size : tuple of two ints
        Width and height of the whole, px, both even.
    """

    def __init__(self, setting: Setting, widest: int = WIDEST) -> None:
        self._setting = setting
        self._columns = _columns(setting.followers + 1)
        camera = setting.cameras[0]
        wide = min(camera.width, widest // self._columns) // 2 * 2
        self._cell = wide, round(wide * camera.height / camera.width) // 2 * 2
        rows = math.ceil((setting.followers + 1) / self._columns)
        self.size = self._cell[0] * self._columns, self._cell[1] * rows
        self._map = TopView(setting, self._cell)

    def draw(self, tick: Tick) -> Picture:
        """Draw a tick, BGR; ticks must come in their order, since the map shows paths."""
        cells = [self._fitted(annotate) for annotate in self._annotated(tick)]
        cells.append(self._map.draw(tick))
        whole = np.full((self.size[1], self.size[0], 3), EMPTY, np.uint8)
        wide, high = self._cell
        for number, cell in enumerate(cells):
            row, column = divmod(number, self._columns)
            whole[row * high : (row + 1) * high, column * wide : (column + 1) * wide] = cell
        return whole

    def _annotated(self, tick: Tick) -> list[Picture]:
        radius = self._setting.radius
        return [
            annotate_step(step, number, camera, radius)
            for number, (step, camera) in enumerate(zip(tick.steps, self._setting.cameras, strict=True), 1)
        ]

    def _fitted(self, picture: Picture) -> Picture:
        if (picture.shape[1], picture.shape[0]) == self._cell:
            return picture
        return np.asarray(cv2.resize(picture, self._cell, interpolation=cv2.INTER_AREA), np.uint8)


def _columns(cells: int) -> int:
    """How many cells stand in a row: up to three side by side, then as near to a square as it gets."""
    return cells if cells <= 3 else math.ceil(math.sqrt(cells))
