"""The chain from above: true positions, set places and estimated positions of all vehicles: `TopView`."""

import itertools
import math
from collections import deque

import cv2
import numpy as np
import numpy.typing as npt

from matchset.app.drawing.text import draw_text, text_width
from matchset.flight.chain.chain_step import ChainStep, FlightSetup
from matchset.flight.report.chain_frame import camera_positions, chain_frame_to_room, level_ball_frame
from matchset.flight.report.colors import bgr, vehicle_rgb
from matchset.sim.vehicle import VehiclePose
from matchset.sim.world import camera_position

Picture = npt.NDArray[np.uint8]
Floats = npt.NDArray[np.float64]

# format: BGR of the background, its lines, the text and vehicles, and the lines of sight
PAPER, GRID, INK, PALE = (252, 252, 252), (236, 236, 236), (70, 70, 70), (160, 160, 160)
PATH_LENGTH = 120  # format: steps that a path shows, 4 s
# geometry: m, free space before the first and behind the last vehicle, and beside the widest swing of the chain
MARGIN, SIDE_MARGIN = 0.65, 0.25
# geometry: m, radius of a drawn ball, of the ring around an estimated position, half a side of the cross at a set place
BALL, RING, CROSS = 0.14, 0.075, 0.045
SHIFT = 4  # format: fractional bits of the coordinates that OpenCV's drawing functions take


