"""Ball-like circles in a picture of which nothing is known yet: `find_candidates`.

Circles are proposed in two ways. Every channel of the picture (lightness, the two chroma axes, distance from the most
common color) is thresholded at several levels, and a circle is fitted to the outline of each connected region; Hough's
transform adds circles whose rim is an edge although region and surroundings have one color. Each proposal then gets a
score from the picture. There is no randomness: the same picture gives the same numbers.
"""

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image.circle_score import SCORE, CircleTuple, Floats, LabImage, best_circles, median
from matchset.image.disc_network.lab import lab_of
from matchset.numeric.jit import helper, kernel

Points = npt.NDArray[np.int32]
Picture = npt.NDArray[np.uint8]


class ProposalParameters(msgspec.Struct, frozen=True):
    """Which circles are proposed.

    All were chosen by hand; `tests/app/track/test_learn_command.py` (rendered rooms over clean and noisy links, and a
    real ball) shows a change. More proposals find more balls and take more time.

    Parameters
    ----------
    min_radius, max_radius : float
        Radius of a proposal, px of the searched picture.
    levels : int
        Thresholds per channel.
    min_range : float
        Range of values of a channel that is thresholded, Lab units: below it there is only noise.
    opening : int
        Diameter of the opening that removes thin bridges between regions, px.
    min_outline, min_fit : int
        Points of a region's outline; of them, points that a circle is fitted to.
    area_below, area_above : float
        Area of a region, as multiples of the area of the smallest and of the largest circle.
    min_solidity : float
        Area of a region over the area of its convex hull.
    max_area : float
        Area of a region, as a share of the square over the picture's longer side.
    fit_rounds : int
        Fits of a circle, each without the points far from the one before.
    fit_tolerance, fit_tolerance_px : float
        Distance from the circle at which a point still counts, as a share of the radius and in px; the larger counts.
    min_inliers : float
        Share of the outline's points that must lie on the circle.
    hough_blur : float
        Standard deviation of the blur before Hough's transform, px.
    hough_resolution : float
        Pixels per cell of Hough's accumulator.
    hough_distance : float
        Distance between two centers of Hough's transform, px.
    hough_edge, hough_votes : float
        Canny's upper threshold and the accumulator's threshold (`cv2.HoughCircles`, `param1` and `param2`).
    hough_circles : int
        Circles taken from Hough's transform at most.
    """

    min_radius: float = 5.0
    max_radius: float = 200.0
    levels: int = 10
    min_range: float = 4.0
    opening: int = 5
    min_outline: int = 20
    min_fit: int = 12
    area_below: float = 0.5
    area_above: float = 1.5
    min_solidity: float = 0.6
    max_area: float = 0.5
    fit_rounds: int = 4
    fit_tolerance: float = 0.12
    fit_tolerance_px: float = 1.5
    min_inliers: float = 0.5
    hough_blur: float = 1.5
    hough_resolution: float = 2.0
    hough_distance: float = 12.0
    hough_edge: float = 100.0
    hough_votes: float = 50.0
    hough_circles: int = 40


PROPOSAL = ProposalParameters()


class Candidate(msgspec.Struct, frozen=True):
    """A ball-like circle.

    Parameters
    ----------
    x, y : float
        Center, px.
    radius : float
        Radius, px.
    pick : tuple of int
        A pixel inside it with its most typical color: where to click.
    score : float
        How ball-like it is, 0 ... 1.
    """

    x: float
    y: float
    radius: float
    pick: tuple[int, int]
    score: float


def find_candidates(image: Picture, limit: int = 9) -> list[Candidate]:
    """Find what may be a ball.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3) or (h, w), uint8
        BGR or gray.
    limit : int
        Number of candidates at most.

    Returns
    -------
    list of Candidate
        Most ball-like first.
    """
    small, scale = shrunk(image)
    lab = smooth_lab(small)
    kept: list[tuple[float, CircleTuple]] = []
    for score, circle in best_circles(lab, propose_circles(lab)):
        if len(kept) == limit:
            break
        if not any(_same(circle, other) for _, other in kept):
            kept.append((score, circle))
    return [_candidate(lab, circle, score, scale) for score, circle in kept]


def shrunk(image: npt.NDArray[Any]) -> tuple[npt.NDArray[Any], float]:
    """Reduce a picture to the size in which circles are proposed; returns by what its sides were multiplied, too."""
    scale = min(1.0, SCORE.longest_side / max(image.shape[:2]))
    return cv2.resize(image, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA) if scale < 1.0 else image, scale


