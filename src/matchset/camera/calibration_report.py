"""How good a calibration is, in words: `grade_calibration`."""

from typing import Literal

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.camera.board import BoardView
from matchset.camera.calibrate import Calibration
from matchset.camera.lens import INTRINSICS

Grade = Literal["good", "usable", "poor"]

_RANKS: dict[Grade, int] = {"good": 0, "usable": 1, "poor": 2}  # format: the grades, best first
_CELLS = 24, 18  # geometry: of the grid on which coverage is counted
_CORNER = 0.2  # geometry: share of the width and height that counts as a corner of the image
_CORNERS = "upper left", "upper right", "lower left", "lower right"


class GradeParameters(msgspec.Struct, frozen=True, kw_only=True):
    """From what value on a calibration is good, or usable.

    All were chosen by hand, after the calibrations of
    docs/log/localization.md#calibration; docs/camera.md has the table.

    Parameters
    ----------
    error_px : tuple of 2 float
        Largest rms reprojection error that is good, and that is usable.
    views : tuple of 2 int
        Least number of different views.
    coverage : tuple of 2 float
        Least share of the image in which the board was seen.
    missing_corners : tuple of 2 int
        Most corners of the image in which it was not.
    tilt_deg : tuple of 2 float
        Least range of the board's tilt, the smaller of both directions.
    focal_sigma : tuple of 2 float
        Largest standard deviation of the focal length, as a share of it.
    """

    error_px: tuple[float, float] = (0.4, 1.0)
    views: tuple[int, int] = (12, 6)
    coverage: tuple[float, float] = (0.6, 0.35)
    missing_corners: tuple[int, int] = (0, 2)
    tilt_deg: tuple[float, float] = (40.0, 20.0)
    focal_sigma: tuple[float, float] = (0.003, 0.01)


class Finding(msgspec.Struct, frozen=True):
    """One property of a calibration.

    Parameters
    ----------
    name : str
        What.
    grade : str
        "good", "usable" or "poor".
    words : str
        The figure, and what to do about it if it is not good.
    """

    name: str
    grade: Grade
    words: str


class CalibrationReport(msgspec.Struct, frozen=True):
    """How good a calibration is.

    Parameters
    ----------
    grade : str
        "good", "usable" or "poor": the worst of the findings.
    findings : list of Finding
        Error, views, coverage, tilt, focal length.
    """

    grade: Grade
    findings: list[Finding]


def grade_calibration(calibration: Calibration, parameters: GradeParameters | None = None) -> CalibrationReport:
    """Grade a calibration by its error, views, coverage, tilt and focal length.

    Parameters
    ----------
    calibration : Calibration
    parameters : GradeParameters, optional

    Returns
    -------
    CalibrationReport
    """
    limits = parameters or GradeParameters()
    findings = [rule(calibration, limits) for rule in (_error, _views, _coverage, _tilt, _focal)]
    return CalibrationReport(max((finding.grade for finding in findings), key=_RANKS.__getitem__), findings)


def covered_cells(views: list[BoardView], width: int, height: int) -> npt.NDArray[np.bool_]:
    """Cells of the image in which the board was seen.

    Parameters
    ----------
    views : list of BoardView
    width, height : int
        Size of the picture, px.

    Returns
    -------
    ndarray of shape (18, 24), bool
        Cells that lay within the board's corners in some view.
    """
    cells = np.zeros(_CELLS[::-1], np.uint8)
    scale = np.array(_CELLS) / (width, height)
    for view in views:
        hull = cv2.convexHull((((view.pixels + 0.5) * scale - 0.5) * 16.0).round().astype(np.int32))
        cv2.fillConvexPoly(cells, hull, 1, cv2.LINE_8, 4)
    return cells.astype(np.bool_)


