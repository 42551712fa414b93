"""The first step of the search for a ball: from which circles the network is led, `propose`.

Where the ball is expected and was seen last, where a turning camera took it, what has arrived, and where its color
stands out, the likeliest first. Of a whole picture that is large in cells a part is read, the next part in the next
picture; in every other one circles of any size are voted for instead.
"""

import math
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from matchset.image.color import ColorModel
from matchset.image.disc_network.patch_format import Circle3
from matchset.tracking.ball.belief import Belief
from matchset.tracking.ball.changes import Arrival, PictureChanges
from matchset.tracking.ball.color_places import places_of_color
from matchset.tracking.ball.discs import are_same
from matchset.tracking.ball.log_odds import ExpectedPlace, log_prior_of_place, log_prior_of_size
from matchset.tracking.ball.parameters import BallSearchParameters
from matchset.tracking.detectors import Detectors
from matchset.tracking.parameters import TrackerParameters

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


def propose(
    belief: Belief, search: BallSearch, detectors: Detectors[Any], parameters: TrackerParameters
) -> tuple[list[Circle3], list[Circle3]]:
    """Propose circles from which the network is led, the likeliest first.

    Parameters
    ----------
    belief : Belief
    search : BallSearch
    detectors : Detectors
        Their searchers vote for circles of any size.
    parameters : TrackerParameters

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
        ranked.append((told + _merit(rank, circle, expected, limits), circle))
    colored = _colored(belief, search, detectors, parameters)
    ranked += [(_merit(rank, circle, expected, limits), circle) for rank, circle in enumerate(colored)]
    starts = list[Circle3]()
    for _, circle in sorted(ranked, key=lambda each: -each[0]):
        if not any(are_same(circle, each, limits.same) for each in starts):
            starts.append(circle)
    starts = starts[: limits.starts]
    return starts, [circle for circle in dict.fromkeys(colored) if circle in starts]


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


def _colored(
    belief: Belief, search: BallSearch, detectors: Detectors[Any], parameters: TrackerParameters
) -> list[Circle3]:
    """Circles of the ball's color near by, and in the whole picture: at once if it is small in cells, or by turns."""
    limits, expected, image = parameters.ball, search.expected, search.image
    whole_frame = parameters.search.whole_frame
    turn, by_color = divmod(belief.searched, 2)
    near = expected.radius, limits.reach * expected.missed * expected.radius
    beside = search.is_expected or not whole_frame or not by_color
    found = _places(belief, search, near, limits) if beside else []
    if not whole_frame:
        return found
    if not (search.is_expected or by_color):
        votes = detectors.suited(image, expected.radius).searcher.candidates(image, search.color)
        return [*found, *((x, y, radius) for x, y, radius, _ in votes[: limits.places.most].tolist())]
    cells = image.shape[0] * image.shape[1] / max(expected.radius / limits.places.radius_cells, 1.0) ** 2
    if search.is_expected and cells > limits.places.cells and not by_color:
        return found
    scale = 1.0 if search.is_expected else limits.spread[turn % len(limits.spread)]
    return [*found, *_places(belief, search, (scale * expected.radius, float(max(image.shape))), limits)]


def _places(
    belief: Belief, search: BallSearch, what: tuple[float, float], limits: BallSearchParameters
) -> list[Circle3]:
    """Circles of the ball's color; `what`: of which radius, and how far from where it is expected, px."""
    radius, reach = what
    return places_of_color(
        search.image,
        (belief.lab, search.color),
        ((search.expected.x, search.expected.y, radius), reach),
        belief.searched // 2,
        [each[:2] for each in belief.in_vain],
        limits.places,
    )


def _carried(belief: Belief, search: BallSearch) -> list[Circle3]:
    """Where the ball of the reference is now if it stood still while the camera turned."""
    if belief.reference is None or search.changes is None:
        return []
    circle = search.changes.reference.circle
    return [circle] if math.dist(circle[:2], belief.reference.circle[:2]) > circle[2] else []


def _merit(rank: int, circle: Circle3, expected: ExpectedPlace, limits: BallSearchParameters) -> float:
    """Merit of a circle that is looked at: the prior of place and size, less a little for each that is better."""
    other = abs(math.log(circle[2] / expected.radius)) > math.log(limits.places.other_size)
    size = log_prior_of_size(circle[2], expected, limits.size) if other else 0.0
    return log_prior_of_place(circle[:2], expected, limits.place) + size - limits.rank * rank
