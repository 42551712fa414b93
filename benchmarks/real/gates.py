"""Which rule says no: candidates and fits where the ball is known to be, and what validation makes of them.

What a tracker says of a loss is the last of many refusals. Here the whole-frame search and the fit are done once more,
with the color that the tracker has at that moment, and only what is at the true place is looked at.
"""

import math

import numpy as np

import matchset as ms
from benchmarks.common.start import Image
from matchset.app.track.score import Circle3, error_px
from matchset.fitting.fitter import Estimate, Fitter
from matchset.fitting.validation import Prior
from matchset.fitting.workspace import SearchWindow
from matchset.tracking.compiled_step import tracking_fitter
from matchset.tracking.detector import DETECTION_LINES, DetectionParameters
from matchset.tracking.search.voting import Searcher

SAME_CENTER, SAME_SIZE = 0.5, 1.7
"""A candidate is at the true place within half a radius, if the radii differ by less than this factor."""
STATISTICS = (
    "msac_score",
    "color_score",
    "residual_autocorrelation",
    "harmonic_score",
    "ellipticity",
    "hollowness",
    "interior_share",
    "core_share",
)


def examine(image: Image, color: ms.ColorModel, truth: Circle3) -> list[str]:
    """Search a picture, fit at the true place, and say what validation makes of it.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3), uint8
    color : ColorModel
    truth : (x, y, radius)
        The true circle, px.

    Returns
    -------
    list of str
        Lines for people.
    """
    searcher, limits = Searcher(image.shape[1], image.shape[0]), DetectionParameters()
    fitter = tracking_fitter(ms.Circle, DETECTION_LINES)
    estimate = fitter.fit(image, color, ms.Circle(*truth).state, SearchWindow(limits.refit_range))
    lines = ["fit from the truth: " + fit_text(estimate, truth), "  " + verdicts_text(fitter, estimate)]
    found = searcher.candidates(image, color)
    near = [rank for rank, each in enumerate(found.tolist()) if is_near((each[0], each[1], each[2]), truth)]
    if not near:
        return [*lines, f"none of {len(found)} candidates is at the true place"]
    x, y, radius, share = found[near[0]].tolist()
    fitter.forget()
    reach = max(limits.range_cells * searcher.stride, limits.range_share * radius)
    estimate = fitter.fit(image, color, ms.Circle(x, y, radius).state, SearchWindow(reach))
    head = f"candidate {near[0] + 1} of {len(found)} at ({x:.0f}, {y:.0f}, {radius:.1f}), share {share:.2f}: "
    return [*lines, head + fit_text(estimate, truth), "  " + verdicts_text(fitter, estimate)]


def is_near(candidate: Circle3, truth: Circle3) -> bool:
    """Say whether a candidate is at the true place, and about as large."""
    far = math.hypot(candidate[0] - truth[0], candidate[1] - truth[1])
    return far < SAME_CENTER * truth[2] and max(candidate[2], truth[2]) < SAME_SIZE * min(candidate[2], truth[2])


def fit_text(estimate: Estimate, truth: Circle3) -> str:
    """Write where a fit ended, and what it rests on."""
    x, y, radius = estimate.state[:3].tolist()
    fit = estimate.fit
    rest = ", ".join(f"{name.replace('_', ' ')} {getattr(fit, name):.2f}" for name in STATISTICS)
    return (
        f"({x:.1f}, {y:.1f}, {radius:.1f}), error {error_px((x, y, radius), truth):.1f} px; "
        f"support {fit.inliers / max(fit.visible, 1.0):.2f}, {rest}"
    )


def verdicts_text(fitter: Fitter[ms.Circle], estimate: Estimate) -> str:
    """Write what validation says if the shape is tracked, expected here, present somewhere, or unknown."""
    validator, fit = fitter.validator, estimate.fit
    said = {"tracked": validator.describe(estimate.rejection, fit)}
    for prior in (Prior.HERE, Prior.PRESENT, Prior.NONE):
        said[prior.name.lower()] = validator.describe(validator.validate_detection(fit, prior), fit)
    return "; ".join(f"{name}: {words or 'yes'}" for name, words in said.items())


def score_picture(image: Image, color: ms.ColorModel) -> Image:
    """Return the color's scores as a gray picture with three channels: white is target, black background."""
    gray = np.clip(128 + color.scores(image).astype(np.int16), 0, 255).astype(np.uint8)
    return np.repeat(gray[:, :, np.newaxis], 3, axis=2)
