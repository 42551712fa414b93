"""Calibrates a camera from views of a board (Zhang's method, in OpenCV), with the covariance of its numbers."""

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.camera.board import BoardView
from matchset.camera.camera_model import CameraModel

Floats = npt.NDArray[np.float64]


class CalibrationParameters(msgspec.Struct, frozen=True, kw_only=True):
    """What is demanded of a calibration.

    All were chosen by hand; tests/camera/test_calibrate.py would show a change.

    Parameters
    ----------
    min_views : int, default 6
        With fewer it is refused. Three would do in theory; more average out how the board was held.
    min_tilt : float, default 0.2
        The board's normals must differ by this, rad. A board that always faces the camera looks the same if it is twice
        as large at twice the distance: the focal length is not observable.
    max_error_px : float, default 2.0
        Largest rms reprojection error: above, the board is bent, corners are wrong, the lens is a fisheye, or the board
        moved before a rolling shutter.
    max_focal_sigma : float, default 0.03
        Largest standard deviation of the focal length, as a share of it; a range is as uncertain as this.
    outlier_ratio : float, default 3.0
        A view whose error is above this many medians is left out. Less throws away good views.
    min_outlier_px : float, default 0.1
        That median is at least this.
    outlier_rounds : int, default 3
        How often views are left out at most.
    """

    min_views: int = 6
    min_tilt: float = 0.2
    max_error_px: float = 2.0
    max_focal_sigma: float = 0.03
    outlier_ratio: float = 3.0
    min_outlier_px: float = 0.1
    outlier_rounds: int = 3


class Calibration(msgspec.Struct, frozen=True):
    """A camera and how it was found.

    Parameters
    ----------
    camera : CameraModel
        With the covariance of its numbers.
    error : float
        Rms distance of the corners from where the camera says they are, px.
    views : list of BoardView
        Those that were used.
    errors : ndarray of shape (n,), float64
        Rms distance of each view, px.
    normals : ndarray of shape (n, 3), float64
        The board's direction in each view: the unit normal that points away from the camera.
    left_out : list of BoardView
        Those that did not fit.
    """

    camera: CameraModel
    error: float
    views: list[BoardView]
    errors: Floats
    normals: Floats
    left_out: list[BoardView]


class _Solution(msgspec.Struct):
    matrix: Floats
    lens: Floats
    turns: list[Floats]
    shifts: list[Floats]
    errors: Floats


def calibrate(
    views: list[BoardView], width: int, height: int, parameters: CalibrationParameters | None = None
) -> Calibration:
    """Find the camera that explains the views.

    Minimizes the distance of the seen corners from the projected ones over the four numbers of the pinhole, five of the
    lens and the board's poses. The covariance is that of least squares, sigma^2 (J^T J)^-1, with the poses eliminated
    and sigma from the residuals (Z. Zhang, "A flexible new technique for camera calibration", 2000).

    Parameters
    ----------
    views : list of BoardView
        Different ones, see `select_views`.
    width, height : int
        Size of the pictures, px.
    parameters : CalibrationParameters, optional

    Returns
    -------
    Calibration

    Raises
    ------
    ValueError
        In words, if the views are too few or too similar, or no camera explains them.
    """
    wanted = parameters or CalibrationParameters()
    _check_count(len(views), wanted)
    kept, solution = list(views), _solve(views, width, height)
    for _ in range(wanted.outlier_rounds):
        good = solution.errors <= wanted.outlier_ratio * max(float(np.median(solution.errors)), wanted.min_outlier_px)
        if good.all():
            break
        kept = [view for view, fits in zip(kept, good, strict=True) if fits]
        _check_count(len(kept), wanted, f" that agree with each other, of {len(views)}")
        solution = _solve(kept, width, height)
    normals = _normals(solution)
    _check_tilt(normals, wanted)
    weights = np.array([len(view.corners) for view in kept])
    error = float(np.sqrt(np.average(solution.errors**2, weights=weights)))
    if not error <= wanted.max_error_px:
        raise ValueError(
            f"the corners are {error:.1f} px from where any camera would see them: is the board flat, held still, "
            "and of as many corners as was said? A fisheye lens cannot be calibrated"
        )
    camera = _camera(kept, solution, width, height)
    uncertain = float(np.sqrt(np.diag(np.array(camera.intrinsics_covariance))[:2]).max()) / camera.fx
    if not uncertain <= wanted.max_focal_sigma:
        raise ValueError(
            f"the views are too similar: the focal length is uncertain by {100.0 * uncertain:.1f} %. "
            "Tilt the board more, in every direction, and bring it closer"
        )
    left_out = [view for view in views if not any(view is used for used in kept)]
    return Calibration(camera, error, kept, solution.errors, normals, left_out)


