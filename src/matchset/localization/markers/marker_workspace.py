"""Parameters of the marker tracker, and the workspace of its kernels: `MarkerParameters`, `MarkerWork`."""

from typing import Annotated

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.numeric.record import record_dtype

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

CAPACITY = 48  # format: markers that are followed or expected at once, rows of the workspace
RIM_POINTS = 16  # format: points of a marker's match-set


class MarkerFitParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How one marker is placed (`marker_fit.py`, `marker_patch.py`).

    Where nothing else is said they were chosen by hand; `python -m benchmarks --only localization_markers` would show a
    change.

    Parameters
    ----------
    softness_px : float
        Softness of a marker's rim, 1.8 times less than the standard deviation of the image's blur. Blur that was
        assumed wrong moves only markers at the ball's rim. 2.0, 1.2 and 0.5 px give 1.37, 1.09 and 0.90 degrees rms at
        30 degrees on `typical` (docs/log/localization.md#meters).
    iterations : int
        Most Gauss-Newton steps.
    tolerance_px : float
        A smaller step is the last.
    around : float
        How far beyond the rim pixels are compared, in radii of the marker; and
    margin_px : float
        more. A window is read anew when the marker has moved by this.
    shading_around : float
        How much farther the ball's shading is measured, in radii of the marker.
    shading_gap_px : float
        How far from the rim the shading is measured first.
    shading_spacing_px : float
        For each of these px of that range one pixel in a row more is left out.
    shading_weight : float
        Prior that holds the shading flat where there are few pixels, px^2.
    min_shading_pixels : float
        Pixels from which there is a shading.
    max_shading_change : float
        Largest change of the shading from the marker to the end of that range, as a share.
    highlight_ratio : float
        Brightness, in that of the ball around, from which a pixel is taken for a highlight.
    rim_inner_px, rim_outer_px : float
        Pixels count fully this far inside the ball's outline, and not at all nearer than the second.
    max_correlation, max_row_correlation : float
        Largest correlation of the noise of neighbors in a row, and between rows, that is assumed.
    min_weight : float
        Sum of weights, in pixels, below which there is nothing to fit.
    min_contrast : float
        Contrast, 1 at first, below which a fit is given up.
    max_step : float
        Longest step, in radii of the marker.
    ridge : float
        Added to the diagonal of the normal matrix, as a share of the weights: it has an inverse then.
    min_axis_ratio : float
        Least ratio of the axes of a marker's ellipse: a marker seen from its edge is drawn as this.
    size_sigma : float
        Standard deviation of a marker's radius, as a share of it.
    """

    softness_px: float = 0.7
    iterations: int = 8
    tolerance_px: float = 0.05
    around: float = 0.5
    margin_px: float = 3.0
    shading_around: float = 1.0
    shading_gap_px: float = 3.0
    shading_spacing_px: float = 10.0
    shading_weight: float = 20.0
    min_shading_pixels: float = 20.0
    max_shading_change: float = 0.5
    highlight_ratio: float = 1.15
    rim_inner_px: float = 3.5
    rim_outer_px: float = 0.5
    max_correlation: float = 0.8
    max_row_correlation: float = 0.8
    min_weight: float = 12.0
    min_contrast: float = 0.05
    max_step: float = 0.5
    ridge: float = 1e-9
    min_axis_ratio: float = 0.25
    size_sigma: float = 0.05


class MarkerColorParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How the difference between the colors of marker and ball is learned (`marker_color.py`).

    All were chosen by hand; `python -m benchmarks --only localization_markers` would show a change.

    Parameters
    ----------
    memory : float
        Share of what is known of the colors that one frame leaves.
    min_marker_pixels, min_ball_pixels : float
        Pixels of the markers and of the ball from which something is learned.
    marker_inside, marker_outside : float
        Pixels nearer to a marker's middle than the first are marker, farther than the second ball, in its radii.
    ball_inside : float
        How far from the ball's middle pixels are read, in its radii.
    rows : float
        Rows of a ball's radius that are read: larger balls are read with gaps.
    noise : float
        Variance of a color that is always assumed, gray levels squared: rounding.
    """

    memory: float = 0.9
    min_marker_pixels: float = 1.0
    min_ball_pixels: float = 8.0
    marker_inside: float = 0.75
    marker_outside: float = 1.7
    ball_inside: float = 0.9
    rows: float = 12.0
    noise: float = 1.0


class MarkerParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How markers are found and followed.

    All were chosen by hand; `python -m benchmarks --only localization_markers` would show a change.

    Parameters
    ----------
    min_area, max_area : float
        Area of a patch of the color at first sight, as a share of the marker's; the first with its foreshortening.
    min_foreshortening : float
        Least squared cosine that is assumed for that.
    grid_cells : float
        Cells across the ball in which markers are searched.
    search_radius : float
        How far from the ball's middle they are searched, in its radii.
    min_contrast : float
        Least contrast of a marker, as a share of what was seen at first.
    min_explained : float
        Least share of the variance around a marker that the marker explains.
    max_offset : float
        How far from the ball's middle a marker may be, in the largest possible offset: 0.95 is 72 degrees off the line
        of sight.
    patience : int
        For how many frames a marker that is not seen is expected where it was last.
    inflation : float
        Factor on the covariance of independent pixels: filters leave noise that is correlated over several rows.
    min_sigma_px : float
        Least standard deviation of a marker's place.
    fit : MarkerFitParameters
    color : MarkerColorParameters
    """

    min_area: float = 0.1
    max_area: float = 4.0
    min_foreshortening: float = 0.05
    grid_cells: float = 48.0
    search_radius: float = 0.97
    min_contrast: float = 0.4
    min_explained: float = 0.3
    max_offset: float = 0.95
    patience: int = 5
    inflation: float = 4.0
    min_sigma_px: float = 0.15
    fit: MarkerFitParameters = MarkerFitParameters()
    color: MarkerColorParameters = MarkerColorParameters()


class Ball:
    """The ball in the image, px."""

    x: float
    y: float
    radius: float
    radius_variance: float  # px^2
    field_x: float  # from the odd rows' field to that of the even rows, px
    field_y: float


class MarkerWindow:
    """Where the pixels around a marker are, and the model they are compared with."""

    left: int  # of the window in the image, px
    top: int
    span: int  # rows; a row has one pixel more, the first, which never counts
    x: float  # the marker's middle, from the window's corner, px
    y: float
    axis_x: float  # direction of the ellipse's short axis
    axis_y: float
    ratio: float  # of its axes
    semi_axis: float  # the long one, px
    reach: float  # farthest pixel that is compared, px
    shading: Annotated[Floats, (3,), "f8"]  # brightness of the ball there, and its change per px right and down
    contrast: float
    level: float


class WindowSums:
    """Sums over the pixels of a window; the columns are x, y, contrast, level."""

    normal: Annotated[Floats, (10,), "f8"]  # products of the columns, row by row up to the diagonal
    right_side: Annotated[Floats, (4,), "f8"]  # products with the residual
    residual_square: float
    weight: float
    value: float
    value_square: float
    raw_square: float  # of residuals from which nothing of their left neighbors' was taken
    row_product: float  # of neighbors in a row
    column_product: float  # of neighbors in a column


class MarkerResult:
    """What the fit of one marker found."""

    covariance: Annotated[Floats, (2, 2), "f8"]  # of the place, px^2
    contrast: float  # of 1; 0 where there was nothing to fit
    noise: float  # standard deviation of the residuals, of 1
    explained: float  # share of the variance


class MarkerWork:
    """Workspace of `follow_markers`; rows of arrays are markers."""

    limits: MarkerParameters
    patch_radius: float  # of a marker, in ball radii
    rim_distance: float  # of its rim's middle from the ball's center, in ball radii
    ball: Ball
    # what is learned
    colors: Annotated[Floats, (2, 10), "f8"]  # of markers and ball: count, 3 means, 6 products, see `sum_colors`
    axis: Annotated[Floats, (4,), "f8"]  # direction of color, per gray level, and offset: 0 on the ball, 1 on a marker
    brightness: Annotated[Floats, (3,), "f8"]  # weights of the color's channels for brightness in that of the ball
    noise_correlation: float  # of neighbors in a row; 0 where it is not known
    # the markers: those that were seen in the last frame come first
    count: int
    seen: int
    offsets: Annotated[Floats, (CAPACITY, 2), "f8"]  # from the ball's middle, in ball radii
    places: Annotated[Floats, (CAPACITY, 2), "f8"]  # px
    # what is found, in this order, `seen` rows; `order` has the former row of every marker
    order: Annotated[Ints, (CAPACITY,), "i8"]
    middle: Annotated[Floats, (CAPACITY, 2), "f8"]  # px
    radius: Annotated[Floats, (CAPACITY,), "f8"]  # of the circle of the ellipse's area, px
    explained: Annotated[Floats, (CAPACITY,), "f8"]
    covariance: Annotated[Floats, (CAPACITY, 3, 3), "f8"]  # of x, y and radius, px^2
    rim: Annotated[Floats, (CAPACITY, RIM_POINTS, 2), "f8"]  # points of the ellipse, px
    # of one fit
    window: MarkerWindow
    sums: WindowSums
    result: MarkerResult
    matrix: Annotated[Floats, (16,), "f8"]  # the normal matrix, then its Cholesky factor
    step: Annotated[Floats, (4,), "f8"]


MARKERS = record_dtype(MarkerWork)
