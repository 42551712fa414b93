"""Who is where: joint association of all targets with all sightings (`associate`)."""

import math
from collections.abc import Sequence

import msgspec
import numpy as np
import numpy.typing as npt
from scipy.optimize import linear_sum_assignment

from matchset.tracking.many.motion_bank import ManyMotionParameters, Predicted
from matchset.tracking.many.sightings import Sighting

Floats = npt.NDArray[np.float64]
FORBIDDEN = 1e6  # format: cost of what the gates exclude, which SciPy's solver takes for a number


class AssociationParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How targets and sightings are associated; all are log-likelihoods or log-odds.

    All chosen on rendered crowds, seeds 7 and 8 (docs/log/many.md); `python -m benchmarks.crowds` would show a change.

    Parameters
    ----------
    own : float
        Log-odds that what a target's own tracker follows from the frame before is the target.
    own_support : float
        Support from which that counts.
    gate : float
        Squared distance of center, and of size, in standard deviations, of a sighting that may be a target.
    unseen : float
        Log-odds against a target that is not seen, with a density of one per square of `density_px` px.
    density_px : float
        See there.
    """

    own: float = 12.0
    own_support: float = 0.6
    gate: float = 25.0
    unseen: float = 12.5
    density_px: float = 60.0


def distances(
    predicted: Predicted, slots: Sequence[int], sightings: Sequence[Sighting], limits: ManyMotionParameters
) -> tuple[Floats, Floats]:
    """Squared distance and negative log-likelihood of every sighting as every target.

    Returns
    -------
    squared : ndarray of shape (targets, sightings), float64
        Of center and size by the nearer model, the larger of the two, in standard deviations.
    cost : ndarray of shape (targets, sightings), float64
        By all models of motion, weighed by their probability.
    """
    places = np.array([each.place for each in sightings]).reshape(-1, 3)
    variances = np.array([each.variance for each in sightings])
    rows = list(slots)
    total = predicted.variances[rows][:, None, :] + variances[None, :, None]
    apart = places[None, :, None, :2] - predicted.centers[rows][:, None]
    squared = (apart**2).sum(axis=3) / total
    change = np.log(places[None, :, 2] / predicted.half_widths[rows][:, None])
    size = change**2 / predicted.size_variances[rows][:, None]
    terms = predicted.log_weights[rows][:, None] - 0.5 * squared - np.log(total)
    most = terms.max(axis=2)
    likelihood = most + np.log(np.exp(terms - most[:, :, None]).sum(axis=2))
    cost = -likelihood + 0.5 * size + 0.5 * np.log(predicted.size_variances[rows])[:, None]
    return np.maximum(squared.min(axis=2), size), cost


def associate(squared: Floats, cost: Floats, own: npt.NDArray[np.bool_], limits: AssociationParameters) -> list[int]:
    """Likeliest sighting of every target, none twice; -1 for a target that is not seen.

    Parameters
    ----------
    squared, cost : ndarray of shape (targets, sightings), float64
        See `distances`.
    own : ndarray of shape (targets, sightings), bool
        Where the target's own tracker has followed it to the sighting.
    limits : AssociationParameters
    """
    targets, sightings = cost.shape
    near = squared < limits.gate
    allowed = np.where(near, cost, FORBIDDEN)
    capped = cost - 0.5 * np.maximum(squared - limits.gate, 0.0) - limits.own
    allowed = np.where(own, capped, allowed)
    unseen = 2.0 * math.log(limits.density_px) + limits.unseen
    whole = np.concatenate((allowed, np.full((targets, targets), unseen)), axis=1)
    rows, columns = linear_sum_assignment(whole)
    chosen = np.full(targets, -1)
    chosen[rows] = np.where((columns < sightings) & (whole[rows, columns] < FORBIDDEN), columns, -1)
    return [int(each) for each in chosen]
