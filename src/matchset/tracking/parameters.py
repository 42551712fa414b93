"""How a shape is followed: `TrackerParameters`."""

import msgspec

from matchset.tracking.match_set import MatchParameters
from matchset.tracking.verdict import ValidationParameters
from matchset.tracking.voting import SearchParameters


class TrackerParameters(msgspec.Struct, frozen=True):
    """How a shape is followed.

    Parameters
    ----------
    least_reach, most_reach : float
        Shortest and longest look-out on each side of the predicted outline, px; it grows with the surprises of the
        motion.
    trust : float
        How far a shape may be from its prediction, in recent surprises: less is steadier where edges are few, more
        follows sudden motion sooner.
    coast : float
        How long a shape that is not seen is expected near its prediction, s; after that it may appear anywhere.
    jump : float
        How far from its prediction a shape may be found again while coasting, in half-widths per missed frame.
    growth : float
        Largest change of size per missed frame, as a factor.
    adapt_rate : float
        Speed at which the color follows the light, log-odds per look: 0 keeps the color as it was learned.
    adapt_support, adapt_inside : float
        Least share of the outline that must be confirmed, and of the inside that must look like the target, before a
        frame may teach the color.
    match : MatchParameters
        What makes an edge point and a fit.
    validation : ValidationParameters
        What confirms a shape.
    search : SearchParameters
        How the whole frame is searched.
    """

    least_reach: float = 3.0
    most_reach: float = 24.0
    trust: float = 0.5
    coast: float = 0.35
    jump: float = 2.0
    growth: float = 1.5
    adapt_rate: float = 0.8
    adapt_support: float = 0.8
    adapt_inside: float = 0.6
    match: MatchParameters = MatchParameters()
    validation: ValidationParameters = ValidationParameters()
    search: SearchParameters = SearchParameters()


# places of the numbers in `Views.track`
_PLACES = {name: place for place, name in enumerate(TrackerParameters.__struct_fields__)}
LEAST_REACH, MOST_REACH, TRUST = _PLACES["least_reach"], _PLACES["most_reach"], _PLACES["trust"]
ADAPT_RATE, ADAPT_SUPPORT, ADAPT_INSIDE = (_PLACES[name] for name in ("adapt_rate", "adapt_support", "adapt_inside"))