class TopView:
    """A map of the room seen from above, the chain looking to the right, with the paths of the last seconds.

    Parameters
    ----------
    setup : FlightSetup
    size : tuple of two ints
        Width and height of the pictures, px.
    """

    def __init__(self, setup: FlightSetup, size: tuple[int, int]) -> None:
        self._setup, self._size = setup, size
        self._place = setup.parameters.pilot.place
        self._paths = [deque[Floats](maxlen=PATH_LENGTH) for _ in range(setup.followers + 1)]
        self._scale, self._middle = 1.0, np.zeros(2)

    def draw(self, chain_step: ChainStep) -> Picture:
        """Draw a step; steps must come in their order."""
        if not self._paths[0]:
            self._fit(chain_step)
        for path, vehicle in zip(self._paths, chain_step.truth_at_exposure, strict=True):
            path.append(vehicle.ball[[2, 0]])
        image = np.full((self._size[1], self._size[0], 3), PAPER, np.uint8)
        self._draw_grid(image)
        for number in range(len(chain_step.truth_at_exposure)):
            self._draw_path(image, number)
        for me, other in itertools.pairwise(chain_step.truth_at_exposure):
            self._line(image, camera_position(me)[[2, 0]], other.ball[[2, 0]], PALE)
        for number, vehicle in enumerate(chain_step.truth_at_exposure):
            self._draw_vehicle(image, number, vehicle)
        self._draw_estimates(image, chain_step)
        for other in chain_step.truth_at_exposure[1:]:
            self._draw_set_place(image, other)
        self._write(image)
        return image

    def _fit(self, chain_step: ChainStep) -> None:
        """Choose the scale so that the whole chain fits, also when it swings with the yaw of the last vehicle."""
        world = self._setup.parameters.world
        along = np.array([vehicle.ball[2] for vehicle in chain_step.truth_at_exposure])
        width, height = self._size
        long = float(np.ptp(along)) + 2.0 * MARGIN
        wide = float(np.ptp(along)) * math.sin(math.radians(min(world.yaw_deg, 90.0))) + world.swing + SIDE_MARGIN
        self._scale = min(width / long, height / (2.0 * wide))
        self._middle = np.array(
            (float(along.min() + along.max()) / 2.0, float(chain_step.truth_at_exposure[-1].ball[0]))
        )

    def _px(self, point: Floats) -> tuple[int, int]:
        """Pixel of (z, x), m: z to the right, x down; in sixteenths of a px."""
        u, v = (point - self._middle) * self._scale + np.array(self._size) / 2.0
        return round(float(u) * (1 << SHIFT)), round(float(v) * (1 << SHIFT))

    def _line(self, image: Picture, a: Floats, b: Floats, color: tuple[int, int, int], wide: int = 1) -> None:
        cv2.line(image, self._px(a), self._px(b), color, wide, cv2.LINE_AA, SHIFT)

    def _circle(self, image: Picture, at: Floats, radius: float, color: tuple[int, int, int], wide: int) -> None:
        cv2.circle(image, self._px(at), round(radius * self._scale * (1 << SHIFT)), color, wide, cv2.LINE_AA, SHIFT)

    def _draw_grid(self, image: Picture) -> None:
        """Lines every half meter."""
        half = np.array(self._size) / self._scale / 2.0
        for axis in range(2):
            low, high = self._middle[axis] - half[axis], self._middle[axis] + half[axis]
            for value in 0.5 * np.arange(np.ceil(2.0 * low), np.floor(2.0 * high) + 1):
                a, b = self._middle - half, self._middle + half
                a[axis] = b[axis] = value
                self._line(image, a, b, GRID)

    def _draw_path(self, image: Picture, number: int) -> None:
        """Draw the true path of the last seconds, older parts paler."""
        path, color = list(self._paths[number]), np.array(bgr(vehicle_rgb(number)), float)
        for k, (a, b) in enumerate(itertools.pairwise(path)):
            share = 0.75 * (k + 1) / len(path)
            shade = tuple(int(part) for part in share * color + (1.0 - share) * np.array(PAPER))
            self._line(image, a, b, shade, 2)  # type: ignore[arg-type]

    def _draw_set_place(self, image: Picture, other: VehiclePose) -> None:
        """Draw the set place of a follower's camera, a cross."""
        place = other.ball + level_ball_frame(other) @ (self._place.side, -self._place.height, self._place.heading)
        self._cross(image, place[[2, 0]], INK)

    def _cross(self, image: Picture, at: Floats, color: tuple[int, int, int], size: float = CROSS) -> None:
        for shade, wide in ((PAPER, 4), (color, 2)):
            for arm in (np.array((size, 0.0)), np.array((0.0, size))):
                self._line(image, at - arm, at + arm, shade, wide)

    def _ring(self, image: Picture, at: Floats, color: tuple[int, int, int], size: float = RING) -> None:
        for shade, wide in ((PAPER, 5), (color, 2)):
            self._circle(image, at, size, shade, wide)

    def _draw_vehicle(self, image: Picture, number: int, vehicle: VehiclePose) -> None:
        """Draw the arms, the ball at its true size, and a nose that points forward."""
        color, at = bgr(vehicle_rgb(number)), vehicle.ball[[2, 0]]
        ahead, right = vehicle.rotation[[2, 0], 2], vehicle.rotation[[2, 0], 0]
        for arm in (ahead + right, ahead - right):
            self._line(image, at - 0.15 * arm, at + 0.15 * arm, INK, 2)
        self._line(image, at, at + 0.3 * ahead, color, 3)
        self._circle(image, at, BALL, _pale(color), cv2.FILLED)
        self._circle(image, at, BALL, color, 2)
        name, size = str(number + 1), max(self._size[1] // 20, self._size[0] // 45, 12)
        x, y = (part / (1 << SHIFT) for part in self._px(at - 0.30 * ahead))
        draw_text(image, name, (x - text_width(name, size) / 2.0, y), size, INK)

    def _draw_estimates(self, image: Picture, chain_step: ChainStep) -> None:
        """Draw rings at the positions of the cameras as estimated along the chain, from the last ball on."""
        for number, position in enumerate(camera_positions(chain_step.steps)):
            if position is not None:
                at = chain_frame_to_room(position, chain_step.truth_at_exposure[-1])[[2, 0]]
                self._ring(image, at, bgr(vehicle_rgb(number)))

    def _write(self, image: Picture) -> None:
        """Say what is seen, and what the marks mean; in two lines where one has no room."""
        size = max(self._size[1] // 26, self._size[0] // 50, 11)
        draw_text(image, "from above, squares of 0.5 m", (0.8 * size, 1.2 * size), size, INK)
        x, y = 0.8 * size, 2.9 * size
        for mark, words in ((self._cross, "where the camera should be"), (self._ring, "where the chain sees it")):
            if x > size and x + 2.2 * size + text_width(words, size) > self._size[0]:
                x, y = 0.8 * size, y + 1.7 * size
            mark(image, self._point(x + 0.6 * size, y), INK, 0.5 * size / self._scale)
            draw_text(image, words, (x + 1.6 * size, y), size, INK)
            x += 3.5 * size + text_width(words, size)

    def _point(self, u: float, v: float) -> Floats:
        """Undo `_px`: (z, x), m, of a place in the picture, px."""
        return np.asarray((np.array((u, v)) - np.array(self._size) / 2.0) / self._scale + self._middle)


def _pale(color: tuple[int, int, int]) -> tuple[int, int, int]:
    """Mix a color with three parts of the background."""
    blue, green, red = (round(0.3 * part + 0.7 * paper) for part, paper in zip(color, PAPER, strict=True))
    return blue, green, red
