"""Where the ball is, from its track and those of its markers: `Localizer`."""

import functools
import itertools
import math
from collections.abc import Iterable

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.camera.camera_model import CameraModel
from matchset.localization import pose_estimation as sighting
from matchset.localization.ball import NOWHERE, REASONS, BallParameters, outline_of
from matchset.localization.ball_target import MOST, BallTarget
from matchset.localization.marker_identification import FULL, LEVEL, NOTHING
from matchset.localization.pose import Observed, Pose
from matchset.localization.pose_estimation import COVARIANCE, KNOWN, OUT, RADIUS, TURN, sight
from matchset.shapes.circle import Circle
from matchset.tracking.track import Lost, Track

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

OBSERVED: dict[int, Observed] = {NOTHING: "position", LEVEL: "level", FULL: "full"}


class LocalizerParameters(msgspec.Struct, frozen=True):
    """How tracks become a pose.

    Parameters
    ----------
    ball : BallParameters
    tilt : float
        Standard deviation of the tilt of "level" vehicles against each other, rad: what one marker leaves open.
    marker_place : float
        Standard deviation of where the markers sit on the ball, rad.
    lead : float
        By how much, in squared standard deviations, the best answer to which marker is which must be better than the
        next one; otherwise the rotation is not told.
    misfit : float
        Largest sum of squared deviations of the markers per marker.
    memory : float
        How long the last rotation helps to tell markers apart, s.
    """

    ball: BallParameters = BallParameters()
    tilt: float = 0.1
    marker_place: float = 0.01
    lead: float = 3.5
    misfit: float = 25.0
    memory: float = 0.5


class Localizer:
    """Turns tracks into poses; one localizer per ball, since it remembers which marker was where.

    Parameters
    ----------
    camera : CameraModel
        What filmed the ball.
    target : BallTarget
        The ball.
    parameters : LocalizerParameters, optional

    Examples
    --------
    >>> import numpy as np, matchset as ms
    >>> camera = ms.CameraModel.from_fov(640, 480, 1.07)
    >>> ball = ms.Track(ms.Circle(319.5, 239.5, 40.0), np.diag((0.01, 0.01, 0.01)), 1.0, np.empty((0, 2)), 0.0)
    >>> pose = ms.Localizer(camera, ms.BallTarget(diameter=0.28)).update(ball)
    >>> pose.observed, pose.position.round(2).tolist()
    ('position', [0.0, 0.0, 1.91])
    """

    def __init__(self, camera: CameraModel, target: BallTarget, parameters: LocalizerParameters | None = None) -> None:
        self.camera, self.target = camera, target
        self.parameters = parameters or LocalizerParameters()
        self._bodies = target.directions
        self._intrinsics = camera.intrinsics.copy()
        self._camera_covariance = NOWHERE if camera.covariance is None else camera.covariance.copy()
        self._last, self._since = np.eye(3), -math.inf
        self._numbers = np.zeros(sighting.NUMBERS)
        limits = self.parameters
        self._numbers[RADIUS:KNOWN] = (
            target.radius,
            target.marker_distance,
            limits.marker_place,
            limits.tilt,
            limits.lead,
            limits.misfit,
        )
        precompile()

    def update(
        self, ball: Track[Circle] | Lost[Circle], markers: Iterable[Track[Circle] | Lost[Circle]] = ()
    ) -> "Pose | Lost[Pose]":
        """Place the ball.

        Parameters
        ----------
        ball : Track or Lost
            The ball in a frame.
        markers : iterable of Track or Lost
            Its markers in the same frame, in any order; what is lost is left out.

        Returns
        -------
        Pose or Lost
            `Lost` if the ball is lost or its outline is not that of a ball before the camera, with the reason.
        """
        if isinstance(ball, Lost):
            return Lost(ball.reason, ball.time)
        outline, numbers, out = outline_of(ball, self.parameters.ball), self._numbers, np.empty(OUT)
        numbers[:RADIUS] = outline.numbers
        numbers[KNOWN] = 0.0 <= ball.time - self._since <= self.parameters.memory
        seen = [_numbers(marker) for marker in markers if isinstance(marker, Track)] if len(self._bodies) else []
        miss, kind = sight(
            self._intrinsics,
            self._camera_covariance,
            outline.points,
            outline.spread,
            np.array(seen[:MOST]) if seen else NOWHERE,
            *assignments(min(max(len(seen), 1), MOST), len(self._bodies)),
            self._bodies,
            self._last,
            numbers,
            out,
        )
        if miss:
            return Lost(REASONS[miss], ball.time)
        turn: Floats | None = None
        if kind != NOTHING:
            turn = out[TURN:].reshape(3, 3)
            self._last, self._since = turn, ball.time
        return Pose(
            position=out[:COVARIANCE],
            turn=turn,
            covariance=out[COVARIANCE:TURN].reshape(6, 6),
            observed=OBSERVED[kind],
            time=ball.time,
        )


def precompile() -> None:
    """Compile the kernel of a localizer, so that no frame waits for it."""
    no_points, no_ways = np.empty((0, 2)), (np.empty((0, 1), np.int64), np.zeros(3, np.int64))
    numbers, out = np.zeros(sighting.NUMBERS), np.empty(OUT)
    sight(np.ones(9), NOWHERE, no_points, np.eye(3), NOWHERE, *no_ways, np.empty((0, 3)), np.eye(3), numbers, out)


def _numbers(marker: Track[Circle]) -> tuple[float, ...]:
    """Middle of a marker, px, and the covariance of that."""
    circle, wide = marker.shape, marker.covariance
    return circle.x, circle.y, wide.item(0, 0), wide.item(0, 1), wide.item(1, 0), wide.item(1, 1)


@functools.cache
def assignments(seen: int, known: int) -> tuple[Ints, Ints]:
    """All ways to name up to `seen` directions, a marker each, or -1 where it is none of them.

    As many as possible are named, or one less.

    Parameters
    ----------
    seen, known : int
        How many directions, and how many markers the ball has.

    Returns
    -------
    ways : ndarray of shape (c, seen), int64
    starts : ndarray of shape (seen + 2,), int64
        The ways to name k directions are rows starts[k] ... starts[k + 1], of which the first k columns count.
    """
    ways: list[list[int]] = []
    starts = [0]
    for count in range(seen + 1):
        most = min(count, known)
        for named in range(max(most - 1, 1), most + 1):
            for who in itertools.combinations(range(count), named):
                for names in itertools.permutations(range(known), named):
                    way = [-1] * seen
                    for place, name in zip(who, names, strict=True):
                        way[place] = name
                    ways.append(way)
        starts.append(len(ways))
    return np.array(ways, np.int64).reshape(-1, seen), np.array(starts, np.int64)