def _check_count(count: int, wanted: CalibrationParameters, which: str = "") -> None:
    if count < wanted.min_views:
        raise ValueError(
            f"{count} different view{'s' * (count != 1)} of the board{which}: at least {wanted.min_views} are "
            "needed. Move it all over the picture and tilt it differently each time"
        )


def _check_tilt(normals: Floats, wanted: CalibrationParameters) -> None:
    widest = float(np.arccos(np.clip(normals @ normals.T, -1.0, 1.0)).max())
    if widest < wanted.min_tilt:
        raise ValueError(
            f"the views are too similar: the board's tilt differs by {np.rad2deg(widest):.0f} degrees only, and the "
            "focal length cannot be told from the distance. Tilt it by 20 to 40 degrees, left, right, up and down"
        )


def _solve(views: list[BoardView], width: int, height: int) -> _Solution:
    points = [view.points.astype(np.float32) for view in views]
    pixels = [view.pixels.astype(np.float32) for view in views]
    until = cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 200, 1e-12
    try:
        _, matrix, lens, turns, shifts, _, _, errors = cv2.calibrateCameraExtended(
            points, pixels, (width, height), np.eye(3), np.zeros(5), criteria=until
        )
    except cv2.error as error:
        raise ValueError(f"no camera explains these views ({' '.join(str(error.err).split())})") from error
    solution = _Solution(
        matrix=np.asarray(matrix, np.float64),
        lens=np.asarray(lens, np.float64).ravel()[:5],
        turns=[np.asarray(turn, np.float64).ravel() for turn in turns],
        shifts=[np.asarray(shift, np.float64).ravel() for shift in shifts],
        errors=np.asarray(errors, np.float64).ravel(),
    )
    everything = [solution.matrix, solution.lens, solution.errors, *solution.turns, *solution.shifts]
    if not all(np.isfinite(numbers).all() for numbers in everything):
        raise ValueError("no camera explains these views")
    return solution


def _normals(solution: _Solution) -> Floats:
    normals = np.array([cv2.Rodrigues(turn)[0][:, 2] for turn in solution.turns])
    return normals * np.where(normals[:, 2:] < 0.0, -1.0, 1.0)


def _camera(views: list[BoardView], solution: _Solution, width: int, height: int) -> CameraModel:
    matrix, lens = solution.matrix, solution.lens
    k1, k2, p1, p2, k3 = lens.tolist()
    covariance = _covariance(views, solution)
    try:
        return CameraModel(
            width=width,
            height=height,
            fx=float(matrix[0, 0]),
            fy=float(matrix[1, 1]),
            cx=float(matrix[0, 2]),
            cy=float(matrix[1, 2]),
            distortion=(k1, k2, p1, p2, k3),
            intrinsics_covariance=tuple(tuple(row) for row in covariance.tolist()),
        )
    except ValueError as error:
        raise ValueError(f"the views are too similar or do not belong together: {error}") from error


def _covariance(views: list[BoardView], solution: _Solution) -> Floats:
    """Covariance of fx, fy, cx, cy, k1, k2, p1, p2, k3, with the poses eliminated (Schur complement).

    Corners of one view err together (a board that is not quite flat, blur, light), so the noise is taken from what the
    views as a whole pull at the camera, if that is more than their corners, taken one by one, would.
    """
    information, pulls, squares, count = np.zeros((9, 9)), [], 0.0, 0
    for view, turn, shift in zip(views, solution.turns, solution.shifts, strict=True):
        seen, jacobian = cv2.projectPoints(view.points, turn, shift, solution.matrix, solution.lens)
        residual = (np.asarray(seen).reshape(-1, 2) - view.pixels).ravel()
        pose, camera = np.asarray(jacobian)[:, :6], np.asarray(jacobian)[:, 6:15]
        # What the pose explains is taken out of the camera's columns.
        camera = camera - pose @ np.linalg.lstsq(pose, camera, rcond=None)[0]
        information += camera.T @ camera
        pulls.append(camera.T @ residual)
        squares += float(residual @ residual)
        count += len(residual) - 6
    scale = 1.0 / np.sqrt(np.maximum(np.diag(information), 1e-300))
    inverse = np.linalg.pinv(information * np.outer(scale, scale), hermitian=True, rcond=1e-14) * np.outer(scale, scale)
    together = sum(float(pull @ inverse @ pull) for pull in pulls) / 9.0 * len(views) / (len(views) - 2)
    covariance = max(squares / max(count - 9, 1), together) * inverse
    return np.asarray(0.5 * (covariance + covariance.T))
