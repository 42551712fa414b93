"""All balls in view at once: `Neighbors` (step 5 of the paper's pipeline)."""

import math

import msgspec

from matchset.camera.camera_model import CameraModel
from matchset.image.color import ColorModel
from matchset.image.frame import ArrayFrames, Frame, Picture
from matchset.localization.ball_target import BallTarget
from matchset.tracking.many.strip_search import StripSearch, StripSearchParameters
from matchset.localization.neighbors.ball_track import BallTrack, BallTrackParameters, BallTrackSetup, Neighbor
from matchset.numeric.arguments import check_kind
from matchset.numeric.copies import Copied
from matchset.numeric.words import one_line
from matchset.shapes.circle import Circle
from matchset.tracking.track import Lost, Track


class NeighborsParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How neighbors are told apart (data association).

    Where nothing else is said they were chosen by hand; `python -m benchmarks --only localization_neighbors` would show
    a change.

    Parameters
    ----------
    memory : float
        How long a ball that is not seen keeps its identity, s.
    marker_memory : float
        How long a ball counts as a neighbor after its marker was last seen, s.
    min_visible : float
        Share of its radius that a ball must reach out from behind a nearer one to be tracked.
    max_count : int
        How many balls are followed at once.
    gate_radii, gate_speed : float
        Largest distance of a detection from the prediction of a lost ball with which it is associated: the first, and
        the second times the seconds that it was lost, both in its radii.
    gate_log_radius, gate_log_radius_rate : float
        The same for the change of its radius, as a logarithm: at once, and per second.
    max_log_radius : float
        Change of radius, as a logarithm, from which a ball that touches a nearer one is that one's outline.
    same_distance, same_radius : float
        Distance and difference of radii, in radii of the nearer ball, below which two circles are the same ball.
    min_support : float
        Support below which a ball that touches a nearer one is not placed: its outline ends in the other's.
    clear_support : float
        Support from which the radius of a ball that touches another is used.
    search : StripSearchParameters
    track : BallTrackParameters
    """

    memory: float = 2.0
    marker_memory: float = 1.0
    min_visible: float = 0.35
    max_count: int = 16
    gate_radii: float = 0.7
    gate_speed: float = 4.0
    gate_log_radius: float = 0.2
    gate_log_radius_rate: float = 0.8
    max_log_radius: float = 0.07
    same_distance: float = 0.4
    same_radius: float = 0.25
    min_support: float = 0.55
    clear_support: float = 0.8
    search: StripSearchParameters = StripSearchParameters()
    track: BallTrackParameters = BallTrackParameters()


class Neighbors(Copied):
    """Follows every ball in view; each keeps its identity while others cross or hide it.

    Parameters
    ----------
    camera : CameraModel
        What films them.
    target : BallTarget
        What they all carry, with a marker.
    ball_color : ColorModel
        Of the balls with their markers (the paper's filter a: ``blue | purple``).
    marker_color : ColorModel
        Of the markers alone (filter b).
    parameters : NeighborsParameters, optional
    fps : float or None
        For plain arrays: their rate, 1/s. None: they have the times at which `update` is called, as before a camera.

    Raises
    ------
    ValueError
        If the balls have no marker.

    Examples
    --------
    >>> import numpy as np, matchset as ms
    >>> rows, columns = np.indices((240, 320))
    >>> image = np.full((240, 320, 3), 90, np.uint8)
    >>> for x in (80, 220):
    ...     image[np.hypot(columns - x, rows - 110) < 30] = (200, 60, 30)
    >>> blue, purple = ms.ColorModel.pick(image, 80, 110), ms.ColorModel.hsv((135, 80, 40), (165, 255, 255))
    >>> camera = ms.CameraModel.from_fov(320, 240, 1.07)
    >>> neighbors = ms.Neighbors(camera, ms.BallTarget(0.28, markers=((0, 0, 1),)), blue, purple)
    >>> for k in range(4):
    ...     seen = neighbors.update(ms.Frame(image, k / 30, k))
    >>> [(each.identity, each.marked, round(each.pose.distance, 1)) for each in seen]
    [(0, False, 1.3), (1, False, 1.3)]
    """

    def __init__(
        self,
        camera: CameraModel,
        target: BallTarget,
        ball_color: ColorModel,
        marker_color: ColorModel,
        parameters: NeighborsParameters | None = None,
        *,
        fps: float | None = 30.0,
    ) -> None:
        check_kind("camera", camera, CameraModel)
        check_kind("target", target, BallTarget)
        for name, color in (("ball_color", ball_color), ("marker_color", marker_color)):
            check_kind(name, color, ColorModel)
        check_kind("parameters", parameters, (NeighborsParameters, type(None)))
        target.require_markers("Neighbors")
        self.parameters = parameters or NeighborsParameters()
        self._camera = camera
        self._setup = BallTrackSetup(camera, target, ball_color, marker_color, self.parameters.track)
        self._search = StripSearch(ball_color, self.parameters.search)
        self._tracks: list[BallTrack] = []
        self._hidden: set[int] = set()
        self._count = self._frames = 0
        self._arrays = ArrayFrames(fps)
        self._make_derived()

    def _derive(self) -> None:
        BallTrack(0, self._setup, Circle(0.0, 0.0, 1.0), 0.0)  # compiles what new balls need

    @one_line
    def __repr__(self) -> str:
        names = ", ".join(str(each.identity) for each in self._tracks)
        return f"Neighbors({len(self._tracks)} balls followed{names and ': ' + names}, {self._frames} frames)"

    def update(self, frame: Picture) -> list[Neighbor]:
        """Track all balls in a frame, and search a strip of it for new ones.

        Parameters
        ----------
        frame : Frame, or ndarray of shape (h, w, 3) or (h, w), uint8
            The next picture, of the camera's size, later than the one before; arrays as for `Tracker.update`.

        Returns
        -------
        list of Neighbor
            In the order of their identities; those not seen for a while are `Lost` among them.

        Raises
        ------
        ValueError
            If the picture is not of the camera's size, or as for `Tracker.update`.
        """
        if type(frame) is not Frame or self._arrays.count:
            frame = self._arrays.next(frame, self._frames)
        self._frames += 1
        self._camera.check(frame.image)
        balls = self._follow(frame)
        self._associate(frame, balls)
        kept = [each for each in self._tracks if frame.time - each.time <= self.parameters.memory]
        self._tracks = kept
        return [each.report(frame, balls[each.identity], self.parameters.marker_memory) for each in kept]

    def _follow(self, frame: Frame) -> dict[int, Track[Circle] | Lost[Circle]]:
        """Track every ball that can be in sight, nearest first; no two may end on the same one."""
        balls: dict[int, Track[Circle] | Lost[Circle]] = {}
        nearer: list[tuple[int, Circle]] = []
        for each in sorted(self._tracks, key=lambda track: -track.circle.radius):
            name = each.identity
            ball = balls[name] = self._follow_one(each, frame, nearer)
            if isinstance(ball, Track):
                touches = any(_touch(ball.shape, circle) for _, circle in nearer)
                each.correct(ball, not touches or ball.support > self.parameters.clear_support)
                nearer.append((name, ball.shape))
                self._hidden.discard(name)
            else:
                self._hidden.add(name)
        return balls

    def _follow_one(
        self, track: BallTrack, frame: Frame, nearer: list[tuple[int, Circle]]
    ) -> Track[Circle] | Lost[Circle]:
        """Track one ball, unless a nearer one hides it; where its outline is a nearer one's it is hidden too."""
        predicted = track.predict(frame.time)
        hider = self._hider(predicted, nearer)
        if hider is None:
            ball = track.follow(frame, track.identity in self._hidden)
            if isinstance(ball, Lost):
                return ball
            hider = next((name for name, circle in nearer if self._is_mistaken(ball, track, circle)), None)
            if hider is None:
                return ball
        return Lost(f"hidden behind neighbor {hider}", frame.time, predicted)

    def _hider(self, predicted: Circle, nearer: list[tuple[int, Circle]]) -> int | None:
        """Which of the nearer balls hides a ball that should be here, or None."""
        for name, circle in nearer:
            far = math.hypot(predicted.x - circle.x, predicted.y - circle.y)
            if far + predicted.radius < circle.radius + self.parameters.min_visible * predicted.radius:
                return name
        return None

    def _is_mistaken(self, ball: Track[Circle], track: BallTrack, nearer: Circle) -> bool:
        """Whether the outline of a ball is really a nearer one's, mixed with it, or half behind it."""
        circle, limits = ball.shape, self.parameters
        if not _touch(circle, nearer):
            return False
        far = math.hypot(circle.x - nearer.x, circle.y - nearer.y)
        other_radius = abs(circle.radius - nearer.radius)
        same = far < limits.same_distance * nearer.radius and other_radius < limits.same_radius * nearer.radius
        change = abs(math.log(circle.radius / track.typical_radius))
        return same or change > limits.max_log_radius or ball.support < limits.min_support

    def _associate(self, frame: Frame, balls: dict[int, Track[Circle] | Lost[Circle]]) -> None:
        """Search a strip; a detection is one of the lost balls, or a new one."""
        seen = [each.circle for each in self._tracks if isinstance(balls[each.identity], Track)]
        for circle in self._search.update(frame, seen):
            lost = [each for each in self._tracks if isinstance(balls[each.identity], Lost)]
            known = min(lost, key=lambda each: self._distance(each, circle, frame.time), default=None)
            if known is not None and self._distance(known, circle, frame.time) < 1.0:
                known.reacquire(circle, frame.time)
                self._hidden.discard(known.identity)
                balls[known.identity] = Lost("seen again, to be confirmed by the next frame", frame.time, circle)
            elif any(_touch(circle, each.predict(frame.time)) for each in lost):
                continue  # which of them is behind will be clear when they have parted
            elif len(self._tracks) < self.parameters.max_count:
                new = BallTrack(self._count, self._setup, circle, frame.time)
                self._count += 1
                self._tracks.append(new)
                balls[new.identity] = new.follow(frame, False)

    def _distance(self, track: BallTrack, circle: Circle, time: float) -> float:
        """Distance of a detection from a lost ball, in the size of the gate: above 1 it is another ball."""
        predicted, gone, limits = track.predict(time), time - track.time, self.parameters
        gate = predicted.radius * (limits.gate_radii + limits.gate_speed * gone)
        change = abs(math.log(circle.radius / predicted.radius))
        far = math.hypot(circle.x - predicted.x, circle.y - predicted.y)
        return max(far / gate, change / (limits.gate_log_radius + limits.gate_log_radius_rate * gone))


def _touch(one: Circle, other: Circle) -> bool:
    """Whether two circles overlap."""
    return math.hypot(one.x - other.x, one.y - other.y) < one.radius + other.radius
