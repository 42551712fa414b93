"""Estimates the focal length from the ball itself, held at a few known distances."""

import math

import msgspec
import numpy as np
import numpy.typing as npt
from scipy.optimize import least_squares

from matchset.camera.camera_model import CameraModel

Floats = npt.NDArray[np.float64]


class BallFocalParameters(msgspec.Struct, frozen=True, kw_only=True):
    """What is known before the ball is measured (one sigma each), and what is demanded of the measurement.

    All were chosen by hand; tests/camera/test_ball_focal_length.py would show a change.

    Parameters
    ----------
    tape_sigma : float, default 0.004
        Error of a taped distance, m, independent of the others. Larger trusts the distances less, and the result says
        so.
    pupil_sigma : float, default 0.01
        Distance of the camera's center of projection from where the tape begins, m: it is somewhere in the lens. It is
        estimated along with the focal length, the better the more the distances differ.
    edge_sigma_px : float, default 0.25
        Common shift of all edges, outward or inward: blur and the color table move them alike.
    center_sigma : float, default 0.02
        Distance of the principal point from the middle of the image, in widths.
    k1_sigma : float, default 0.1
        Radial distortion k1: a ball tells nothing about the lens.
    point_sigma_px : float, default 0.05
        Error of a half-angle that remains however many outlines there are.
    min_distance_ratio : float, default 1.3
        Least ratio of the largest to the smallest distance.
    min_distance_radii : float, default 1.05
        Least distance of the ball's center, in its radii.
    max_misfit : float, default 0.08
        Largest difference between the ball's size in the image and the expected one, as a share.
    max_outlines : int, default 10
        Outlines of one distance that are used: more of them have the same error.
    min_points : int, default 8
        Least number of points of an outline.
    outlier_ratio : float, default 4.0
        Points whose residual is above this many medians are left out.
    """

    tape_sigma: float = 0.004
    pupil_sigma: float = 0.01
    edge_sigma_px: float = 0.25
    center_sigma: float = 0.02
    k1_sigma: float = 0.1
    point_sigma_px: float = 0.05
    min_distance_ratio: float = 1.3
    min_distance_radii: float = 1.05
    max_misfit: float = 0.08
    max_outlines: int = 10
    min_points: int = 8
    outlier_ratio: float = 4.0


class HeldBall(msgspec.Struct, frozen=True):
    """The ball at one distance.

    Parameters
    ----------
    distance : float
        From where the lens is to the center of the ball, m.
    outlines : list of ndarray of shape (m, 2), float64
        Match-sets of the frames in which it was held there, px.
    """

    distance: float
    outlines: list[Floats]


class BallFocal(msgspec.Struct, frozen=True):
    """A camera whose focal length was estimated from a ball.

    Parameters
    ----------
    camera : CameraModel
        Square pixels, principal point in the middle, no distortion; its covariance says how little is known of these.
    pupil : float
        How far behind the point from which was measured the center of projection lies, m.
    misfits : list of float
        By how much the ball looks too large at each distance, as a share of its size.
    """

    camera: CameraModel
    pupil: float
    misfits: list[float]


def focal_from_ball(
    held: list[HeldBall], radius: float, width: int, height: int, parameters: BallFocalParameters | None = None
) -> BallFocal:
    """Estimate the focal length from the apparent size of a ball at known distances.

    The rays of its outline form a cone of half-angle alpha, sin(alpha) = R / distance (Epstein & Feldman, Eq. 5,
    exact). Least squares over the focal length, the place of the center of projection and a shift of all edges. An
    error of the radius goes into the focal length in full, and cancels when the same ball is located.

    Parameters
    ----------
    held : list of HeldBall
        At two different distances or more.
    radius : float
        Of the ball, m.
    width, height : int
        Size of the pictures, px.
    parameters : BallFocalParameters, optional

    Returns
    -------
    BallFocal

    Raises
    ------
    ValueError
        In words, if the distances are too few or too similar, or do not fit the ball.
    """
    known = parameters or BallFocalParameters()
    _check(held, radius, known)
    fit = _Fit(held, radius, width, height, known)
    middle = np.array([(width - 1) / 2.0, (height - 1) / 2.0, 0.0])
    found, covariance, misfits = fit.solve(middle, fit.guess())
    # Principal point and distortion are not observed; their uncertainty goes into that of the focal length.
    spread = np.array([known.center_sigma * width, known.center_sigma * width, known.k1_sigma])
    slope = np.array(
        [(fit.solve(middle + step, found)[0][0] - found[0]) / step.sum() for step in np.diag(0.5 * spread)]
    )
    focal = math.exp(found[0])
    factor = np.zeros((9, 4))  # of the covariance: the focal length's own, and the three unseen
    factor[:2, 0] = focal * math.sqrt(covariance[0, 0])
    factor[:2, 1:] = focal * slope * spread
    factor[[2, 3, 4], [1, 2, 3]] = spread
    rows = tuple(tuple(row) for row in (factor @ factor.T).tolist())
    camera = CameraModel(
        width=width,
        height=height,
        fx=focal,
        fy=focal,
        cx=float(middle[0]),
        cy=float(middle[1]),
        intrinsics_covariance=rows,
    )
    return BallFocal(camera, float(found[1]), misfits)