def unseen_corners(views: list[BoardView], width: int, height: int) -> list[str]:
    """Name the corners of the picture in which no corner of the board was seen, from what `covered_cells` takes.

    Returns
    -------
    list of str
        Of "upper left", "upper right", "lower left", "lower right".
    """
    pixels = np.concatenate([view.pixels for view in views]) if views else np.empty((0, 2))
    left, right = pixels[:, 0] < _CORNER * width, pixels[:, 0] > (1.0 - _CORNER) * width
    upper, lower = pixels[:, 1] < _CORNER * height, pixels[:, 1] > (1.0 - _CORNER) * height
    seen = (upper & left).any(), (upper & right).any(), (lower & left).any(), (lower & right).any()
    return [name for name, there in zip(_CORNERS, seen, strict=True) if not there]


def _at_most(value: float, limits: tuple[float, float]) -> Grade:
    """Grade what should be small."""
    good, usable = limits
    return "good" if value <= good else "usable" if value <= usable else "poor"


def _at_least(value: float, limits: tuple[float, float]) -> Grade:
    """Grade what should be large."""
    return _at_most(-value, (-limits[0], -limits[1]))


def _with_advice(grade: Grade, figure: str, advice: str) -> str:
    return figure if grade == "good" else f"{figure}: {advice}"


def _error(calibration: Calibration, limits: GradeParameters) -> Finding:
    grade = _at_most(calibration.error, limits.error_px)
    advice = "hold the board still and keep it flat; more light, shorter exposure"
    return Finding("error", grade, _with_advice(grade, f"corners are {calibration.error:.2f} px off (rms)", advice))


def _views(calibration: Calibration, limits: GradeParameters) -> Finding:
    count = len(calibration.views)
    grade = _at_least(count, limits.views)
    figure = f"{count} different views"
    if calibration.left_out:
        figure += f", {len(calibration.left_out)} left out that did not fit"
    return Finding("views", grade, _with_advice(grade, figure, "12 are better"))


def _coverage(calibration: Calibration, limits: GradeParameters) -> Finding:
    size = calibration.camera.width, calibration.camera.height
    share = float(covered_cells(calibration.views, *size).mean())
    unseen = unseen_corners(calibration.views, *size)
    grade = max(
        _at_least(share, limits.coverage), _at_most(len(unseen), limits.missing_corners), key=_RANKS.__getitem__
    )
    figure = f"{100.0 * share:.0f} % of the picture, {4 - len(unseen)} of its 4 corners"
    where = f"hold the board at the {', '.join(unseen)}" if unseen else "hold it nearer to the edges of the picture"
    return Finding("coverage", grade, _with_advice(grade, figure, where + "; there the lens is extrapolated"))


def _tilt(calibration: Calibration, limits: GradeParameters) -> Finding:
    normals = calibration.normals
    sideways = float(np.rad2deg(np.ptp(np.arctan2(normals[:, 0], normals[:, 2]))))
    upward = float(np.rad2deg(np.ptp(np.arctan2(normals[:, 1], normals[:, 2]))))
    grade = _at_least(min(sideways, upward), limits.tilt_deg)
    figure = f"turned by {sideways:.0f} degrees left to right, {upward:.0f} up and down"
    return Finding("tilt", grade, _with_advice(grade, figure, "40 in both are better"))


def _focal(calibration: Calibration, limits: GradeParameters) -> Finding:
    camera = calibration.camera
    spread = np.zeros(9) if camera.covariance is None else np.sqrt(np.diag(camera.covariance))
    share = float(max(spread[0] / camera.fx, spread[1] / camera.fy))
    grade = _at_most(share, limits.focal_sigma)
    numbers = zip(INTRINSICS, camera.intrinsics, spread, strict=True)
    figure = ", ".join(f"{name} {value:.{_digits(step)}f} ± {step:.{_digits(step)}f}" for name, value, step in numbers)
    return Finding(
        "numbers", grade, _with_advice(grade, figure, f"focal length to {100.0 * share:.1f} % only, tilt more")
    )


def _digits(spread: float) -> int:
    """Decimals that a standard deviation warrants: two of its own digits."""
    return 2 if spread <= 0.0 else int(min(max(1 - np.floor(np.log10(spread)), 0), 6))
