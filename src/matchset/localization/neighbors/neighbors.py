"""Everything in view at once: `Neighbors` (step 5 of the paper's pipeline)."""

import math

import msgspec
import numpy as np

from matchset.camera.camera_model import CameraModel
from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.localization.ball_target import BallTarget
from matchset.localization.neighbors.ball_search import Newcomers
from matchset.localization.neighbors.ball_track import Member, Neighbor
from matchset.shapes.circle import Circle
from matchset.tracking.track import Lost, Track

MIXED = 0.07  # change of size, as a logarithm, of a ball that touches another: their outlines were mixed up

HALF_SEEN = 0.55  # support below which a ball beside a nearer one cannot be placed: its outline ends in the other's
WELL_SEEN = 0.8  # support from which the size of a ball that touches another is believed


class NeighborsParameters(msgspec.Struct, frozen=True):
    """How neighbors are kept apart.

    Parameters
    ----------
    points : int
        Lines across a ball's outline, see `Tracker`.
    memory : float
        How long a ball that is not seen keeps its identity, s.
    marked : float
        How long a ball counts as a neighbor after its marker was last seen, s.
    hidden : float
        Share of its radius that a ball must reach out from behind a nearer one to be looked for.
    wander : float
        How far from where it is expected a ball may turn up again and keep its identity: px per second unseen, in
        radii.
    most : int
        How many are followed at once.
    """

    points: int = 64
    memory: float = 2.0
    marked: float = 1.0
    hidden: float = 0.35
    wander: float = 4.0
    most: int = 16


class Neighbors:
    """Follows every ball in view; each keeps its identity while others cross or hide it.

    Parameters
    ----------
    camera : CameraModel
        What films them.
    target : BallTarget
        What they all carry.
    ball_color : ColorModel
        Of the balls with their markers (the paper's filter a: ``blue | purple``).
    marker_color : ColorModel
        Of the markers alone (filter b).
    parameters : NeighborsParameters, optional

    Examples
    --------
    >>> import numpy as np, matchset as ms
    >>> rows, columns = np.indices((240, 320))
    >>> image = np.full((240, 320, 3), 90, np.uint8)
    >>> for x in (80, 220):
    ...     image[np.hypot(columns - x, rows - 110) < 30] = (200, 60, 30)
    >>> blue, purple = ms.ColorModel.pick(image, 80, 110), ms.ColorModel.hsv((135, 80, 40), (165, 255, 255))
    >>> camera = ms.CameraModel.from_fov(320, 240, 1.07)
    >>> neighbors = ms.Neighbors(camera, ms.BallTarget(diameter=0.28), blue, purple)
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
    ) -> None:
        self.parameters = parameters or NeighborsParameters()
        self._make = camera, target, ball_color, marker_color, self.parameters.points
        self._camera = camera
        self._newcomers = Newcomers(ball_color)
        self._members: list[Member] = []
        self._hidden: set[int] = set()
        self._count = 0
        Member(0, *self._make, Circle(0.0, 0.0, 1.0), Frame(np.zeros((1, 1), np.uint8)))  # compiles what newcomers need

    def update(self, frame: Frame) -> list[Neighbor]:
        """Follow everyone into a frame and search a strip of it for newcomers.

        Parameters
        ----------
        frame : Frame
            The next picture, of the camera's size, later than the one before.

        Returns
        -------
        list of Neighbor
            In the order of their identities; those not seen for a while are `Lost` among them.

        Raises
        ------
        ValueError
            If the picture is not of the camera's size, or as for `Tracker.update`.
        """
        self._camera.check(frame.image)
        balls = self._follow(frame)
        self._welcome(frame, balls)
        kept = [each for each in self._members if frame.time - each.time <= self.parameters.memory]
        self._members = kept
        return [each.tell(frame, balls[each.identity], self.parameters.marked) for each in kept]

    def _follow(self, frame: Frame) -> dict[int, Track[Circle] | Lost[Circle]]:
        """Follow everyone who can be in sight, nearest first; no two may end on the same ball."""
        balls: dict[int, Track[Circle] | Lost[Circle]] = {}
        taken: list[tuple[int, Circle]] = []
        for member in sorted(self._members, key=lambda each: -each.circle.radius):
            place, name = member.expected(frame.time), member.identity
            behind = self._behind(place, taken)
            if behind is not None:
                self._hidden.add(name)
                balls[name] = Lost(f"hidden behind neighbor {behind}", frame.time, place)
                continue
            ball = member.follow(frame, name in self._hidden)
            self._hidden.discard(name)
            if isinstance(ball, Track):
                same = next((other for other, circle in taken if _mistaken(ball, member.usual, circle)), None)
                if same is not None:
                    self._hidden.add(name)
                    ball = Lost(f"hidden behind neighbor {same}", frame.time, place)
                else:
                    touches = any(_touch(ball.shape, circle) for _, circle in taken)
                    member.take_in(ball, not touches or ball.support > WELL_SEEN)
                    taken.append((name, ball.shape))
            else:
                self._hidden.add(name)
            balls[name] = ball
        return balls

    def _behind(self, place: Circle, nearer: list[tuple[int, Circle]]) -> int | None:
        """Who hides a ball that should be here, or None."""
        for name, circle in nearer:
            far = math.hypot(place.x - circle.x, place.y - circle.y)
            if far + place.radius < circle.radius + self.parameters.hidden * place.radius:
                return name
        return None

    def _welcome(self, frame: Frame, balls: dict[int, Track[Circle] | Lost[Circle]]) -> None:
        """Search a strip; who turns up is one of the lost, or new."""
        seen = [each.circle for each in self._members if isinstance(balls[each.identity], Track)]
        for circle in self._newcomers.update(frame, seen):
            lost = [each for each in self._members if isinstance(balls[each.identity], Lost)]
            known = min(lost, key=lambda each: self._off(each, circle, frame.time), default=None)
            if known is not None and self._off(known, circle, frame.time) < 1.0:
                known.meet(circle, frame.time)
                self._hidden.discard(known.identity)
                balls[known.identity] = Lost("seen again, to be confirmed by the next frame", frame.time, circle)
            elif any(_touch(circle, each.expected(frame.time)) for each in lost):
                continue  # who is behind whom will be clear when they have parted
            elif len(self._members) < self.parameters.most:
                new = Member(self._count, *self._make, circle, frame)
                self._count += 1
                self._members.append(new)
                balls[new.identity] = new.follow(frame, False)

    def _off(self, member: Member, circle: Circle, time: float) -> float:
        """How far a sighting is from a lost ball, in what it may be off: above 1 it is another one."""
        place = member.expected(time)
        room = place.radius * (0.7 + self.parameters.wander * (time - member.time))
        change = abs(math.log(circle.radius / place.radius)) / (0.2 + 0.8 * (time - member.time))
        return max(math.hypot(circle.x - place.x, circle.y - place.y) / room, change)


def _touch(one: Circle, other: Circle) -> bool:
    """Whether two circles overlap."""
    return math.hypot(one.x - other.x, one.y - other.y) < one.radius + other.radius


def _mistaken(ball: Track[Circle], usual: float, nearer: Circle) -> bool:
    """Whether a ball of a usual radius is really a nearer one, mixed up with its outline, or half behind it."""
    circle = ball.shape
    if not _touch(circle, nearer):
        return False
    far = math.hypot(circle.x - nearer.x, circle.y - nearer.y)
    same = far < 0.4 * nearer.radius and abs(circle.radius - nearer.radius) < 0.25 * nearer.radius
    return same or abs(math.log(circle.radius / usual)) > MIXED or ball.support < HALF_SEEN
