"""Where the ball is, from its track and those of its markers: `Localizer`."""

import math
from collections.abc import Iterable
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.camera.camera_model import CameraModel
from matchset.fitting.fit_quality import add_field_covariance
from matchset.localization.attitude import ATTITUDE, AttitudeParameters, marker_direction
from matchset.localization.ball_target import MOST_MARKERS, BallTarget
from matchset.localization.cone import BallParameters, ConeFailure
from matchset.localization.marker_identification import RotationSource, assignments
from matchset.localization.pose import Observed, Pose
from matchset.localization.pose_estimation import POSE, estimate_pose
from matchset.media.upright.square_pixels import check_square
from matchset.numeric.arguments import check_kind
from matchset.numeric.copies import Copied
from matchset.numeric.jit import interpreted
from matchset.numeric.record import fields, new_block, store
from matchset.numeric.words import measured, one_line
from matchset.shapes.circle import Circle
from matchset.tracking.track import Lost, Track

Floats = npt.NDArray[np.float64]

ANGLES = 2.0 * math.pi * np.arange(48) / 48  # geometry: the points of a circle that stands for a match-set
UNIT_CIRCLE = np.column_stack((np.cos(ANGLES), np.sin(ANGLES)))
STEP = 0.1  # geometry: of a derivative to the intrinsics, in their standard deviations; at most the two that follow
LARGEST_STEP_PX, LARGEST_STEP = 0.5, 1e-3  # geometry: of what has pixels, and of the lens
RESIZED = "calibrate at the size that is used; CameraModel.resized is the camera of scaled pictures"  # format: words
OBSERVED: dict[int, Observed] = {
    RotationSource.NONE: "position",
    RotationSource.LEVEL: "level",
    RotationSource.FULL: "full",
}
REASONS: dict[int, str] = {
    ConeFailure.TOO_FEW_RAYS: "the lens model has no directions where the ball is seen",
    ConeFailure.NO_CONE: "the outline is not that of a ball",
    ConeFailure.TOO_NEAR: "the ball touches the camera",
}


class LocalizerParameters(msgspec.Struct, frozen=True):
    """How tracks become a pose.

    Parameters
    ----------
    ball : BallParameters
        Of the position.
    attitude : AttitudeParameters
        Of the rotation.
    memory : float
        How long the previous rotation helps to tell markers apart, s. Chosen by hand;
        `python -m benchmarks --only localization_markers` would show a change.
    """

    ball: BallParameters = BallParameters()
    attitude: AttitudeParameters = AttitudeParameters()
    memory: float = 0.5


