"""The chain from above: `TopView` draws where everyone is, where they should be, and where they believe to be."""

import itertools
import math
from collections import deque

import cv2
import numpy as np
import numpy.typing as npt

from matchset.app.drawing.text import draw_text, text_width
from matchset.app.flight.flight import ChainStep, FlightSetup
from matchset.app.flight_report.chain_frame import camera_positions, chain_frame_to_room, level_ball_frame
from matchset.app.flight_report.colors import bgr, vehicle_rgb
from matchset.sim.vehicle import VehiclePose
from matchset.sim.world import camera_position

Picture = npt.NDArray[np.uint8]
Floats = npt.NDArray[np.float64]

PAPER, GRID, INK, PALE = (252, 252, 252), (236, 236, 236), (70, 70, 70), (160, 160, 160)
TRAIL = 120  # ticks
MARGIN = 0.65  # m before the first and behind the last set place
ASIDE = 0.25  # m beside the farthest that the last one's yaw swings the first
BALL = 0.14  # m, radius when drawn
_SHIFT = 4


class TopView:
    """A map of the room as a bird sees it, the chain looking to the right; it remembers the last seconds.

    Parameters
    ----------
    setup : FlightSetup
    size : tuple of two ints
        Width and height of the pictures, px.
    """

    def __init__(self, setup: FlightSetup, size: tuple[int, int]) -> None:
        self._setup, self._size = setup, size
        self._place = setup.parameters.pilot.place
        self._trails = [deque[Floats](maxlen=TRAIL) for _ in range(setup.followers + 1)]
        self._scale, self._middle = 1.0, np.zeros(2)

    def draw(self, chain_step: ChainStep) -> Picture:
        """Draw a tick; ticks must come in their order."""
        if not self._trails[0]:
            self._fit(chain_step)
        for trail, sight in zip(self._trails, chain_step.truth_at_exposure, strict=True):
            trail.append(sight.ball[[2, 0]])
        image = np.full((self._size[1], self._size[0], 3), PAPER, np.uint8)
        self._draw_grid(image)
        for number in range(len(chain_step.truth_at_exposure)):
            self._draw_trail(image, number)
        for me, other in itertools.pairwise(chain_step.truth_at_exposure):
            self._line(image, camera_position(me)[[2, 0]], other.ball[[2, 0]], PALE)
        for number, sight in enumerate(chain_step.truth_at_exposure):
            self._draw_vehicle(image, number, sight)
        for number, other in enumerate(chain_step.truth_at_exposure[1:]):
            self._draw_set_place(image, number, other)
        self._draw_estimates(image, chain_step)
        self._write(image)
        return image

    def _fit(self, chain_step: ChainStep) -> None:
        """Choose the scale so that the whole chain has room to swing with the last one's yaw."""
        world = self._setup.parameters.world
        along = np.array([sight.ball[2] for sight in chain_step.truth_at_exposure])
        width, height = self._size
        long = float(np.ptp(along)) + 2.0 * MARGIN
        wide = float(np.ptp(along)) * math.sin(math.radians(min(world.yaw_deg, 90.0))) + world.swing + ASIDE
        self._scale = min(width / long, height / (2.0 * wide))
        self._middle = np.array(
            (float(along.min() + along.max()) / 2.0, float(chain_step.truth_at_exposure[-1].ball[0]))
        )

    def _px(self, point: Floats) -> tuple[int, int]:
        """Where (z, x), m, is on the picture: z to the right, x down, in sixteenths of a px."""
        u, v = (point - self._middle) * self._scale + np.array(self._size) / 2.0
        return round(float(u) * (1 << _SHIFT)), round(float(v) * (1 << _SHIFT))

    def _line(self, image: Picture, a: Floats, b: Floats, color: tuple[int, int, int], wide: int = 1) -> None:
        cv2.line(image, self._px(a), self._px(b), color, wide, cv2.LINE_AA, _SHIFT)

    def _circle(self, image: Picture, at: Floats, radius: float, color: tuple[int, int, int], wide: int) -> None:
        cv2.circle(image, self._px(at), round(radius * self._scale * (1 << _SHIFT)), color, wide, cv2.LINE_AA, _SHIFT)

    def _draw_grid(self, image: Picture) -> None:
        """Lines every half meter."""
        half = np.array(self._size) / self._scale / 2.0
        for way in range(2):
            low, high = self._middle[way] - half[way], self._middle[way] + half[way]
            for value in 0.5 * np.arange(np.ceil(2.0 * low), np.floor(2.0 * high) + 1):
                a, b = self._middle - half, self._middle + half
                a[way] = b[way] = value
                self._line(image, a, b, GRID)

    def _draw_trail(self, image: Picture, number: int) -> None:
        trail, color = list(self._trails[number]), np.array(bgr(vehicle_rgb(number)), float)
        for k, (a, b) in enumerate(itertools.pairwise(trail)):
            share = 0.75 * (k + 1) / len(trail)
            shade = tuple(int(part) for part in share * color + (1.0 - share) * np.array(PAPER))
            self._line(image, a, b, shade, 2)  # type: ignore[arg-type]

    def _draw_set_place(self, image: Picture, number: int, other: VehiclePose) -> None:
        """Draw the set place of a follower's camera, a cross."""
        goal = other.ball + level_ball_frame(other) @ (self._place.side, -self._place.height, self._place.heading)
        at, color = goal[[2, 0]], bgr(vehicle_rgb(number))
        arms = (np.array((0.07, 0.0)), np.array((0.0, 0.07)))
        for shade, wide in ((PAPER, 4), (color, 2)):
            for arm in arms:
                self._line(image, at - arm, at + arm, shade, wide)

    def _draw_vehicle(self, image: Picture, number: int, sight: VehiclePose) -> None:
        """Draw the arms, the ball at its true size, and a nose that points forward."""
        color, at = bgr(vehicle_rgb(number)), sight.ball[[2, 0]]
        ahead, right = sight.rotation[[2, 0], 2], sight.rotation[[2, 0], 0]
        for way in (ahead + right, ahead - right):
            self._line(image, at - 0.15 * way, at + 0.15 * way, INK, 2)
        self._line(image, at, at + 0.3 * ahead, color, 3)
        self._circle(image, at, BALL, color, cv2.FILLED)
        words, size = str(number + 1), max(self._size[1] // 24, 11)
        x, y = (part / (1 << _SHIFT) for part in self._px(at - 0.27 * ahead))
        draw_text(image, words, (x - text_width(words, size) / 2.0, y), size, INK)

    def _draw_estimates(self, image: Picture, chain_step: ChainStep) -> None:
        """Draw rings where the cameras are by what all of the chain sees, carried on from the last ball."""
        for number, place in enumerate(camera_positions(chain_step.steps)):
            if place is not None:
                at = chain_frame_to_room(place, chain_step.truth_at_exposure[-1])[[2, 0]]
                self._circle(image, at, 0.07, PAPER, 4)
                self._circle(image, at, 0.07, bgr(vehicle_rgb(number)), 2)

    def _write(self, image: Picture) -> None:
        size = max(self._size[1] // 34, 10)
        words = ("from above, squares of 0.5 m", "+ set place of the camera    o where the chain sees that it is")
        for line, text in enumerate(words):
            draw_text(image, text, (0.8 * size, (1.2 + 1.5 * line) * size), size, INK)
