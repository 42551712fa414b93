"""Which discs are the same ball, and their mean: `are_same`, `mean_disc`.

Where an outline is blurred, the network stops at different circles from different sides. All were read from the same
pixels, so their mean is better than each, but no surer.
"""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from matchset.image.disc_network.network import Disc

Floats = npt.NDArray[np.float64]


def are_same(discs: Sequence[Disc], disc: Disc, same: float) -> npt.NDArray[np.bool_]:
    """Which discs are the same ball as another one.

    Parameters
    ----------
    discs : sequence of Disc
        At least one.
    disc : Disc
    same : float
        Largest difference of x, y and radius in all, in its radii.

    Returns
    -------
    ndarray of shape (k,), bool
    """
    circles = np.array([each.circle for each in discs])
    return np.asarray(np.abs(circles - disc.circle).sum(axis=1) < same * disc.circle[2])


def mean_disc(discs: Sequence[Disc], merits: Floats, same: float) -> Disc:
    """Mean of the best disc and of those that are the same ball, by their precisions and merits.

    Parameters
    ----------
    discs : sequence of Disc
        At least one.
    merits : ndarray of shape (k,), float64
        Logarithm of how likely each is.
    same : float
        See `are_same`.

    Returns
    -------
    Disc
        With precision and log-odds of the best one.
    """
    best = discs[int(merits.argmax())]
    if len(discs) == 1:
        return best
    circles = np.array([disc.circle for disc in discs])
    weights = np.where(are_same(discs, best, same), np.exp(merits - merits.max()), 0.0)[:, np.newaxis, np.newaxis]
    precisions = weights * np.array([disc.precision for disc in discs])
    x, y, radius = np.linalg.solve(precisions.sum(axis=0), np.einsum("kij,kj->i", precisions, circles)).tolist()
    return best._replace(circle=(x, y, radius))