class Localizer(Copied):
    """Turns tracks into poses; one localizer per ball, since it remembers which marker was where.

    Its kernels are compiled here; `update` compiles nothing.

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
        check_kind("camera", camera, CameraModel)
        check_kind("target", target, BallTarget)
        check_kind("parameters", parameters, (LocalizerParameters, type(None)))
        self.camera, self.target = camera, target
        self.parameters = parameters or LocalizerParameters()
        limits = self.parameters.ball
        self._shared = np.diag((limits.center_sigma_px**2, limits.center_sigma_px**2, limits.size_sigma_px**2))
        self._rotation_time = -math.inf
        self._block = new_block(POSE)
        _describe(fields(self._block, POSE), camera, target, self.parameters)
        self._make_derived()

    def _derive(self) -> None:
        work = fields(self._block, POSE)
        # What every frame reads or writes; an array of NumPy is reached faster than the fields of a record.
        cone, attitude = self._block.view(POSE)["cone"], self._block.view(POSE)["attitude"]
        self._robust, self._pixel_count = cone["robust"], attitude["pixel_count"]  # each has one element
        self._last_known = attitude["last_known"]
        self._inside, self._shared_covariance = work.cone.inside, work.cone.shared_covariance
        self._pixels, self._pixel_covariances = work.attitude.pixels, work.attitude.pixel_covariances
        self._last_rotation, self._rotation = work.attitude.last_rotation, work.attitude.rotation
        self._position, self._covariance = work.cone.position, work.covariance
        self._slopes = work.cone.camera_slope, work.attitude.rotation_slope
        self._exact = self.camera.covariance is None and self.target.diameter_sigma == 0.0
        precompile()

    @one_line
    def __repr__(self) -> str:
        count = len(self.target.markers)
        marked = f"with {count} marker{'s' * (count > 1)}" if count else "without marker"
        ball = f"ball of {measured(self.target.diameter, self.target.diameter_sigma)} m {marked}"
        return f"Localizer({ball}, {self.camera.width} x {self.camera.height} camera)"

    def update(
        self, ball: Track[Circle] | Lost[Circle], markers: Iterable[Track[Circle] | Lost[Circle]] = ()
    ) -> "Pose | Lost[Pose]":
        """Estimate the pose of the ball.

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

        Raises
        ------
        TypeError
            If the ball or a marker is no `Track` or `Lost`, whether it would have been looked at or not.
        ValueError
            If the ball was tracked in a picture whose pixels are not square, or is wholly outside of the camera's.
        """
        check_kind("ball", ball, (Track, Lost), "Tracker.update(frame) gives one")
        seen = _checked(markers)
        if isinstance(ball, Lost):
            return Lost(ball.reason, ball.time)
        _check_picture(self.camera, ball.shape)
        check_square(ball.pixel_aspect)
        count = self._take_markers(seen)
        self._last_known[0] = 0.0 <= ball.time - self._rotation_time <= self.parameters.memory
        ways = assignments(max(count, 1), len(self.target.markers))
        failure, source = estimate_pose(self._block, self._take_outline(ball), *ways)
        if failure:
            return Lost(REASONS[failure], ball.time)
        rotation: Floats | None = None
        if source:
            rotation = self._rotation.copy()
            self._last_rotation[:], self._rotation_time = rotation, ball.time
        covariance = self._covariance.copy()
        systematic = None if self._exact else self._systematic(rotation is not None)
        return Pose(
            position=self._position.copy(),
            rotation_matrix=rotation,
            covariance=covariance if systematic is None else covariance + systematic,
            observed=OBSERVED[source],
            time=ball.time,
            systematic_covariance=systematic,
        )

    def _systematic(self, turned: bool) -> Floats:
        """Covariance of what errors of the camera and of the diameter do to the pose, (6, 6).

        A ball that is larger by a share, and its markers with it, is as much farther away, and turned as it was.
        """
        camera, share = self.camera.covariance, self.target.diameter_sigma / self.target.diameter
        systematic = np.zeros((6, 6))
        systematic[:3, :3] = share**2 * np.outer(self._position, self._position)
        if camera is not None:
            slope = np.vstack(self._slopes if turned else (self._slopes[0], np.zeros((3, 9))))
            systematic += slope @ camera @ slope.T
        return systematic

    def _take_outline(self, ball: Track[Circle]) -> Floats:
        """Points of the outline, (n, 2) px; if there are few, of the circle, with its covariance."""
        circle, points = ball.shape, ball.match_set
        self._inside[0], self._inside[1] = circle.x, circle.y
        robust = len(points) >= self.parameters.ball.min_points
        self._robust[0] = robust
        self._shared_covariance[:] = self._shared if robust else ball.covariance
        if robust:
            share = self.parameters.ball.field_share
            interpreted(add_field_covariance)(ball.field_offset, share, self._shared_covariance)
        else:
            return UNIT_CIRCLE * circle.radius + (circle.x, circle.y)
        if points.dtype != np.float64 or not points.flags.carray:  # to the compiler read-only arrays are another type
            return np.array(points, np.float64, order="C")
        return points

    def _take_markers(self, markers: Iterable[Track[Circle] | Lost[Circle]]) -> int:
        """Write the markers' places in the image and their covariances; returns how many count."""
        count = 0
        if self.target.markers:
            for marker in markers:
                if isinstance(marker, Track) and count < MOST_MARKERS:
                    self._pixels[count] = marker.shape.x, marker.shape.y
                    self._pixel_covariances[count] = marker.covariance[:2, :2]
                    count += 1
        self._pixel_count[0] = count
        return count


