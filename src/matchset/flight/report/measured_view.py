"""The chain from above where nobody knows the truth: the cameras as the chain sees them: `MeasuredView`."""

import numpy as np
import numpy.typing as npt

from matchset.flight.chain.chain_step import ChainStep
from matchset.flight.report.chain_frame import camera_positions, set_places
from matchset.flight.report.colors import bgr, vehicle_rgb
from matchset.flight.report.top_view import BALL, INK, MARGIN, PAPER, TopView

Picture = npt.NDArray[np.uint8]
Floats = npt.NDArray[np.float64]


class MeasuredView(TopView):
    """A map around the last ball, which stands still in it, the chain looking to the right.

    Parameters
    ----------
    setup : FlightSetup
    size : tuple of two ints
        Width and height of the pictures, px.
    """

    def draw(self, chain_step: ChainStep) -> Picture:
        """Draw a step; steps must come in their order."""
        self._fit(chain_step)
        image = np.full((self._size[1], self._size[0], 3), PAPER, np.uint8)
        self._draw_grid(image)
        self._circle(image, np.zeros(2), BALL, bgr(vehicle_rgb(self._setup.followers)), 2)
        for number, position in enumerate(camera_positions(chain_step.steps)):
            if position is not None:
                self._paths[number].append(_flat(position))
            self._draw_path(image, number)
            if position is not None:
                self._ring(image, _flat(position), bgr(vehicle_rgb(number)))
        for place in set_places(self._setup):
            if place is not None:
                self._cross(image, _flat(place), INK)
        self._write(image)
        return image

    def _fit(self, chain_step: ChainStep) -> None:  # noqa: ARG002 - the scale is that of the set places
        """Choose the scale so that the chain fits, half of the picture for what is beside it."""
        places = [_flat(place) for place in set_places(self._setup) if place is not None]
        farthest = max((float(np.hypot(*place)) for place in places), default=1.0)
        width, height = self._size
        self._scale = min(width / (farthest + 2.0 * MARGIN), height / (farthest + 2.0 * MARGIN))
        self._middle = np.array((-farthest / 2.0, 0.0))


def _flat(position: Floats) -> Floats:
    """Take (3,), m, of the level frame of the last ball to the map: ahead, right; its z points back, its x left."""
    return np.asarray(-position[[2, 0]])
