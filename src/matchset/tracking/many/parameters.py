"""How several targets are followed: `MultiTrackerParameters`."""

import math

import msgspec

from matchset.tracking.constants import TrackerConstants
from matchset.tracking.many.field_timing import FieldTimingParameters
from matchset.tracking.many.linking import LinkingParameters
from matchset.tracking.many.motion_bank import ManyMotionParameters
from matchset.tracking.many.searching.disc_search import DiscSearchParameters
from matchset.tracking.many.searching.strip_search import StripSearchParameters
from matchset.tracking.many.sightings import MergeParameters
from matchset.tracking.many.smoothing.smoother import BothWaysParameters
from matchset.tracking.outlines.hypotheses import HypothesisParameters
from matchset.tracking.parameters import TrackerParameters

ONE_OF_SEVERAL = TrackerParameters(
    whole_frame=False,
    looks=4,
    constants=TrackerConstants(hypotheses=HypothesisParameters(directions=4)),
)


class MultiTrackerParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How several targets are followed.

    All chosen on rendered crowds, seeds 7 to 12 (docs/log/tracking.md#association); `python -m benchmarks.crowds` would
    show a change.

    Parameters
    ----------
    memory : float
        How long a target that is not seen keeps its identity, s.
    confirm : int
        Sightings from which something new has an identity.
    expected : float
        How long a target that is not seen is tracked from where its motion would have it, s; later only searches can
        find it.
    period : int
        Of so many frames in which all targets are seen, in one a strip is searched for new ones and the filters are
        corrected: less finds new ones sooner, more costs less.
    crowded : float
        Distance of a target from others, in half-widths of the larger, from which the network of discs is asked.
    probes : int
        How many hidden targets are looked for in a frame, those first that were not for longest.
    restarts : int
        Frames in which a new tracklet's tracker begins where the filters expect it: its own velocity is not known yet.
    requested : float
        How long what `MultiTracker.add` named is looked for, s.
    searched : float
        After how long the whole picture is searched for a target that is not seen, s, where nothing else is searched
        for. Less finds it sooner where it enters again, and takes another one like it, which nobody named, for it.
    unconfirmed : float
        How long what has no identity yet is remembered once it is not seen, s.
    min_visible : float
        Share of its half-width that a target must reach out from behind a nearer one to be looked for.
    halted_period, halted_after : int, float
        Of so many frames in which a hidden target is looked for, one begins where it was seen last, once that is longer
        ago, s: what was caught stays there.
    points : int
        Lines across each outline, see `Tracker`.
    fields : FieldTimingParameters
    motion : ManyMotionParameters
    linking : LinkingParameters
    merge : MergeParameters
    search : StripSearchParameters
    discs : DiscSearchParameters
        How balls are searched for whose color was clicked.
    smoothing : BothWaysParameters
    tracker : TrackerParameters
        Of each target's tracker; it must not search the whole frame.
    """

    memory: float = 2.0
    confirm: int = 2
    expected: float = 0.6
    period: int = 3
    crowded: float = 4.0
    probes: int = 4
    restarts: int = 3
    requested: float = 0.5
    searched: float = math.inf
    unconfirmed: float = 0.1
    min_visible: float = 0.3
    halted_period: int = 3
    halted_after: float = 0.15
    points: int = 64
    fields: FieldTimingParameters = FieldTimingParameters()
    motion: ManyMotionParameters = ManyMotionParameters()
    linking: LinkingParameters = LinkingParameters()
    merge: MergeParameters = MergeParameters()
    search: StripSearchParameters = StripSearchParameters()
    discs: DiscSearchParameters = DiscSearchParameters()
    smoothing: BothWaysParameters = BothWaysParameters()
    tracker: TrackerParameters = ONE_OF_SEVERAL
