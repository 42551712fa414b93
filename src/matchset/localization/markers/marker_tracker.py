"""The ball's markers, found inside its outline and followed from frame to frame: `MarkerTracker`."""

import math

import cv2
import numpy as np
import numpy.typing as npt
from msgspec.structs import replace

from matchset.image.color import ColorModel
from matchset.image.frame import Picture, channels_last, frame_of
from matchset.localization.ball_target import BallTarget
from matchset.localization.markers.field_places import FieldPlaces
from matchset.localization.markers.marker_color import mark_color
from matchset.localization.markers.marker_step import follow_markers
from matchset.localization.markers.marker_workspace import CAPACITY, MARKERS, MarkerParameters
from matchset.numeric.arguments import check_kind
from matchset.numeric.copies import Copied
from matchset.numeric.record import fields, new_block, store
from matchset.numeric.words import one_line
from matchset.shapes.circle import Circle
from matchset.tracking.track import Lost, Track

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]


class MarkerTracker(Copied):
    """Follows the markers of one ball, wherever on it they are.

    At first, and while not all are seen, patches of the marker's color are searched inside the ball. Each is then
    placed by comparing the image with the ellipse that the marker must show there, along the direction of color that
    separates marker and ball in these very frames, so light may change. Its kernels are compiled here; `update`
    compiles nothing.

    Parameters
    ----------
    color : ColorModel
        The color of the markers alone (the paper's filter b).
    target : BallTarget
        The ball; how many markers there are and how large.
    parameters : MarkerParameters, optional

    Raises
    ------
    ValueError
        If the ball has no marker.
    """

    def __init__(self, color: ColorModel, target: BallTarget, parameters: MarkerParameters | None = None) -> None:
        check_kind("color", color, ColorModel)
        check_kind("target", target, BallTarget)
        check_kind("parameters", parameters, (MarkerParameters, type(None)))
        target.require_markers("MarkerTracker")
        self.color, self.target = color, target
        self.parameters = parameters or MarkerParameters()
        self._separation = target.marker_diameter / target.diameter  # radius of a marker, in ball radii
        self._places = FieldPlaces()
        self._missed: list[int] = []  # frames for which each of the markers has not been seen
        self._block = new_block(MARKERS)
        work = fields(self._block, MARKERS)
        store(work.limits, self.parameters)
        work.patch_radius, work.rim_distance = self._separation, target.marker_distance / target.radius
        self._make_derived()

    def _derive(self) -> None:
        work = fields(self._block, MARKERS)
        # What every frame reads or writes; an array of NumPy is reached faster than the fields of a record.
        whole = self._block.view(MARKERS)
        self._count, self._seen, ball = whole["count"], whole["seen"], whole["ball"]  # each has one element
        self._ball = ball["x"], ball["y"], ball["radius"], ball["radius_variance"]
        self._fields = ball["field_x"], ball["field_y"]
        self._offsets, self._order, self._middle = work.offsets, work.order, work.middle
        self._radius, self._explained, self._covariance, self._rim = (
            work.radius,
            work.explained,
            work.covariance,
            work.rim,
        )
        self._precompile()

    def _precompile(self) -> None:
        """Compile the kernels, so that no frame waits for them."""
        image, block = np.zeros((3, 3, self.color.channels), np.uint8), new_block(MARKERS)
        fields(block, MARKERS).ball.radius = 1.0
        mark_color(image, self.color.table, (1.0, 1.0, 1.0), (0.0, 0.0), 1, np.zeros((1, 1), np.uint8))
        follow_markers(image, block)

    @one_line
    def __repr__(self) -> str:
        return f"MarkerTracker({self._missed.count(0)} of {len(self.target.markers)} markers in sight)"

    def update(self, frame: Picture, ball: Track[Circle] | Lost[Circle]) -> tuple[Track[Circle], ...]:
        """Find the markers in a frame.

        Parameters
        ----------
        frame : Frame, or ndarray of shape (h, w, 3) or (h, w), uint8
        ball : Track or Lost
            The ball in the same frame; its time is that of the markers.

        Returns
        -------
        tuple of Track
            One for each marker in sight, in no order; none if the ball is lost. A marker's circle has the center and
            the area of the ellipse in which its rim is seen.

        Raises
        ------
        ValueError
            If the color was learned on another kind of image.
        """
        framed = frame_of(frame)
        whole = framed.image
        check_kind("ball", ball, (Track, Lost), "Tracker.update(frame) gives one")
        self.color.check(whole)
        if isinstance(ball, Lost):
            self._missed = []
            self._places.forget()
            return ()
        image = channels_last(whole)
        if framed.rows == "all":
            return self._find(image, ball)
        middle, moved = self._places.as_interlaced(ball, framed.rows)
        return tuple(_moved(marker, moved) for marker in self._find(image, middle))

    def _find(self, image: Image, ball: Track[Circle]) -> tuple[Track[Circle], ...]:
        """Search markers that are not known yet, and follow all."""
        if self._missed.count(0) < len(self.target.markers):
            self._search(image, ball.shape, ball.field_offset)
        if not self._missed:
            return ()
        return self._follow(image, ball)

    def _search(self, image: Image, ball: Circle, fields: tuple[float, float]) -> None:
        """Add patches of the color that are not known yet."""
        limits, x, y, radius = self.parameters, float(ball.x), float(ball.y), float(ball.radius)
        step = max(round(2.0 * radius / limits.grid_cells), 1)
        cells = int(2.0 * radius / step) + 2
        mask = np.zeros((cells, cells), np.uint8)
        circle = x, y, limits.search_radius * radius
        corner = mark_color(image, self.color.table, circle, fields, step, mask)
        count, _, stats, centers = cv2.connectedComponentsWithStats(mask, connectivity=4)
        whole = math.pi * (self._separation * radius / step) ** 2
        found = sorted(range(1, count), key=lambda k: -int(stats[k, cv2.CC_STAT_AREA]))
        for k in found:
            offset = (corner + step * centers[k] - (x, y)) / radius
            foreshortening = math.sqrt(max(1.0 - float(offset @ offset), limits.min_foreshortening))
            if self._missed.count(0) == len(self.target.markers) or len(self._missed) == CAPACITY:
                break
            if not limits.min_area * foreshortening < stats[k, cv2.CC_STAT_AREA] / whole < limits.max_area:
                continue
            if self._is_separate(offset, len(self._missed)):
                self._offsets[1 : len(self._missed) + 1] = self._offsets[: len(self._missed)].copy()
                self._offsets[0] = offset
                self._missed.insert(0, 0)

    def _is_separate(self, offset: Floats, count: int) -> bool:
        """Whether none of the first markers is nearer than a marker's radius."""
        x, y = offset.tolist()
        return all(math.hypot(x - a, y - b) > self._separation for a, b in self._offsets[:count].tolist())

    def _follow(self, image: Image, ball: Track[Circle]) -> tuple[Track[Circle], ...]:
        """Place every marker; expect those that are not there for a while, then forget them."""
        circle, missed, (x, y, radius, variance) = ball.shape, self._missed, self._ball
        x[0], y[0], radius[0], variance[0] = circle.x, circle.y, circle.radius, ball.covariance[2, 2]
        self._fields[0][0], self._fields[1][0] = ball.field_offset
        self._count[0], self._seen[0] = len(missed), missed.count(0)
        count = follow_markers(image, self._block)
        if count < len(missed):
            self._expect(count)
        else:
            self._missed = [0] * count
        return tuple(self._track(k, ball.time) for k in range(count))

    def _expect(self, count: int) -> None:
        """Go on with the markers that were found, the first ones, and those that may soon be seen again."""
        kept, missed = list(range(count)), [0] * count
        for k in range(count, len(self._missed)):
            frames = self._missed[self._order[k]]
            if frames < self.parameters.patience and self._is_separate(self._offsets[k], count):
                kept.append(k)
                missed.append(frames + 1)
        self._offsets[: len(kept)] = self._offsets[kept]
        self._missed = missed

    def _track(self, k: int, time: float) -> Track[Circle]:
        """Describe a marker that was found: the circle of its ellipse's area, and its rim for a match-set."""
        x, y = self._middle[k].tolist()
        circle = Circle(x, y, self._radius.item(k))
        return Track(circle, self._covariance[k].copy(), self._explained.item(k), self._rim[k].copy(), time)


def _moved(marker: Track[Circle], by: tuple[float, float]) -> Track[Circle]:
    """Return a marker elsewhere, px."""
    circle = marker.shape
    return replace(
        marker, shape=Circle(circle.x + by[0], circle.y + by[1], circle.radius), match_set=marker.match_set + by
    )
