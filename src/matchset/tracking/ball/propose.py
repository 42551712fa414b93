"""The first step of the search for a ball: from which circles the network is led, `propose`.

Where the ball is expected and was seen last, where a turning camera took it, what has arrived, and where its color
stands out, the likeliest first. Of a whole picture that is large in cells a part is read, the next part in the next
picture.
"""

import itertools
import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from matchset.image.color import ColorModel
from matchset.image.disc_network.patch_format import Circle3
from matchset.tracking.ball.belief import Belief
from matchset.tracking.ball.discs import are_same
from matchset.tracking.ball.log_odds import ExpectedPlace, log_prior_of_place, log_prior_of_size
from matchset.tracking.ball.parameters import BallSearchParameters
from matchset.tracking.ball.places.changes import Arrival, PictureChanges
from matchset.tracking.ball.places.color_places import places_of_color
from matchset.tracking.constants import TrackerConstants

Image = npt.NDArray[np.uint8]


class BallSearch(NamedTuple):
    """A picture in which a ball is looked for.

    Attributes
    ----------
    image : ndarray of shape (h, w, channels), uint8
    color : ColorModel
    expected : ExpectedPlace
    is_expected : bool
        Whether it was seen lately, and should be there.
    interval : float
        Since the picture before, s.
    changes : PictureChanges or None
        What has moved; None where that says nothing.
    arrived : list of Arrival
    is_told : bool
        Whether an arrival may be the ball: it is expected, or nothing else of its color has left.
    """

    image: Image
    color: ColorModel
    expected: ExpectedPlace
    is_expected: bool
    interval: float
    changes: PictureChanges | None
    arrived: list[Arrival]
    is_told: bool


def propose(belief: Belief, search: BallSearch, parameters: TrackerConstants) -> tuple[list[Circle3], list[Circle3]]:
    """Propose circles from which the network is led, the likeliest first.

    Parameters
    ----------
    belief : Belief
    search : BallSearch
    parameters : TrackerConstants

    Returns
    -------
    list of (x, y, radius)
        px.
    list of (x, y, radius)
        Those of them that its color proposed.
    """
    limits, expected = parameters.ball, search.expected
    ranked = [(math.inf, (expected.x, expected.y, expected.radius))] if search.is_expected else []
    ranked.append((0.0 if search.is_expected else math.inf, belief.circle))
    ranked += [(math.inf, circle) for circle in _carried(belief, search)]
    for rank, arrival in enumerate(search.arrived[: limits.starts - 1]):
        circle = arrival.x, arrival.y, expected.radius
        told = limits.weights.arrived * told_by_arrivals(search, limits)
        ranked.append((told + _merit(rank, circle, search, limits), circle))
    colored = _colored(belief, search, parameters)
    for each in colored:
        ranked += [(_merit(rank, circle, search, limits), circle) for rank, circle in enumerate(each)]
    starts = list[Circle3]()
    for _, circle in sorted(ranked, key=lambda each: -each[0]):
        if not any(are_same(circle, each, limits.same) for each in starts):
            starts.append(circle)
    starts = starts[: limits.starts]
    return starts, [circle for circle in dict.fromkeys(itertools.chain(*colored)) if circle in starts]


def told_by_arrivals(search: BallSearch, limits: BallSearchParameters) -> float:
    """How much an arrival says, of 1: less where much has moved, where several things have arrived, and later on.

    Where something else of the ball's color has left, that has arrived: it speaks against the ball.

    Parameters
    ----------
    search : BallSearch
    limits : BallSearchParameters
    """
    if search.changes is None or not search.arrived:
        return 0.0
    calm = 1.0 - search.changes.share / limits.changes.most_share
    if not search.is_told:
        return -limits.rival * calm
    recent = math.exp(-(search.expected.missed - 1.0) / limits.recent)
    return max(calm * recent - math.log(len(search.arrived)) / limits.weights.arrived, 0.0)


def arrived_at(search: BallSearch, circle: Circle3, limits: BallSearchParameters) -> float:
    """How much it says that something has arrived at a disc: less where much has moved, or of another mass.

    Parameters
    ----------
    search : BallSearch
    circle : (x, y, radius)
        px.
    limits : BallSearchParameters
    """
    if search.changes is None:
        return 0.0
    near = max(circle[2], limits.least_near)
    sizes = [each.radius for each in search.arrived if math.dist(circle[:2], each[:2]) <= near]
    if not sizes:
        return 0.0
    off = min(abs(math.log(size / search.expected.mass_radius())) for size in sizes)
    fits = min((math.log(limits.changes.growth) - off) / math.log(limits.fits), 1.0)
    return told_by_arrivals(search, limits) * max(fits, 0.0)


def _colored(belief: Belief, search: BallSearch, parameters: TrackerConstants) -> list[list[Circle3]]:
    """Circles of the ball's color near by and in the whole picture, for each radius that is looked for.

    A picture of few cells is read for every radius, one of many for one of them by turns.
    """
    limits, expected, whole = parameters.ball, search.expected, float(max(search.image.shape))
    near = limits.reach * expected.missed * expected.radius
    turn = belief.searched
    if not parameters.search.whole_frame:
        return [_places(belief, search, (expected.radius, near), turn, limits)]
    scales = (1.0,) if search.is_expected else limits.spread
    sizes = [expected.radius * scale for scale in scales]
    large = _cells(search.image, expected.radius, limits) > limits.places.cells
    found = list[list[Circle3]]()
    if large or search.is_expected:
        found.append(_places(belief, search, (expected.radius, near), turn, limits))
    if search.is_expected and large:
        turn, is_late = divmod(turn, 2)
        sizes = sizes if is_late else []
    elif sum(_cells(search.image, radius, limits) for radius in sizes) > limits.places.cells:
        turn, which = divmod(turn, len(sizes))
        sizes = [sizes[which]]
    return found + [_places(belief, search, (radius, whole), turn, limits) for radius in sizes]


def _cells(image: Image, radius: float, limits: BallSearchParameters) -> float:
    """How many cells a picture has where a ball of a radius, px, is looked for."""
    height, width = image.shape[:2]
    step = max(radius / limits.places.radius_cells, 1.0)
    return float(height * width / step**2)


def _places(
    belief: Belief, search: BallSearch, what: tuple[float, float], turn: int, limits: BallSearchParameters
) -> list[Circle3]:
    """Circles of the ball's color; `what`: of which radius, and how far from where it is expected, px."""
    radius, reach = what
    return places_of_color(
        search.image,
        (belief.lab, search.color),
        ((search.expected.x, search.expected.y, radius), reach),
        turn,
        [(x, y, 0.0) for x, y, _ in belief.in_vain],
        limits.places,
    )


def _carried(belief: Belief, search: BallSearch) -> list[Circle3]:
    """Where the ball of the reference is now if it stood still while the camera turned."""
    if belief.reference is None or search.changes is None:
        return []
    circle = search.changes.reference.circle
    return [circle] if math.dist(circle[:2], belief.reference.circle[:2]) > circle[2] else []


def _merit(rank: int, circle: Circle3, search: BallSearch, limits: BallSearchParameters) -> float:
    """Merit of a circle that is looked at: the prior of place and size, less a little for each that is better.

    While it is not known where the ball is, every size is as likely.
    """
    expected = search.expected
    other = abs(math.log(circle[2] / expected.radius)) > math.log(limits.places.other_size)
    size = log_prior_of_size(circle[2], expected, limits.size) if other and search.is_expected else 0.0
    return log_prior_of_place(circle[:2], expected, limits.place) + size - limits.rank * rank