def smooth_lab(image: npt.NDArray[Any]) -> LabImage:
    """Convert to CIE Lab, smoothed according to the noise, with lightness weighted less than chroma.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3) or (h, w), uint8
        BGR or gray.

    Returns
    -------
    ndarray of shape (h, w, 3), float32
    """
    color = image if image.ndim == 3 else cv2.cvtColor(image, cv2.COLOR_GRAY2BGR)
    # The median of the Laplacian's magnitude measures the noise: edges are too few to change it.
    roughness = np.abs(cv2.Laplacian(color[..., 1], cv2.CV_32F)).ravel()
    sigma = min(SCORE.max_blur, SCORE.blur + float(median(roughness)) / SCORE.blur_scale)
    lab = lab_of(np.asarray(cv2.GaussianBlur(color, (0, 0), sigma)))
    gray = float(np.percentile(np.abs(lab[..., 1:]), 99.0)) < SCORE.gray_chroma
    lab[..., 0] *= 1.0 if gray else SCORE.lightness
    return lab


def propose_circles(lab: LabImage) -> list[CircleTuple]:
    """Propose circles.

    Parameters
    ----------
    lab : ndarray of shape (h, w, 3), float32
        The picture in CIE Lab.

    Returns
    -------
    list of (x, y, radius)
        In px, many, in no particular order, but the same for the same picture.
    """
    return [circle for mask in _threshold_masks(lab) for circle in _region_circles(mask)] + _hough_circles(lab)


def _threshold_masks(lab: LabImage) -> Iterator[Picture]:
    """Threshold every channel at several levels; yield what is above and what is below."""
    common = median(lab.reshape(-1, 3))
    distance = np.linalg.norm(lab[..., 1:] - common[1:], axis=2)
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (PROPOSAL.opening, PROPOSAL.opening))
    for channel in (lab[..., 0], lab[..., 1], lab[..., 2], distance):
        low, high = (float(value) for value in np.percentile(channel, (0.1, 99.9)))
        if high - low < PROPOSAL.min_range:
            continue
        for level in np.linspace(low, high, PROPOSAL.levels + 2)[1:-1]:
            above = (channel > level).astype(np.uint8)
            for mask in (above, 1 - above):
                yield cv2.morphologyEx(mask, cv2.MORPH_OPEN, kernel).astype(np.uint8, copy=False)


def _region_circles(mask: Picture) -> Iterator[CircleTuple]:
    """Fit a circle to the outline of every region of a mask that may be a disc."""
    contours, _ = cv2.findContours(mask, cv2.RETR_LIST, cv2.CHAIN_APPROX_NONE)
    side = max(mask.shape)
    low, high = PROPOSAL.min_radius, PROPOSAL.max_radius
    smallest, largest = PROPOSAL.area_below * low * low * np.pi, PROPOSAL.area_above * high * high * np.pi
    for contour in contours:
        area = cv2.contourArea(contour)
        if len(contour) < PROPOSAL.min_outline or not smallest < area < largest:
            continue
        hull_area = cv2.contourArea(cv2.convexHull(contour))
        if area < PROPOSAL.min_solidity * hull_area or area > PROPOSAL.max_area * side * side:
            continue
        circle = _fit_circle(np.asarray(contour[:, 0], np.int32))
        if circle is not None and low <= circle[2] <= high:
            yield circle


class FitLimits(NamedTuple):
    """See `ProposalParameters`."""

    rounds: int
    tolerance: float
    tolerance_px: float
    min_points: int
    min_inliers: float


def _fit_circle(points: Points) -> CircleTuple | None:
    """Fit a circle to the points of an outline; None where too few of them lie on it."""
    limits = FitLimits(
        PROPOSAL.fit_rounds, PROPOSAL.fit_tolerance, PROPOSAL.fit_tolerance_px, PROPOSAL.min_fit, PROPOSAL.min_inliers
    )
    circle = np.zeros(3)
    if not fit_circle_kernel(points, limits, circle):
        return None
    return float(circle[0]), float(circle[1]), float(circle[2])


