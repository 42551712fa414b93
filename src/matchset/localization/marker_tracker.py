"""The ball's markers, found inside its outline and followed from frame to frame: `MarkerTracker`."""

import math
from collections.abc import Iterable, Sequence

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.localization.marker_fit import fit_marker
from matchset.localization.marker_look import blend, look, teach, tell_apart
from matchset.localization.marker_shape import describe
from matchset.localization.target import BallTarget
from matchset.shapes.circle import Circle
from matchset.tracking.detect import channels_last
from matchset.tracking.track import Lost, Track

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]
Place = tuple[float, float]

GRID = 48  # cells across the ball in which markers are looked for at first
RIM = 16  # points of a marker's match-set


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
        self._sums: Floats = np.zeros((2, 10))
        self._axis, self._ground = np.zeros(4), np.zeros(3)
        self._tied: Floats = np.zeros(1)  # what `fit_marker` knows of the noise
        self._missed: list[int] = []  # frames for which each of them has not been seen

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
        circle = np.array([ball.shape.x, ball.shape.y, ball.shape.radius])
        if len(self._places) - sum(missed > 0 for missed in self._missed) < len(self.target.markers):
            self._look(image, circle)
        if len(self._places) == 0:
            return ()
        places = np.ascontiguousarray(circle[:2] + circle[2] * self._places)
        self._teach(image, circle, places)
        return self._follow(image, circle, places, ball)

    def _look(self, image: Image, circle: Floats) -> None:
        """Add patches of the color that are not known yet."""
        radius = float(circle[2])
        step = max(round(2.0 * radius / GRID), 1)
        cells = int(2.0 * radius / step) + 2
        mask = np.zeros((cells, cells), np.uint8)
        left, top = look(image, self.color.table, float(circle[0]), float(circle[1]), 0.97 * radius, step, mask)
        count, _, stats, centers = cv2.connectedComponentsWithStats(mask, connectivity=4)
        whole = math.pi * (self._size * radius / step) ** 2
        found = sorted(range(1, count), key=lambda k: -int(stats[k, cv2.CC_STAT_AREA]))
        for k in found:
            place = ((left, top) + step * centers[k] - circle[:2]) / radius
            squeezed = math.sqrt(max(1.0 - float(place @ place), 0.05))
            if len(self._places) - sum(missed > 0 for missed in self._missed) == len(self.target.markers):
                break
            if not self.parameters.least_size * squeezed < stats[k, cv2.CC_STAT_AREA] / whole < 4.0:
                continue
            if _alone(place.tolist(), self._places.tolist(), self._size):
                self._places = np.vstack((place, self._places))
                self._missed.insert(0, 0)

    def _teach(self, image: Image, circle: Floats, places: Floats) -> None:
        """Learn which direction of color tells marker from ball: Fisher's linear discriminant."""
        sums = np.empty((2, 10))
        step = max(int(circle[2] / 12.0), 1)
        count = self._missed.count(0)  # those that were seen in the last frame come first
        teach(image, circle, places, count, self._size, self._depth, step, sums)
        if blend(self._sums, sums, self.parameters.memory):
            tell_apart(self._sums, self._axis, self._ground)

    def _follow(self, image: Image, circle: Floats, places: Floats, ball: Track[Circle]) -> tuple[Track[Circle], ...]:
        """Place every marker; expect those that are not there for a while, then forget them."""
        tracks: list[Track[Circle]] = []
        kept: list[Place] = []
        unseen: list[int] = []
        limits, before, (x, y, radius) = self.parameters, self._places.tolist(), circle.tolist()
        for k in range(len(places)):
            covariance = np.zeros((2, 2))
            height, _, explained = fit_marker(
                image,
                circle,
                places,
                len(places),
                k,
                self._size,
                self._depth,
                limits.soft,
                self._axis,
                self._ground,
                self._tied,
                covariance,
            )
            place = (places.item(k, 0) - x) / radius, (places.item(k, 1) - y) / radius
            if (
                height < limits.least_height
                or explained < limits.least_explained
                or not math.hypot(*place) < limits.farthest * self._depth
                or not _alone(place, kept, self._size)
            ):
                places[k] = x + radius * before[k][0], y + radius * before[k][1]
                unseen.append(k)
                continue
            kept.append(place)
            tracks.append(self._track(places[k], circle, covariance, explained, ball))
        hoped = [k for k in unseen if self._missed[k] < limits.patience and _alone(before[k], kept, self._size)]
        self._missed = [0] * len(kept) + [self._missed[k] + 1 for k in hoped]
        self._places = np.array([*kept, *(before[k] for k in hoped)]).reshape(-1, 2)
        return tuple(tracks)

    def _track(
        self, at: Floats, circle: Floats, covariance: Floats, explained: float, ball: Track[Circle]
    ) -> Track[Circle]:
        """Answer with a marker: the circle of its ellipse's area, and its rim for a match-set."""
        limits, rim, wide = self.parameters, np.empty((RIM, 2)), np.empty((3, 3))
        covariance *= limits.inflation
        covariance[0, 0] += limits.floor**2
        covariance[1, 1] += limits.floor**2
        spread = ball.covariance.item(2, 2)
        radius = describe(at, circle, self._size, self._depth, covariance, spread, rim, wide)
        return Track(Circle(at.item(0), at.item(1), radius), wide, explained, rim, ball.time)


def _alone(place: Sequence[float], others: Iterable[Sequence[float]], apart: float) -> bool:
    """Whether no other marker is nearer than `apart`."""
    return all(math.dist(place, other) > apart for other in others)
