"""Balls at known places before a known camera, followed and placed: `observe`."""

import math
from collections.abc import Iterator

import msgspec
import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

import matchset as ms
from matchset.localization.markers.ball_colors import pick_marker
from matchset.sim.clips.ball_flight_clip import BallFlightClip

Floats = npt.NDArray[np.float64]

RADIUS = 0.14  # m, of the simulated balloon
PINHOLE = ms.CameraModel(width=640, height=480, fx=450.0, fy=450.0, cx=319.5, cy=239.5)
BARREL = ms.CameraModel(
    width=640, height=480, fx=450.0, fy=450.0, cx=319.5, cy=239.5, distortion=(-0.3, 0.0, 0.0, 0.0, 0.0)
)
TURNED = np.diag((-1.0, 1.0, -1.0))  # marker 0 looks at a camera straight ahead, upright


class Sight(msgspec.Struct, frozen=True):
    """One frame: what was answered, and what is true.

    Parameters
    ----------
    pose : Pose or Lost
        The answer.
    place : ndarray of shape (3,)
        The ball's center, m.
    turn : Rotation
        From the ball frame to the camera frame.
    time : float
        s.
    """

    pose: "ms.Pose | ms.Lost[ms.Pose]"
    place: Floats
    turn: Rotation
    time: float

    @property
    def range_error(self) -> float:
        """Share by which the range is too long; NaN without an answer."""
        if isinstance(self.pose, ms.Lost):
            return math.nan
        return self.pose.distance / float(np.linalg.norm(self.place)) - 1.0

    @property
    def square(self) -> float:
        """Normalized error squared of the position; NaN without an answer."""
        if isinstance(self.pose, ms.Lost):
            return math.nan
        error = self.pose.position - self.place
        return float(error @ np.linalg.solve(self.pose.covariance[:3, :3], error))

    def direction_error(self, marker: tuple[float, float, float] = (0.0, 0.0, 1.0)) -> float:
        """Angle between where a marker is and where the answer has it, rad; NaN where that is not observed."""
        if isinstance(self.pose, ms.Lost) or self.pose.rotation_matrix is None:
            return math.nan
        true = self.turn.apply(marker)
        return math.atan2(*(f(true, self.pose.rotation_matrix @ marker) for f in (_sine, np.dot)))

    @property
    def turn_error(self) -> float:
        """Angle between the two rotations, rad; NaN where none is observed."""
        if isinstance(self.pose, ms.Lost) or self.pose.rotation is None:
            return math.nan
        return float((self.turn * self.pose.rotation.inv()).magnitude())


def _sine(one: Floats, other: Floats) -> float:
    return float(np.linalg.norm(np.cross(one, other)))


def rim(place: Floats, radius: float = RADIUS, count: int = 72) -> Floats:
    """Rays that touch a ball, (count, 3)."""
    far = float(np.linalg.norm(place))
    axis, sine = place / far, radius / far
    across = np.cross(axis, (0.0, 1.0, 0.0) if abs(axis[1]) < 0.9 else (1.0, 0.0, 0.0))
    across /= np.linalg.norm(across)
    angles = 2.0 * math.pi * np.arange(count) / count
    round_it = np.outer(np.cos(angles), across) + np.outer(np.sin(angles), np.cross(axis, across))
    return np.asarray(math.sqrt(1.0 - sine * sine) * axis + sine * round_it)


def place_ball(
    camera: ms.CameraModel, radius_px: float, off_axis: float, rng: np.random.Generator, room_px: float = 4.0
) -> Floats | None:
    """Choose a place for a ball; None if its outline does not fit into the picture there.

    Parameters
    ----------
    camera : CameraModel
    radius_px : float
        Radius that the ball would have on the axis, px.
    off_axis : float
        Angle between the axis and the ball's center, rad.
    rng : Generator
        Chooses to which side.
    room_px : float
        Least distance of the outline from the border.
    """
    far = RADIUS * math.hypot(1.0, camera.fx / radius_px)
    for _ in range(300):
        roll = rng.uniform(0.0, 2.0 * math.pi)
        sine = math.sin(off_axis)
        place = far * np.array((sine * math.cos(roll), sine * math.sin(roll), math.cos(off_axis)))
        rays = rim(place)
        if camera.visible(rays).all():
            pixels = camera.project(rays)
            low, high = pixels.min(axis=0), pixels.max(axis=0)
            if low.min() > room_px and (high < np.array((camera.width, camera.height)) - 1.0 - room_px).all():
                return place
    return None


def facing(place: Floats) -> Rotation:
    """Rotation with which marker 0 looks at the camera, upright."""
    z = -place / np.linalg.norm(place)
    y = np.array((0.0, 1.0, 0.0)) - z[1] * z
    y /= np.linalg.norm(y)
    return Rotation.from_matrix(np.column_stack((np.cross(y, z), y, z)))


def learn(flight: BallFlightClip) -> tuple[ms.ColorModel, ms.ColorModel]:
    """Learn the colors of ball and marker from a picture of the same room in which marker 0 looks at the camera.

    Parameters
    ----------
    flight : BallFlightClip

    Returns
    -------
    tuple of ColorModel
        Of the ball without its markers, and of the markers.
    """
    place = flight.place(0.0)
    turn = facing(place)
    still = msgspec.structs.replace(flight, frames=1, turn=lambda _: turn, markers=flight.markers[:1])
    image = next(iter(still)).image
    pixels = flight.camera.project(np.array((place, place + np.array((-0.6 * RADIUS, 0.0, 0.0)))))
    return ms.ColorModel.pick(image, *pixels[1]), pick_marker(image, *pixels[0])


def observe(flight: BallFlightClip, target: ms.BallTarget | None = None, warm_up: int = 1) -> Iterator[Sight]:
    """Follow the ball of a flight and place it in every frame, from a click on it and, for a `turn`, on its marker.

    Parameters
    ----------
    flight : BallFlightClip
        With a `turn` its markers are followed too.
    target : BallTarget, optional
        Default: the balloon of the flight.
    warm_up : int
        Frames that are followed and not told.

    Yields
    ------
    Sight
    """
    balloon = flight.balloon
    target = target or ms.BallTarget(2.0 * balloon.radius, flight.markers, 2.0 * balloon.marker_radius)
    ball_color, marker_color = learn(flight)
    click = flight.camera.project(flight.place(0.0)[np.newaxis])[0]
    both = ball_color if flight.turn is None else ball_color | marker_color
    tracker = ms.Tracker(ms.Circle, both, start=(float(click[0]), float(click[1])))
    finder = ms.MarkerTracker(marker_color, target)
    localizer = ms.Localizer(flight.camera, target)
    for frame in flight:
        ball = tracker.update(frame)
        markers = finder.update(frame, ball) if flight.turn is not None else ()
        pose = localizer.update(ball, markers)
        if frame.index >= warm_up:
            turn = flight.turn(frame.time) if flight.turn is not None else facing(flight.place(frame.time))
            yield Sight(pose, flight.place(frame.time), turn, frame.time)