def _check_picture(camera: CameraModel, ball: Circle) -> None:
    """Refuse a ball that is wholly outside of the camera's picture: it was seen in larger ones."""
    half_x, half_y = 0.5 * (camera.width - 1), 0.5 * (camera.height - 1)
    if max(abs(ball.x - half_x) - half_x, abs(ball.y - half_y) - half_y) > ball.radius + 0.5:
        size = f"{camera.width} x {camera.height} px"
        raise ValueError(f"the camera's pictures are {size}, the ball is at ({ball.x:.0f}, {ball.y:.0f}): {RESIZED}")


def _checked(markers: Iterable[Track[Circle] | Lost[Circle]]) -> tuple[Track[Circle] | Lost[Circle], ...]:
    """Return the markers, all of them looked at; TypeError for what is none."""
    if not isinstance(markers, Iterable):
        raise TypeError(f"markers must be several of Track and Lost, got {type(markers).__name__} {markers!r:.60}")
    listed = tuple(markers)
    for marker in listed:
        check_kind("a marker", marker, (Track, Lost), "MarkerTracker.update(frame, ball) gives them")
    return listed


def precompile() -> None:
    """Compile the kernels of a localizer, so that no frame waits for them."""
    estimate_pose(new_block(POSE), np.empty((0, 2)), *assignments(1, 0))


def _describe(work: Any, camera: CameraModel, target: BallTarget, parameters: LocalizerParameters) -> None:
    """Write what does not change from frame to frame."""
    cone, attitude, count = work.cone, work.attitude, len(target.markers)
    store(cone.limits, parameters.ball)
    store(attitude.limits, parameters.attitude)
    cone.intrinsics[:] = attitude.intrinsics[:] = camera.intrinsics
    cone.intrinsics_uncertain = camera.covariance is not None
    if camera.covariance is not None:
        cone.camera_steps[:] = attitude.camera_steps[:] = derivative_steps(camera.covariance)
    cone.radius, attitude.rim_distance = target.radius, target.marker_distance
    attitude.body_count = count
    attitude.bodies[:count] = target.directions


def derivative_steps(covariance: Floats) -> Floats:
    """Return the steps of derivatives to the intrinsics, px or no unit, (9,): parts of their deviations, or 0."""
    return np.minimum(STEP * np.sqrt(np.diag(covariance)), (*(LARGEST_STEP_PX,) * 4, *(LARGEST_STEP,) * 5))


def left_out(camera: CameraModel, target: BallTarget) -> str:
    """Say what the standard deviations of poses leave out, since it was taken as exact; empty if that is nothing.

    Parameters
    ----------
    camera : CameraModel
    target : BallTarget
    """
    exact = ["of the camera"] if camera.covariance is None else []
    exact += ["of the diameter"] if target.diameter_sigma == 0.0 else []
    return f"± leaves out errors {' and '.join(exact)}" if exact else ""


def direction_on_ball(
    camera: CameraModel, pixel: tuple[float, float], position: Floats, rim_distance: float
) -> Floats | None:
    """Direction of a marker from the ball's center, for calls outside the loop.

    Parameters
    ----------
    camera : CameraModel
    pixel : tuple of 2 floats
        Middle of the marker's rim, px.
    position : ndarray of shape (3,), float64
        The ball's center, camera frame, m.
    rim_distance : float
        From there to the middle of the rim, m.

    Returns
    -------
    ndarray of shape (3,), float64, or None
        Unit vector, camera frame; None where the ray misses the ball.
    """
    block, direction = new_block(ATTITUDE), np.empty(3)
    fit = fields(block, ATTITUDE)
    store(fit.limits, AttitudeParameters())
    fit.intrinsics[:], fit.position[:], fit.rim_distance = camera.intrinsics, position, rim_distance
    met = marker_direction(block.view(ATTITUDE)[0], pixel[0], pixel[1], direction, np.empty((3, 5)))
    return direction if met else None