def _check(held: list[HeldBall], radius: float, known: BallFocalParameters) -> None:
    if not 0.0 < radius < math.inf:
        raise ValueError(f"a ball's radius must be positive, in m, got {radius}")
    distances = [ball.distance for ball in held]
    for distance in distances:
        if not known.min_distance_radii * radius < distance < math.inf:
            raise ValueError(f"the ball's center must be farther away than its radius of {radius} m, got {distance} m")
    if len(distances) < 2 or max(distances) < known.min_distance_ratio * min(distances):
        given = ", ".join(f"{distance:.2f}" for distance in distances) or "none"
        raise ValueError(
            "hold the ball at two or more distances, the largest at least "
            f"{known.min_distance_ratio} times the smallest; its center was at {given} m"
        )
    for ball in held:
        if not any(len(outline) >= known.min_points for outline in ball.outlines):
            raise ValueError(f"the ball was not seen at {ball.distance:.2f} m")


class _Fit:
    def __init__(
        self, held: list[HeldBall], radius: float, width: int, height: int, known: BallFocalParameters
    ) -> None:
        self.held, self.radius, self.width, self.height, self.known = held, radius, width, height, known
        self._distances = np.array([ball.distance for ball in held])

    def guess(self) -> Floats:
        """Log f from radius times distance; the rest as it should be."""
        spans = np.array([np.mean([np.ptp(points, axis=0).max() for points in ball.outlines]) for ball in self.held])
        return np.array([math.log(float(np.median(0.5 * spans * self._distances / self.radius))), 0.0, 0.0])

    def solve(self, lens: Floats, start: Floats) -> tuple[Floats, Floats, list[float]]:
        """Find log f, pupil (m) and edge shift (px) for cx, cy, k1; with their covariance, and the misfits."""
        scale = np.array([0.01, self.known.pupil_sigma, self.known.edge_sigma_px])

        def residual(step: Floats) -> Floats:
            return self._residual(start + step * scale, lens)

        result = least_squares(residual, np.zeros(3), xtol=1e-6, ftol=1e-8)
        found = start + result.x * scale
        doubt = max(1.0, 2.0 * result.cost / max(len(self.held) - 1, 1))
        covariance = doubt * np.linalg.inv(result.jac.T @ result.jac) * np.outer(scale, scale)
        seen, must = self._angles(found, lens)
        misfits = [float(value) for value in seen[0] / must - 1.0]
        worst = int(np.argmax(np.abs(misfits)))
        if not abs(misfits[worst]) <= self.known.max_misfit:
            raise ValueError(
                f"the distances do not fit the ball: at {self._distances[worst]:.2f} m it looks "
                f"{abs(100.0 * misfits[worst]):.0f} % too {'large' if misfits[worst] > 0.0 else 'small'}. Are they, "
                "and its diameter, in meters, and in the order of the videos?"
            )
        return found, covariance, misfits

    def _residual(self, numbers: Floats, lens: Floats) -> Floats:
        (seen, spread), must = self._angles(numbers, lens)
        tape = np.tan(must) / self._distances * self.known.tape_sigma
        prior = numbers[1:] / (self.known.pupil_sigma, self.known.edge_sigma_px)
        return np.concatenate(((seen - must) / np.hypot(spread, tape), prior))

    def _angles(self, numbers: Floats, lens: Floats) -> tuple[tuple[Floats, Floats], Floats]:
        """Half-angles that are seen, with their standard errors, and those that must be."""
        focal, pupil, shift = math.exp(min(max(numbers[0], 0.0), 15.0)), numbers[1], numbers[2]
        camera = CameraModel(
            width=self.width,
            height=self.height,
            fx=focal,
            fy=focal,
            cx=float(lens[0]),
            cy=float(lens[1]),
            distortion=(float(lens[2]), 0.0, 0.0, 0.0, 0.0),
        )
        seen = np.array([half_angle(camera, ball.outlines, shift, self.known) for ball in self.held])
        ratio = self.radius / np.maximum(self._distances + pupil, 1.001 * self.radius)
        return (seen[:, 0], seen[:, 1]), np.arcsin(ratio)


def half_angle(
    camera: CameraModel, outlines: list[Floats], shift: float, known: BallFocalParameters
) -> tuple[float, float]:
    """Find the half-angle of the cones through some outlines.

    Parameters
    ----------
    camera : CameraModel
    outlines : list of ndarray of shape (m, 2), float64
        Match-sets of a ball held still, px.
    shift : float
        By which the edges are moved inward first, px.
    known : BallFocalParameters

    Returns
    -------
    tuple of 2 float
        Their median, rad, and its standard error; 0 and 1 if there are too few points.
    """
    angles = []
    for outline in outlines[:: -(-len(outlines) // known.max_outlines)]:
        if len(outline) < known.min_points:
            continue
        away = outline - outline.mean(axis=0)
        rays = camera.rays(outline - shift * away / np.linalg.norm(away, axis=1, keepdims=True).clip(1.0))
        rays = rays[rays[:, 2] > 0.0]
        # The cone: ray . axis = cos(alpha); with n = axis / cos(alpha) it is linear, ray . n = 1.
        off = np.abs(rays @ _plane(rays) - 1.0)
        slope = float(np.linalg.norm(_plane(rays[off <= known.outlier_ratio * np.median(off) + 1e-12])))
        angles.append(math.acos(min(1.0 / max(slope, 1.0), 1.0)))
    if not angles:
        return 0.0, 1.0
    # The errors of a ball held still are correlated: more frames than `max_outlines` count as these.
    spread = float(np.std(angles)) / math.sqrt(min(len(angles), known.max_outlines)) if len(angles) > 1 else 0.0
    return float(np.median(angles)), math.hypot(spread, known.point_sigma_px / camera.fx)


def _plane(rays: Floats) -> Floats:
    """Least-squares n of rays . n = 1, by normal equations: rays of a cone of some degrees are well conditioned."""
    n: Floats = np.linalg.solve(rays.T @ rays + 1e-14 * np.eye(3), rays.sum(axis=0))
    return n
