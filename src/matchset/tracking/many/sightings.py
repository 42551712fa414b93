"""An outline in a frame: `Sighting`; and the two fields of an interlaced picture, in which one target has two."""

from collections.abc import Iterable
from typing import Any, NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image.color import ColorModel
from matchset.shapes.circle import Circle
from matchset.tracking.motion import Gate, gate_of
from matchset.tracking.track import Track
from matchset.tracking.tracker import Tracker

Image = npt.NDArray[np.uint8]

LEAST = 0.1  # format: support by which a sighting is weighed at least


class MergeParameters(msgspec.Struct, frozen=True, kw_only=True):
    """When two sightings are of one target.

    All chosen on rendered crowds, seeds 7 to 12 (docs/log/tracking.md#association); `python -m benchmarks.crowds` would
    show a change.

    Parameters
    ----------
    distance, log_size : float
        Trackers whose outlines are nearer than this, in half-widths of the larger, and whose sizes differ by less, as a
        logarithm, follow the same target. More gives up targets that are nearly hidden sooner.
    fresh_distance, fresh_log_size : float
        The same of what a search found, or the tracker of a hidden target: these must differ from all that is followed.
    mixed_log_size : float
        Change of size from which an outline that touches another one is that of both.
    field_near, field_distance, field_log_size : float
        Distances between which, and sizes up to which, two may be the fields of an interlaced picture ...
    field_parity : float
        ... if, where they do not overlap, the target's color prevails in the rows of one field by more, as a share.
    """

    distance: float = 0.3
    log_size: float = 0.2
    fresh_distance: float = 0.6
    fresh_log_size: float = 0.35
    mixed_log_size: float = 0.13
    field_near: float = 0.15
    field_distance: float = 1.5
    field_log_size: float = 0.1
    field_parity: float = 0.5


class Sighting(NamedTuple):
    """An outline in a frame.

    Attributes
    ----------
    track : Track
    place : Gate
        Center and half-width, px.
    variance : float
        Of each coordinate of the center, px^2.
    label : str
        Of the color by which it was seen.
    sure : bool
        Whether it was found where nothing was expected, with the evidence that this takes.
    tracker : Tracker or None
        Which has seen it; None for a search.
    identity : int or None
        That of the new target which it is, where somebody said that it shall be followed.
    """

    track: Track[Any]
    place: Gate
    variance: float
    label: str
    sure: bool = True
    tracker: Tracker[Any] | None = None
    identity: int | None = None


def sighting_of(track: Track[Any], sigmas: tuple[float, float], label: str) -> Sighting:
    """Make a sighting of a track.

    Parameters
    ----------
    track : Track
    sigmas : (float, float)
        Standard deviation of its center beside its own covariance: px, and in half-widths.
    label : str
    """
    place = place_of(track.shape)
    known = max((track.covariance.item(0, 0) + track.covariance.item(1, 1)) / 2.0, 0.0)
    sigma = (sigmas[0] + sigmas[1] * place.half_width) / max(track.support, LEAST)
    return Sighting(track, place, min(known, place.half_width**2) + sigma**2, label)


def place_of(shape: Any) -> Gate:
    """Return center and half-width of a shape, px; of a circle without an array, in a fifth of the time."""
    return Gate(shape.x, shape.y, shape.radius) if type(shape) is Circle else gate_of(type(shape), shape.state)


def is_near_one(place: Gate, others: Iterable[Gate], distance: float) -> bool:
    """Whether a place is nearer to one of others than so many half-widths of the larger: the same, or inside."""
    return any(place.distance(other) < distance * max(place.half_width, other.half_width) for other in others)


def are_fields(image: Image, color: ColorModel, places: tuple[Gate, Gate], limits: MergeParameters) -> bool:
    """Whether each of two discs is there in the even rows alone, or in the odd ones, where the other is not.

    Parameters
    ----------
    image : ndarray of shape (h, w, channels), uint8
    color : ColorModel
    places : (Gate, Gate)
    limits : MergeParameters
    """
    reach = max(each.half_width for each in places)
    left, right = (
        max(round(choose(each.x for each in places) + by), 0) for choose, by in ((min, -reach), (max, reach))
    )
    top, bottom = (
        max(round(choose(each.y for each in places) + by), 0) for choose, by in ((min, -reach), (max, reach))
    )
    part = np.ascontiguousarray(image[top : bottom + 1, left : right + 1])
    if not part.size:
        return False
    rows, columns = np.indices(part.shape[:2])
    colored = color.scores(part).reshape(part.shape[:2]) > 0
    inside = [np.hypot(columns + left - each.x, rows + top - each.y) < each.half_width for each in places]
    shares = []
    for own, other in (inside, inside[::-1]):
        alone = own & ~other
        even, odd = (colored[alone & ((rows + top) % 2 == parity)] for parity in (0, 1))
        if not (even.size and odd.size):
            return False
        shown, hidden = float(even.mean()), float(odd.mean())
        shares.append((shown - hidden) / max(shown + hidden, LEAST))
    return shares[0] * shares[1] < 0.0 and min(map(abs, shares)) > limits.field_parity


def of_both(one: Sighting, other: Sighting) -> Sighting:
    """Make one sighting, midway, of two that have seen a field each."""
    state = one.track.shape.state.copy()
    state[:2] = 0.5 * (one.place.x + other.place.x), 0.5 * (one.place.y + other.place.y)
    shape = type(one.track.shape).from_state(state, one.track.shape)
    points = np.concatenate((one.track.match_set, other.track.match_set))
    track = msgspec.structs.replace(one.track, shape=shape, match_set=points)
    return one._replace(track=track, place=gate_of(type(shape), state))
