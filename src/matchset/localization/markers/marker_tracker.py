"""The ball's markers, found inside its outline and followed from frame to frame: `MarkerTracker`."""

import math

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.localization.ball_target import BallTarget
from matchset.localization.markers import marker_step as marker_follow
from matchset.localization.markers.marker_color import look
from matchset.localization.markers.marker_step import (
    AT,
    EXPLAINED,
    FOUND,
    OUTLINE,
    RIM,
    SPREAD,
    WIDE,
    follow_markers,
    is_alone,
)
from matchset.shapes.circle import Circle
from matchset.tracking.detect import channels_last
from matchset.tracking.track import Lost, Track

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]

GRID = 48  # cells across the ball in which markers are looked for at first


class MarkerParameters(msgspec.Struct, frozen=True):
    """How markers are found.

    Parameters
    ----------
    soft : float
        Softness of a marker's rim, px: 1.8 times less than the standard deviation of the picture's blur. Blur that
        was assumed wrong moves only markers at the ball's rim.
    least_size : float
        Least size of a patch of the color at first sight, as a share of the marker's area.
    least_height : float
        Least contrast of a marker, as a share of what was seen at first.
    least_explained : float
        Least share of the variance around a marker that the marker explains.
    farthest : float
        How far from the ball's middle a marker may be, in ball radii: 0.95 is 72 degrees off the line of sight.
    patience : int
        For how many frames a marker that is not seen is expected where it was last.
    memory : float
        Share of what is known of the colors that one frame leaves.
    inflation : float
        By how much the covariance of independent pixels is enlarged: what filters leave of the noise is alike over
        several lines.
    floor : float
        Least standard deviation of a marker's place, px.
    """

    soft: float = 0.7
    least_size: float = 0.1
    least_height: float = 0.4
    least_explained: float = 0.3
    farthest: float = 0.95
    patience: int = 5
    memory: float = 0.9
    inflation: float = 4.0
    floor: float = 0.15


class MarkerTracker:
    """Follows the markers of one ball, wherever on it they are.

    At first, and while not all are seen, patches of the marker's color are looked for inside the ball. Each is then
    placed by comparing the picture with the ellipse that the marker must show there, along the direction of color that
    tells marker and ball apart in these very frames, so light may change.

    Parameters
    ----------
    color : ColorModel
        The color of the markers alone (the paper's filter b).
    target : BallTarget
        The ball; how many markers there are and how large.
    parameters : MarkerParameters, optional
    """

    def __init__(self, color: ColorModel, target: BallTarget, parameters: MarkerParameters | None = None) -> None:
        self.color, self.target = color, target
        self.parameters = parameters or MarkerParameters()
        self._size = target.marker_diameter / target.diameter
        self._depth = target.marker_distance / target.radius
        self._places: Floats = np.zeros((0, 2))  # of the markers, from the ball's middle, in ball radii
        self._known: Floats = np.zeros(marker_follow.KNOWN)  # of colors and noise
        limits = self.parameters
        asked = limits.soft, limits.least_height, limits.least_explained, limits.farthest, limits.memory
        ball = 0.0, 0.0, 0.0, 0.0  # of the frame
        self._numbers = np.array((*ball, self._size, self._depth, *asked, limits.inflation, limits.floor))
        self._missed: list[int] = []  # frames for which each of them has not been seen
        precompile(color)

    def update(self, frame: Frame, ball: Track[Circle] | Lost[Circle]) -> tuple[Track[Circle], ...]:
        """Find the markers in a frame.

        Parameters
        ----------
        frame : Frame
        ball : Track or Lost
            The ball in the same frame.

        Returns
        -------
        tuple of Track
            One for each marker in sight, in no order; none if the ball is lost. A marker's circle has the center and
            the area of the ellipse in which its rim is seen.

        Raises
        ------
        ValueError
            If the color was learned on another kind of picture.
        """
        self.color.check(frame.image)
        if isinstance(ball, Lost):
            self._places, self._missed = np.zeros((0, 2)), []
            return ()
        image = channels_last(frame.image)
        if self._missed.count(0) < len(self.target.markers):
            self._look(image, ball.shape)
        if not self._missed:
            return ()
        return self._follow(image, ball)

    def _look(self, image: Image, ball: Circle) -> None:
        """Add patches of the color that are not known yet."""
        x, y, radius = float(ball.x), float(ball.y), float(ball.radius)
        step = max(round(2.0 * radius / GRID), 1)
        cells = int(2.0 * radius / step) + 2
        mask = np.zeros((cells, cells), np.uint8)
        left, top = look(image, self.color.table, x, y, 0.97 * radius, step, mask)
        count, _, stats, centers = cv2.connectedComponentsWithStats(mask, connectivity=4)
        whole = math.pi * (self._size * radius / step) ** 2
        found = sorted(range(1, count), key=lambda k: -int(stats[k, cv2.CC_STAT_AREA]))
        for k in found:
            place = ((left, top) + step * centers[k] - (x, y)) / radius
            squeezed = math.sqrt(max(1.0 - float(place @ place), 0.05))
            if self._missed.count(0) == len(self.target.markers):
                break
            if not self.parameters.least_size * squeezed < stats[k, cv2.CC_STAT_AREA] / whole < 4.0:
                continue
            if is_alone(place, self._places, len(self._places), self._size):
                self._places = np.vstack((place, self._places))
                self._missed.insert(0, 0)

    def _follow(self, image: Image, ball: Track[Circle]) -> tuple[Track[Circle], ...]:
        """Place every marker; expect those that are not there for a while, then forget them."""
        circle, places, missed, numbers = ball.shape, self._places, self._missed, self._numbers
        numbers[0], numbers[1], numbers[2] = circle.x, circle.y, circle.radius
        numbers[SPREAD] = ball.covariance[2, 2]
        found = np.empty((len(missed), FOUND))
        count = follow_markers(image, numbers, missed.count(0), places, self._known, found)
        if count < len(missed):
            self._expect(count, [int(row) for row in found[count:, 0]])
        else:
            self._missed = [0] * count
        return tuple(_track(found[k], ball.time) for k in range(count))

    def _expect(self, count: int, unseen: list[int]) -> None:
        """Go on with the markers that were found, the first ones, and those that will soon be seen again."""
        places, patience = self._places, self.parameters.patience
        kept, missed = list(range(count)), [0] * count
        for k, former in enumerate(unseen, count):
            if self._missed[former] < patience and is_alone(places[k], places, count, self._size):
                kept.append(k)
                missed.append(self._missed[former] + 1)
        self._places, self._missed = places[kept], missed


def precompile(color: ColorModel) -> None:
    """Compile the kernels of a marker tracker, so that no frame waits for them."""
    image, known = np.zeros((3, 3, color.channels), np.uint8), np.zeros(marker_follow.KNOWN)
    look(image, color.table, 1.0, 1.0, 1.0, 1, np.zeros((1, 1), np.uint8))
    is_alone(np.zeros(2), np.zeros((1, 2)), 0, 1.0)
    follow_markers(image, np.ones(marker_follow.NUMBERS), 0, np.zeros((0, 2)), known, np.empty((0, FOUND)))


def _track(found: Floats, time: float) -> Track[Circle]:
    """Answer with a marker: the circle of its ellipse's area, and its rim for a match-set."""
    radius, explained, x, y = found.item(0), found.item(EXPLAINED), found.item(AT), found.item(AT + 1)
    wide, rim = found[WIDE:OUTLINE].reshape(3, 3), found[OUTLINE:AT].reshape(RIM, 2)
    return Track(Circle(x, y, radius), wide, explained, rim, time)
