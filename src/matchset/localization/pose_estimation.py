"""The compiled step of a localizer: from an outline and markers to a place, a rotation and a covariance; one call."""

import numpy as np
import numpy.typing as npt

from matchset.localization.cone import DONE, fit_cone
from matchset.localization.marker_identification import NOTHING, observe_turn
from matchset.localization.pose import UNSEEN
from matchset.numeric.jit import kernel

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

# places in `numbers`: a point well inside the outline, see `fit_cone`; what `BallParameters` and the ball say; what
# `observe_turn` is told, and last 1 where a rotation is known
X, Y, ROBUST, SHIFT, INFLATION, FLOOR, RADIUS, REACH, LOOSE, TILT, LEAD, MISFIT, KNOWN, NUMBERS = range(14)
# places in `out`: position (3), covariance (6, 6), rotation (3, 3)
COVARIANCE, TURN, OUT = 3, 39, 48


@kernel
def sight(
    intrinsics: Floats,
    camera_spread: Floats,
    points: Floats,
    spread: Floats,
    markers: Floats,
    choices: Ints,
    starts: Ints,
    bodies: Floats,
    last: Floats,
    numbers: Floats,
    out: Floats,
) -> tuple[int, int]:
    """Place a ball and turn it.

    Parameters
    ----------
    intrinsics, camera_spread, points, spread
        See `fit_cone`.
    markers : (n, 6)
        Middles of the markers' rims, px, and the four numbers of their covariances.
    choices, starts, bodies, last
        See `observe_turn`.
    numbers : (NUMBERS,)
        See the names of their places above.
    out : (OUT,), written
        The same; the rotation only where it is seen.

    Returns
    -------
    miss : int
        See `fit_cone`.
    kind : int
        See `observe_turn`.
    """
    n, position, covariance, own = numbers, out[:COVARIANCE], out[COVARIANCE:TURN].reshape(6, 6), np.empty((3, 3))
    miss, _, _ = fit_cone(
        intrinsics,
        camera_spread,
        points,
        n[X],
        n[Y],
        n[SHIFT],
        n[ROBUST] > 0.0,
        spread,
        n[INFLATION],
        n[FLOOR],
        n[RADIUS],
        position,
        own,
    )
    if miss != DONE:
        return miss, NOTHING
    covariance[:] = 0.0
    for j in range(3):
        for k in range(3):
            covariance[j, k] = own[j, k]
    kind, count = NOTHING, markers.shape[0]
    if count > 0:
        pixels, spreads = np.empty((count, 2)), np.empty((count, 2, 2))
        for i in range(count):
            pixels[i, 0], pixels[i, 1] = markers[i, 0], markers[i, 1]
            spreads[i, 0, 0], spreads[i, 0, 1] = markers[i, 2], markers[i, 3]
            spreads[i, 1, 0], spreads[i, 1, 1] = markers[i, 4], markers[i, 5]
        kind = observe_turn(
            intrinsics,
            pixels,
            spreads,
            choices,
            starts,
            bodies,
            position,
            n[REACH],
            n[LOOSE],
            n[TILT],
            n[LEAD],
            n[MISFIT],
            last,
            n[KNOWN] > 0.0,
            out[TURN:OUT].reshape(3, 3),
            covariance,
        )
    if kind == NOTHING:
        covariance[3:, :] = 0.0
        covariance[:, 3:] = 0.0
        covariance[3, 3] = covariance[4, 4] = covariance[5, 5] = UNSEEN
    return miss, kind
