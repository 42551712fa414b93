"""The compiled step of a localizer: from an outline and markers to position, rotation and covariance, in one call."""

from typing import Annotated

import numpy as np
import numpy.typing as npt

from matchset.localization.attitude import AttitudeFit
from matchset.localization.cone import ConeFailure, ConeFit, fit_cone
from matchset.localization.marker_identification import RotationSource, estimate_rotation
from matchset.localization.pose import UNOBSERVED_VARIANCE
from matchset.numeric.jit import kernel
from matchset.numeric.record import Block, record_dtype

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]


class PoseWork:
    """Workspace of `estimate_pose`."""

    cone: ConeFit
    attitude: AttitudeFit
    covariance: Annotated[Floats, (6, 6), "f8"]  # of position (m) and rotation vector (rad), camera and ball exact


POSE = record_dtype(PoseWork)


@kernel
def estimate_pose(block: Block, points: Floats, ways: Ints, starts: Ints) -> tuple[int, int]:
    """Place a ball and estimate its rotation.

    Parameters
    ----------
    block : record of `PoseWork` as floats, written
    points : (n, 2)
        Points of the outline, px.
    ways, starts
        See `assignments`.

    Returns
    -------
    failure : int
        One of `ConeFailure`: without a position nothing else is written.
    observed : int
        One of `RotationSource`; for `NONE` the rotation is not written.
    """
    work = block.view(POSE)[0]
    cone, attitude, observed = work.cone, work.attitude, RotationSource.NONE.value
    failure = fit_cone(cone, points)
    if failure != ConeFailure.NONE.value:
        return failure, observed
    attitude.position[:] = cone.position
    attitude.position_covariance[:] = cone.covariance
    attitude.position_slope[:] = cone.camera_slope
    attitude.rotation_slope[:] = 0.0
    if attitude.pixel_count > 0:
        observed = estimate_rotation(attitude, ways, starts)
    known = observed != RotationSource.NONE.value
    for j in range(3):
        for k in range(3):
            work.covariance[j, k] = cone.covariance[j, k]
            unknown = UNOBSERVED_VARIANCE if j == k else 0.0
            work.covariance[3 + j, 3 + k] = attitude.rotation_covariance[j, k] if known else unknown
            tie = attitude.cross_covariance[j, k] if known else 0.0
            work.covariance[3 + j, k] = work.covariance[k, 3 + j] = tie
    return failure, observed
