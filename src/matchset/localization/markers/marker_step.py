"""The compiled step of a marker tracker: learn how the colors differ, place every marker, describe it; one call."""

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from matchset.localization.markers.marker_color import fisher_axis, sum_colors, update_means
from matchset.localization.markers.marker_fit import fit_marker
from matchset.localization.markers.marker_shape import describe_marker
from matchset.localization.markers.marker_workspace import MARKERS
from matchset.numeric.jit import kernel
from matchset.numeric.record import Block

Floats = npt.NDArray[np.float64]
Bytes = npt.NDArray[np.uint8]


@kernel(refcount=False)
def _is_separate(x: float, y: float, work: Any, count: int) -> bool:
    """Whether none of the first markers is nearer than a marker's radius; all in ball radii."""
    separate = True
    for k in range(count):
        far = math.sqrt((x - work.offsets[k, 0]) ** 2 + (y - work.offsets[k, 1]) ** 2)
        separate = separate and far > work.patch_radius
    return separate


@kernel(refcount=False)
def _in_picture(x: float, y: float, width: int, height: int) -> bool:
    """Whether a marker's center, px, is in the picture; of one beyond its border less than half is seen."""
    return -0.5 <= x < width - 0.5 and -0.5 <= y < height - 0.5


@kernel
def _place_markers(image: Bytes, work: Any) -> int:
    """Fit every marker and describe those that are found, first; returns how many."""
    ball, limits, missed = work.ball, work.limits, 0
    kept: Any = np.int64(0)  # a plain 0 would be a type of its own: kernels that take it would compile twice
    others = np.empty((work.count, 3))
    for k in range(work.count):
        x, y = work.places[k, 0], work.places[k, 1]
        fit_marker(image, work, k)
        dx, dy = (work.places[k, 0] - ball.x) / ball.radius, (work.places[k, 1] - ball.y) / ball.radius
        far = math.sqrt(dx**2 + dy**2)
        good = work.result.contrast >= limits.min_contrast and work.result.explained >= limits.min_explained
        good = good and _in_picture(work.places[k, 0], work.places[k, 1], image.shape[1], image.shape[0])
        if good and far < limits.max_offset * work.rim_distance and _is_separate(dx, dy, work, kept):
            describe_marker(work, k, kept)
            work.offsets[kept, 0], work.offsets[kept, 1], work.order[kept] = dx, dy, k
            kept += 1
        else:
            work.places[k, 0], work.places[k, 1] = x, y
            others[missed, 0], others[missed, 1], others[missed, 2] = k, work.offsets[k, 0], work.offsets[k, 1]
            missed += 1
    for k in range(missed):
        work.order[kept + k] = int(others[k, 0])
        work.offsets[kept + k, 0], work.offsets[kept + k, 1] = others[k, 1], others[k, 2]
    return int(kept)


@kernel
def follow_markers(image: Bytes, block: Block) -> int:
    """Place the markers of a ball anew.

    Parameters
    ----------
    image : (h, w, 3) or (h, w, 1) uint8
    block : record of `MarkerWork` as floats
        `ball`, `count`, `seen` and `offsets` are read. Written: the markers that are found, first and in their order,
        with the others after them, where they were; `order`, the former rows of all.

    Returns
    -------
    int
        How many were found.
    """
    work = block.view(MARKERS)[0]
    ball = work.ball
    for k in range(work.count):
        work.places[k, 0] = ball.x + ball.radius * work.offsets[k, 0]
        work.places[k, 1] = ball.y + ball.radius * work.offsets[k, 1]
    sums = np.empty(20)
    sum_colors(image, work, sums)
    if update_means(work, sums):
        fisher_axis(work)
    return _place_markers(image, work)