@kernel(refcount=False)
def fit_circle_kernel(points: Points, limits: FitLimits, circle: Floats) -> bool:
    """Fit a circle by least squares (Kasa 1976), repeatedly without the points far from it; whether enough are on it.

    Parameters
    ----------
    points : (n, 2), int32
        px.
    limits : FitLimits
    circle : (3,), float64, written
        x, y and radius, px.
    """
    reach = math.inf  # of the residuals of points that count
    for _ in range(limits.rounds):
        count, mean_x, mean_y = 0, 0.0, 0.0
        for k in range(points.shape[0]):
            if _residual(points, k, circle) < reach:
                count, mean_x, mean_y = count + 1, mean_x + points[k, 0], mean_y + points[k, 1]
        if count < limits.min_points:
            return False
        mean_x, mean_y = mean_x / count, mean_y / count
        xx = xy = yy = xq = yq = 0.0
        for k in range(points.shape[0]):
            if _residual(points, k, circle) < reach:
                x, y = points[k, 0] - mean_x, points[k, 1] - mean_y
                q = x * x + y * y
                xx, xy, yy, xq, yq = xx + x * x, xy + x * y, yy + y * y, xq + x * q, yq + y * q
        # About the mean the sums of x and y vanish, and the normal equations are two.
        determinant = xx * yy - xy * xy
        if not determinant > 1e-9 * xx * yy:
            return False
        x, y = (xq * yy - yq * xy) / (2.0 * determinant), (yq * xx - xq * xy) / (2.0 * determinant)
        circle[0], circle[1] = mean_x + x, mean_y + y
        circle[2] = math.sqrt(max((xx + yy) / count + x * x + y * y, 1e-9))
        reach = max(limits.tolerance * circle[2], limits.tolerance_px)
    count = 0
    for k in range(points.shape[0]):
        count += _residual(points, k, circle) < reach
    return bool(count >= limits.min_inliers * points.shape[0])


@helper
def _residual(points: Points, k: int, circle: Floats) -> float:
    """Distance of a point from a circle, px."""
    return float(abs(math.hypot(points[k, 0] - circle[0], points[k, 1] - circle[1]) - circle[2]))


def _hough_circles(lab: LabImage) -> list[CircleTuple]:
    lightness = lab[..., 0] - lab[..., 0].min()
    light = (255.0 / max(float(lightness.max()), 1.0) * lightness).astype(np.uint8)
    light = cv2.GaussianBlur(light, (0, 0), PROPOSAL.hough_blur)
    found = cv2.HoughCircles(
        light,
        cv2.HOUGH_GRADIENT,
        PROPOSAL.hough_resolution,
        PROPOSAL.hough_distance,
        param1=PROPOSAL.hough_edge,
        param2=PROPOSAL.hough_votes,
        minRadius=2 * round(PROPOSAL.min_radius),
        maxRadius=round(PROPOSAL.max_radius),
    )
    if found is None:
        return []
    circles = found.reshape(-1, 3)[: PROPOSAL.hough_circles]
    return [(float(x), float(y), float(radius)) for x, y, radius in circles]


def _same(one: CircleTuple, other: CircleTuple) -> bool:
    near = np.hypot(one[0] - other[0], one[1] - other[1]) < SCORE.same_distance * max(one[2], other[2])
    return bool(near and SCORE.same_ratio < one[2] / other[2] < 1.0 / SCORE.same_ratio)


def _candidate(lab: LabImage, circle: CircleTuple, score: float, scale: float) -> Candidate:
    """Make a candidate in the pixels of the whole picture, with the best pixel to click."""
    x, y, radius = circle
    left, top = max(math.floor(x - radius), 0), max(math.floor(y - radius), 0)
    part = lab[top : math.ceil(y + radius) + 1, left : math.ceil(x + radius) + 1]
    rows, columns = np.indices(part.shape[:2])
    distance = np.hypot(columns + left - x, rows + top - y)
    deviation = np.linalg.norm(part - median(part[distance < 0.75 * radius]), axis=2)
    # Among pixels that are equally typical, the one closest to the center is the safest click.
    best = np.argmin(np.where(distance < 0.5 * radius, deviation + 4.0 * distance / radius, np.inf))
    row, column = np.add(np.unravel_index(best, part.shape[:2]), (top, left)).tolist()
    pick = round((column + 0.5) / scale - 0.5), round((row + 0.5) / scale - 0.5)
    return Candidate((x + 0.5) / scale - 0.5, (y + 0.5) / scale - 0.5, radius / scale, pick, score)
