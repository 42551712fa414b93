"""Which of several outlines is the target's, by what was seen before: the forward pass of Viterbi's algorithm.

One frame often cannot tell the outline of a half-hidden ball from that of the part which is seen. Several can: what
hides it changes, while the ball hardly changes its size and moves as one. So every outline that edge points ask for
(`Consensus`) is remembered with its log-odds,

    L(k) = score + max over j of (memory L(j) - penalty(j -> k)),

and the likeliest is taken (Viterbi, 1967). The penalty is the squared change of the logarithm of the size and of the
place beside what the motion expects, in standard deviations, and bounded, since a target may turn up from behind. Each
score is less by how unlikely its size is beside the size remembered, bounded too: the outlines of a few frames may
drift with what hides them, while a rigid ball grows and shrinks slowly.
"""

import math

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.fitting.consensus import Proposals

Floats = npt.NDArray[np.float64]
Ahead = tuple[Floats, tuple[float, float] | None]

MIN_HALF_WIDTH = 1.0  # geometry: of an outline, px


class HypothesisFilterParameters(msgspec.Struct, frozen=True):
    """How outlines are weighed against those of the frames before.

    Chosen on real clips, three starts of three clicks each: `score_weight` 20 to 80, `size_sigma` 0.01 to 0.03 and
    `place_sigma` 0.03 to 0.15 are as good (docs/log.md). `python -m benchmarks --only real` would show a change.

    Parameters
    ----------
    score_weight : float
        Log-odds of an outline that all lines agree with and no color contradicts. More believes this frame, less those
        before it.
    preference : float
        Log-odds in favor of the fit that is there already, and against it where that was rejected.
    memory : float
        Share of the log-odds of the last frame that is kept.
    size_sigma, place_sigma : float
        Standard deviations of the change of ln(size) and of the place beside its prediction, in half-widths, per frame.
    most : float
        Largest penalty.
    usual_sigma, most_unusual : float
        Standard deviation of ln(size) beside the size remembered, grown with the root of the frames missed, and the
        largest penalty for it. 0.05 to 0.1 are as good; a penalty of 8 holds on to wrong sizes (docs/log.md).
    remembered_s : float
        For how long outlines are remembered, s.
    temperature : float
        By how much the log-odds of two outlines differ whose probabilities in the covariance differ by a factor of e.
        Edge points of a line are no independent witnesses, so log-odds say too much. More tells a larger covariance.
        Chosen on real clips: of 1, 3 and 8, normalized errors squared are honest from 3 on (docs/log.md).
    least_score : float
        Score below which an outline does not save a fit that was rejected.
    range_share, min_range_px, sigma_share : float
        Search range of the fit that begins at the outline, in half-widths and at least px; and how far edge points are
        expected, as a share of that: less keeps to the outline, more to what lies around it.
    """

    score_weight: float = 40.0
    preference: float = 1.0
    memory: float = 0.95
    size_sigma: float = 0.015
    place_sigma: float = 0.1
    most: float = 8.0
    usual_sigma: float = 0.07
    most_unusual: float = 4.0
    remembered_s: float = 1.0
    temperature: float = 4.0
    least_score: float = 0.2
    range_share: float = 0.03
    min_range_px: float = 1.5
    sigma_share: float = 0.4


class HypothesisFilter:
    """Remembers outlines with their log-odds from frame to frame.

    Parameters
    ----------
    limits : HypothesisFilterParameters

    Attributes
    ----------
    time : float
        Of the frame whose outlines are remembered, s.
    """

    def __init__(self, limits: HypothesisFilterParameters) -> None:
        self.limits = limits
        self.forget()

    def forget(self) -> None:
        """Remember nothing."""
        self.time = -math.inf
        self._places, self._sizes, self._log_odds = np.zeros((0, 2)), np.zeros(0), np.zeros(0)

    def begin(self, place: Floats, half_width: float, time: float) -> None:
        """Remember one outline alone, of a time, s, at which there was no doubt."""
        self._places, self._sizes, self._log_odds = (
            place[np.newaxis].copy(),
            np.array([max(half_width, MIN_HALF_WIDTH)]),
            np.zeros(1),
        )
        self.time = time

    def choose(
        self, proposals: Proposals, places: Floats, ahead: Ahead, frame: tuple[float, float], preferred: bool
    ) -> int:
        """Say which outline is likeliest, and remember all.

        Parameters
        ----------
        proposals : Proposals
        places : ndarray of shape (k, 2), float64
            Their centers, px.
        ahead : tuple of (ndarray of shape (2,), float64) and (tuple of two floats, or None)
            By how much the target is expected to have moved since its last sighting, px; and its usual size, see
            `usual_size`, None where that is not known.
        frame : tuple of float
            Time of the frame and since the frame before, s.
        preferred : bool
            Whether the first outline is preferred, or the others are.
        """
        limits, (time, interval), (expected, usual) = self.limits, frame, ahead
        log_odds, sizes = limits.score_weight * proposals.scores, np.maximum(proposals.half_widths, MIN_HALF_WIDTH)
        log_odds[0] += limits.preference if preferred else -limits.preference
        if usual:
            unusual = (np.log(sizes) - usual[0]) / (limits.usual_sigma * math.sqrt(usual[1]))
            log_odds -= np.minimum(0.5 * unusual**2, limits.most_unusual)
        if len(self._sizes) and time - self.time < limits.remembered_s:
            apart = math.sqrt(max((time - self.time) / interval, 1.0))
            growth = np.log(sizes[:, np.newaxis] / self._sizes) / (limits.size_sigma * apart)
            moved = (places[:, np.newaxis] - self._places - expected) / (limits.place_sigma * apart * sizes[0])
            penalty = np.minimum(0.5 * (growth**2 + (moved**2).sum(axis=2)), limits.most)
            log_odds = log_odds + (limits.memory * self._log_odds - penalty).max(axis=1)
        self._places, self._sizes, self._log_odds = places, sizes, log_odds - log_odds.max()
        self.time = time
        return int(np.argmax(log_odds))

    def spread(self, steps: Floats, which: int) -> Floats:
        """Covariance of the outlines beside the one that was chosen, by their probabilities.

        Parameters
        ----------
        steps : ndarray of shape (k, p), float64
            Of the outlines that `choose` weighed last.
        which : int
            The one that was chosen.
        """
        weights = np.exp(self._log_odds / self.limits.temperature)
        weights /= weights.sum()
        apart = steps - steps[which]
        return np.asarray((weights[:, np.newaxis] * apart).T @ apart)
