"""How far the two fields of a camera's interlaced pictures lie apart in time, from all targets: `FieldTiming`."""

import msgspec

from matchset.tracking.many.sightings import Sighting


class FieldTimingParameters(msgspec.Struct, frozen=True, kw_only=True):
    """From which sightings the time between two fields is learned.

    Chosen on rendered crowds, seeds 7 to 12 (docs/log/tracking.md#association); `python -m benchmarks.crowds` would
    show a change.

    Parameters
    ----------
    least_way_px, most_way : float
        Way from one frame to the next, at least px and at most half-widths: of what is faster, a fit that does not know
        yet sees one field only.
    support : float
        Least support of both sightings.
    memory : float
        Share of what is known that each sighting leaves.
    """

    least_way_px: float = 2.0
    most_way: float = 0.5
    support: float = 0.8
    memory: float = 0.99


class FieldTiming:
    """Time between the even rows and the odd ones of one camera, which all of its trackers share.

    Parameters
    ----------
    limits : FieldTimingParameters

    Attributes
    ----------
    moments : (float, float)
        Sums of offset times velocity, and of squared velocity, as `TrackStep.fields` has them.
    """

    def __init__(self, limits: FieldTimingParameters) -> None:
        self._limits = limits
        self.moments = 0.0, 0.0

    def note(self, last: Sighting, sighting: Sighting) -> None:
        """Learn from two sightings of a target, in consecutive frames."""
        limits, passed = self._limits, sighting.track.time - last.track.time
        x, y = sighting.place.x - last.place.x, sighting.place.y - last.place.y
        way = x * x + y * y
        if not (limits.least_way_px**2 < way < (limits.most_way * sighting.place.half_width) ** 2 and passed > 0.0):
            return
        if min(last.track.support, sighting.track.support) < limits.support:
            return
        u, v = sighting.track.field_offset
        apart, speed = self.moments
        memory = limits.memory
        self.moments = memory * apart + (u * x + v * y) / passed, memory * speed + way / passed**2
