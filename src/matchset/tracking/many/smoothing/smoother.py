"""The best joint explanation of a whole video, read forward and backward: `Smoother`."""

from collections.abc import Callable, Sequence

import msgspec

from matchset.image.frame import Frame
from matchset.tracking.many.linking import LinkingParameters
from matchset.tracking.many.motion_bank import ManyMotionParameters
from matchset.tracking.many.smoothing.answers import FrameMoment, TargetsAt, answers
from matchset.tracking.many.smoothing.chaining import Chaining, ChainingParameters
from matchset.tracking.many.smoothing.joining import JoiningParameters, segments
from matchset.tracking.many.smoothing.motion_odds import MotionOdds, MotionOddsParameters
from matchset.tracking.many.smoothing.sweep import Click, Sweep


class BothWaysParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How both readings of a video are explained together.

    Parameters
    ----------
    joining : JoiningParameters
    odds : MotionOddsParameters
    chaining : ChainingParameters
    """

    joining: JoiningParameters = JoiningParameters()
    odds: MotionOddsParameters = MotionOddsParameters()
    chaining: ChainingParameters = ChainingParameters()


class Known(msgspec.Struct, frozen=True):
    """What the tracker itself goes by.

    Parameters
    ----------
    memory : float
        How long a target that is not seen keeps its identity, s.
    motion : ManyMotionParameters
    linking : LinkingParameters
    """

    memory: float
    motion: ManyMotionParameters
    linking: LinkingParameters


class Smoother:
    """Explains a video as a whole: first all of its frames by `forward`, then all of them in reverse by `backward`.

    Where both readings agree who is followed nothing is decided anew. Where one of them lost a target, or took it for
    another one, the parts are linked by how targets move at both ends, as it is likeliest for all of them together.

    Parameters
    ----------
    sweep : callable
        Makes one reading: of clicks, and whether it is backward.
    clicks : sequence of Click
    seeks : bool
        Whether a reading finds nothing by itself; then the backward one begins with what the forward one saw last.
    known : Known
    limits : BothWaysParameters
    """

    def __init__(
        self,
        sweep: Callable[[Sequence[Click], bool], Sweep],
        clicks: Sequence[Click],
        seeks: bool,
        known: Known,
        limits: BothWaysParameters,
    ) -> None:
        self._sweep, self._clicks, self._seeks, self._known, self._limits = sweep, list(clicks), seeks, known, limits
        self._ahead = sweep(self._clicks, False)
        self._back: Sweep | None = None
        self._moments: list[FrameMoment] = []

    def forward(self, frame: Frame) -> None:
        """Take the next frame; errors as of `MultiTracker.update` and `MultiTracker.add`."""
        self._ahead.update(frame)
        self._moments.append(FrameMoment(frame.index, frame.time))

    def backward(self, frame: Frame) -> None:
        """Take the frame before the last one that this took, at first the last one of all."""
        if self._back is None:
            last = self._ahead.last_seen([each.number for each in self._moments]) if self._seeks else []
            self._back = self._sweep([*self._clicks, *last], True)
        self._back.update(frame)

    def answers(self) -> list[TargetsAt]:
        """Return what is where in every frame; where `backward` has not come to, by the forward reading alone."""
        ahead = self._ahead.sightings()
        back = [] if self._back is None else self._back.sightings()
        back = [[] for _ in range(len(ahead) - len(back))] + back
        times, limits, known = [each.time for each in self._moments], self._limits, self._known
        odds = MotionOdds(times, limits.odds, known.motion, known.linking)
        chaining = Chaining(times, known.memory, limits.chaining, odds)
        chains = chaining.chains(segments(ahead, back, limits.joining), limits.odds.before)
        return answers(self._moments, chains, self._ahead.identities)
