"""The next-but-one ball, half hidden behind the neighbor's: `NextBallTracker`.

It has the neighbor's color and is about half as large, at a place that is known to a radius or two. There a disc of
the expected size is looked for by its color, and a circle fitted to the edges around it. Pixels and edge points on the
neighbor's ball count for nothing: they look the same and say nothing.
"""

import math

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.camera.camera_model import CameraModel
from matchset.fitting.workspace import SearchWindow
from matchset.image.color import ColorModel
from matchset.image.frame import Frame, channels_last
from matchset.localization.ball_target import BallTarget
from matchset.localization.localizer import Localizer
from matchset.localization.next_ball.disc_search import Triple, compare_disc, precompile, sample_points, search_disc
from matchset.localization.pose import Pose
from matchset.numeric.arguments import require_at_least, require_positive, require_within
from matchset.numeric.copies import Copied
from matchset.shapes.circle import Circle
from matchset.tracking.compiled_step import tracking_fitter
from matchset.tracking.track import Lost, Track

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]

NO_POINTS = np.empty((0, 2))  # format: the match-set of a circle that stands for itself
NOT_THERE = "the next-but-one ball is not seen where it should be"


class NextBallParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How the next-but-one ball is found in a picture.

    Chosen on pictures of three followers of a rendered chain of ten, seed 0, 14 s: docs/log/control.md#start-of-ten.

    Parameters
    ----------
    every : int
        It is looked for in every so-many-th picture. More costs less time, and follows later.
    points : int
        Lines across its outline, 16 ... 128. More is more exact and slower.
    inside, around : int
        Pixels of which the color is compared, inside and around it. More is surer and slower.
    rings : tuple of 3 floats
        How far the inside goes, where the surroundings begin and how far they go, radii: between is the blurred rim.
    few : float
        So many pixels of another color are added to those that are seen: a small piece of a ball says little.
    around_weight : float
        How much the color of the surroundings speaks against a place: other balls are beside it, but nothing else of
        its color.
    farther_weight : float
        How much it speaks against a place that it is at the end of the way in which the ball is looked for.
    first_score, score : float
        Least share of the inside that has the ball's color, less that of the surroundings by their weight: before its
        edges are looked at, and then. More believes less.
    noise : float
        Largest standard deviation of its edge points while it is followed, px. The fields of a picture lie apart when
        it moves.
    first_noise : float
        The same while it is not. More finds it sooner in a start, and takes other things of its color for it, above all
        where there is no next-but-one ball.
    seen : float
        Least share of the inside that the neighbor's ball does not hide.
    follow, follow_step : float
        How far from the expected place it is looked for while it is followed, and in which steps, radii.
    search, search_high, search_step : float
        The same while it is not: to the sides and in height, and steps. More finds it where a neighbor is far off its
        own place, as in a start, and takes longer.
    search_inside, search_around : int
        Pixels of which the color is compared while it is searched so. More is slower; its place is looked at with
        `inside` and `around` then.
    reach : float
        How far from where its color is its edges are looked for, radii.
    min_reach : float
        And no less than that, px.
    size_sigma : float
        Standard deviation of its expected radius, as a share: the arc that is seen says little of that.
    margin : float
        What is nearer to the neighbor's outline than that is taken for the neighbor's, px.
    blur : float
        That grows by this share of the way that the neighbor made since the last picture: the fields lie apart.
    min_points : int
        Fewest edge points that show it.
    shrink, growth : float
        Least and largest distance, as shares of the expected one: what is nearer or farther is another vehicle's.
    """

    every: int = 3
    points: int = 48
    inside: int = 96
    around: int = 32
    rings: tuple[float, float, float] = (0.93, 1.15, 1.5)
    few: float = 1.0
    around_weight: float = 0.5
    farther_weight: float = 0.1
    first_score: float = 0.5
    score: float = 0.7
    noise: float = 1.8
    first_noise: float = 1.0
    seen: float = 0.06
    follow: float = 0.6
    follow_step: float = 0.2
    search: float = 7.0
    search_high: float = 4.0
    search_step: float = 0.4
    search_inside: int = 16
    search_around: int = 8
    reach: float = 0.3
    min_reach: float = 3.0
    size_sigma: float = 0.05
    margin: float = 1.3
    blur: float = 0.3
    min_points: int = 8
    shrink: float = 0.8
    growth: float = 1.25

    def __post_init__(self) -> None:
        require_within(self, {"points": (16, 128)})
        require_at_least(self, 1, "every")
        require_at_least(self, 4, "inside", "around", "search_inside", "search_around", "min_points")
        if not 0.0 < self.rings[0] <= self.rings[1] < self.rings[2] < math.inf:
            raise ValueError(f"rings must be three growing radii, got {self.rings}")
        sizes = "follow_step", "search_step", "size_sigma", "reach", "min_reach", "noise", "first_noise", "growth"
        require_positive(self, sizes)


class NextBallTracker(Copied):
    """Finds the next-but-one ball where it is expected. The constructor compiles everything.

    It shares nothing with the tracker of the neighbor's ball and cannot disturb that: the neighbor's circle is only
    read.

    Parameters
    ----------
    camera : CameraModel
    target : BallTarget
        All balls are alike.
    color : ColorModel
        Of what kind it will be is compiled for.
    parameters : NextBallParameters, optional

    Attributes
    ----------
    ball : Track or Lost
        Its outline in the last picture, with the edge points that count.
    """

    def __init__(
        self, camera: CameraModel, target: BallTarget, color: ColorModel, parameters: NextBallParameters | None = None
    ) -> None:
        self.camera, self.target, self._color = camera, target, color
        self.parameters = limits = parameters or NextBallParameters()
        self.ball: Track[Circle] | Lost[Circle] = Lost("no picture was looked at", -math.inf)
        self._localizer = Localizer(camera, target)
        self._fitter = tracking_fitter(Circle, limits.points)
        self._samples = sample_points(limits.inside, limits.around, limits.rings)
        self._few_samples = sample_points(limits.search_inside, limits.search_around, limits.rings)
        self._weights = limits.few, limits.around_weight, limits.farther_weight
        self._middle: tuple[float, float] | None = None  # of the ball in the last picture, px
        self._neighbor: Circle | None = None  # in the last picture
        self._make_derived()

    def _derive(self) -> None:
        color = self._color
        self._prior_sigma: Floats = self._fitter.work.motion.prior_sigma
        precompile(color.table.size, color.channels)

    def update(
        self, frame: Frame, color: ColorModel, neighbor: Circle, expected: Floats, followed: bool
    ) -> "Pose | Lost[Pose]":
        """Look for the ball in a picture.

        Parameters
        ----------
        frame : Frame
        color : ColorModel
            Of the ball with its marker, as the neighbor's looks now.
        neighbor : Circle
            The neighbor's ball in this picture.
        expected : ndarray of shape (3,), float64
            Where its center should be, camera frame, m.
        followed : bool
            Whether its direction is known from earlier pictures.

        Returns
        -------
        Pose or Lost
            Its position in the camera frame, without rotation; `Lost` with the reason.
        """
        hiding = self._hiding(neighbor)
        start = self._circle(expected)
        if start is None:
            self.ball = Lost("the next-but-one ball is not in the picture", frame.time)
        else:
            self.ball = self._find(frame, color, start, hiding, followed)
        self._middle = (self.ball.shape.x, self.ball.shape.y) if isinstance(self.ball, Track) else None
        if isinstance(self.ball, Lost):
            return Lost(self.ball.reason, frame.time)
        whole = Track(self.ball.shape, self.ball.covariance, self.ball.support, NO_POINTS, frame.time)
        pose, limits = self._localizer.update(whole), self.parameters
        far = math.sqrt(expected @ expected)
        if isinstance(pose, Pose) and not limits.shrink * far <= pose.distance <= limits.growth * far:
            return Lost("the ball seen there is that of another vehicle", frame.time)
        return pose

    def _hiding(self, neighbor: Circle) -> Triple:
        """Circle of all that may be the neighbor's ball, px."""
        last, self._neighbor = self._neighbor or neighbor, neighbor
        moved = math.dist((last.x, last.y), (neighbor.x, neighbor.y))
        return neighbor.x, neighbor.y, neighbor.radius + self.parameters.margin + self.parameters.blur * moved

    def _circle(self, expected: Floats) -> Triple | None:
        """Circle that is expected, px; None outside the picture."""
        x, _, z = expected.tolist()
        if not z > self.target.radius:
            return None
        inward = -math.copysign(self.target.radius / math.hypot(x, z), x)  # to the middle: there is a pixel for that
        across = inward * np.array((z, 0.0, -x))
        points = np.stack((expected, expected + across))
        if not self.camera.visible(points).all():  # so far aside that the lens has no pixel for it
            return None
        middle, edge = self.camera.project(points).tolist()
        inside = 0.0 <= middle[0] < self.camera.width and 0.0 <= middle[1] < self.camera.height
        return (middle[0], middle[1], math.dist(middle, edge)) if inside else None

    def _find(
        self, frame: Frame, color: ColorModel, start: Triple, hiding: Triple, followed: bool
    ) -> Track[Circle] | Lost[Circle]:
        """Find its outline near a circle, outside the one that hides it."""
        limits, image = self.parameters, channels_last(frame.image)
        self._fitter.take_rows(frame.rows)
        radius, sought = start[2], start
        if not followed:
            way = limits.search * radius, limits.search_high * radius, limits.search_step * radius
            x, y, score, seen = search_disc(image, color.table, start, way, hiding, self._few_samples, self._weights)
            if score < limits.first_score or seen < limits.seen:
                return Lost(NOT_THERE, frame.time)
            sought = x, y, radius
        way = limits.follow * radius, limits.follow * radius, limits.follow_step * radius
        x, y, score, seen = search_disc(image, color.table, sought, way, hiding, self._samples, self._weights)
        if score < limits.first_score or seen < limits.seen:
            return Lost(NOT_THERE, frame.time)
        found = self._fit(image, color, (x, y, radius), frame.time, limits.noise if followed else limits.first_noise)
        if found is None:
            return Lost("the next-but-one ball has no clear outline", frame.time)
        circle, points = found.shape, found.match_set
        disc = circle.x, circle.y, circle.radius
        score, _ = compare_disc(image, color.table, disc, hiding, self._samples, self._weights)
        clear = points[np.hypot(points[:, 0] - hiding[0], points[:, 1] - hiding[1]) > hiding[2]]
        if len(clear) < limits.min_points or score < limits.score:
            return Lost("too little of the next-but-one ball can be seen", frame.time)
        return Track(circle, found.covariance, found.support, clear, frame.time)

    def _fit(self, image: Image, color: ColorModel, start: Triple, time: float, noise: float) -> Track[Circle] | None:
        """Fit a circle of about this size to the edges around a place; None where there is none, or a blurred one."""
        limits, fitter, (x, y, radius) = self.parameters, self._fitter, start
        reach = max(limits.reach * radius, limits.min_reach)
        speed = 0.0 if self._middle is None else math.dist(self._middle, (x, y))
        if self._middle is None:
            fitter.forget()
        self._prior_sigma[:3] = reach, reach, limits.size_sigma * radius
        window = SearchWindow(reach, speed, velocity_unknown=True, use_prior=True)
        estimate = fitter.fit(image, color, Circle(x, y, radius).state, window)
        if not estimate.is_fitted or estimate.fit.edge_noise > noise:
            return None
        return Track(Circle.from_state(estimate.state), *self._answer(), time)

    def _answer(self) -> tuple[Floats, float, Floats]:
        support, covariance, points = self._fitter.answer()
        return covariance, support, points
