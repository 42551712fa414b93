"""The best outline in a picture that was not believed, and why: `best_rejected`."""

import math
from collections.abc import Iterator
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.fitting.fitter import Estimate, Fitter
from matchset.fitting.validation import Prior
from matchset.fitting.workspace import SearchWindow
from matchset.image.candidates import find_candidates
from matchset.image.color import ColorModel
from matchset.image.frame import channels_last
from matchset.shapes.shape import finds_itself, from_hull
from matchset.tracking.compiled_step import tracking_fitter
from matchset.tracking.detector import DETECTION_LINES
from matchset.tracking.search.voting import Searcher

Floats = npt.NDArray[np.float64]
Picture = npt.NDArray[np.uint8]

NOT_REACHED = "it would do, but the search of the whole picture did not come across it: click on it"


class RejectedParameters(msgspec.Struct, frozen=True):
    """How the best rejected outline is looked for; nothing but a picture and a sentence depends on it.

    Parameters
    ----------
    range_share, range_px : float
        Search range around a candidate, as a share of its half-width, and the least, px: as wide as that of a detection
        (`DetectionParameters`). Chosen by hand.
    candidates : int
        Circles that are looked at although nothing is known of their color. More take longer. Chosen by hand.
    """

    range_share: float = 0.2
    range_px: float = 6.0
    candidates: int = 5


PARAMETERS = RejectedParameters()


class RejectedOutline(msgspec.Struct, frozen=True):
    """An outline that was not believed.

    Parameters
    ----------
    shape : Shape
    reason : str
        Why, in words.
    """

    shape: Any
    reason: str


def best_rejected(
    image: Picture, family: type[Any], color: ColorModel, click: tuple[float, float] | None = None
) -> RejectedOutline | None:
    """Find the outline for which most speaks, and say why it is not believed.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3) or (h, w), uint8
    family : type
        The family of shapes.
    color : ColorModel
        The target's.
    click : tuple of float, optional
        Where somebody clicked, px: an outline that holds it goes before others.

    Returns
    -------
    RejectedOutline or None
        None where there is nothing to fit at all.
    """
    color, whole = color.for_image(image), channels_last(image)
    fitter: Fitter[Any] = tracking_fitter(family, DETECTION_LINES, uses_color=color.gray != "edges")
    best: tuple[tuple[bool, float], Estimate] | None = None
    for state in _starts(image, family, color):
        reach = max(PARAMETERS.range_px, PARAMETERS.range_share * float(family.half_width(state)))
        estimate = fitter.weigh(fitter.fit(whole, color, state, SearchWindow(reach)), whole, color)
        size = float(family.half_width(estimate.state))
        if not estimate.is_fitted or not size > 0.0:
            continue
        holds = click is not None and math.dist(estimate.state[:2].tolist(), click) < size
        merit = estimate.fit.color_score if estimate.evidence is None else estimate.evidence
        if best is None or (holds, merit) > best[0]:
            best = (holds, merit), estimate
    if best is None:
        return None
    estimate = best[1]
    prior = Prior.PRESENT if best[0][0] else Prior.NONE
    reason = fitter.validator.describe(fitter.validate_detection(estimate, prior), estimate.fit)
    try:
        return RejectedOutline(family.from_state(estimate.state), reason or NOT_REACHED)
    except ValueError:  # the fit has turned it inside out
        return None


def _starts(image: Picture, family: type[Any], color: ColorModel) -> Iterator[Floats]:
    """States to begin at: what a search for the color proposes, the clicked circle, and whatever looks like a ball."""
    height, width = image.shape[:2]
    searcher, whole = Searcher(width, height), channels_last(image)
    for sought in color.search_models(image):
        if finds_itself(family):
            for hull in searcher.hulls(whole, sought):
                yield from (shape.state for shape in from_hull(family, hull))
        else:
            for x, y, radius, _ in searcher.candidates(whole, sought).tolist():
                yield family.from_coarse(x, y, radius).state
    if color.circle is not None:
        yield family.from_coarse(*color.circle).state
    for each in find_candidates(image, PARAMETERS.candidates):
        yield family.from_coarse(each.x, each.y, each.radius).state
