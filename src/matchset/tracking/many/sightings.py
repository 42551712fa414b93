"""What is seen of all targets in a frame: `Sighting`; of two on one outline one remains (`merged`)."""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

from matchset.tracking.motion import Gate, gate_of
from matchset.tracking.track import Track


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
    owners : tuple of int
        Slots of the targets whose trackers ended here.
    """

    track: Track[Any]
    place: Gate
    variance: float
    label: str
    owners: tuple[int, ...]
    sure: bool = True


def sighting_of(track: Track[Any], sigmas: tuple[float, float], label: str, owners: tuple[int, ...] = ()) -> Sighting:
    """Make a sighting of a track.

    Parameters
    ----------
    track : Track
    sigmas : (float, float)
        Standard deviation of its center beside its own covariance: px, and in half-widths.
    label : str
    owners : tuple of int
    """
    place = gate_of(type(track.shape), track.shape.state)
    known = max(float(track.covariance[0, 0] + track.covariance[1, 1]) / 2.0, 0.0)
    sigma = sigmas[0] + sigmas[1] * place.half_width
    return Sighting(track, place, min(known, place.half_width**2) + sigma**2, label, owners)


def merged(sightings: Sequence[Sighting], distance: float, log_size: float) -> list[Sighting]:
    """Keep of sightings of one outline the one with most support, for all of their owners.

    Parameters
    ----------
    sightings : sequence of Sighting
    distance : float
        Centers nearer than this are one, in half-widths of the larger ...
    log_size : float
        ... if their sizes differ by less than this, as a logarithm.
    """
    kept: list[Sighting] = []
    for each in sorted(sightings, key=lambda sighting: -sighting.track.support):
        for k, other in enumerate(kept):
            larger = max(each.place.half_width, other.place.half_width)
            change = abs(math.log(each.place.half_width / other.place.half_width))
            if each.place.distance(other.place) < distance * larger and change < log_size:
                kept[k] = other._replace(owners=(*other.owners, *each.owners))
                break
        else:
            kept.append(each)
    return kept
