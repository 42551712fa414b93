"""Is it there? What a fit must show before anyone is told: the rules, in compiled form."""

import math

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import inlined, kernel
from matchset.tracking.memory import (
    AGREEMENT,
    BENT,
    CONFIRMED,
    CORE,
    CORNERS,
    EVIDENCE,
    HOLLOW,
    INSIDE,
    NOISE,
    SEEN,
    SIZE,
    USUAL,
    WAVE,
    Views,
)
from matchset.tracking.motion import correct
from matchset.tracking.review import conclude

Floats = npt.NDArray[np.float64]

CERTAIN = 0.85  # evidence from which neighbors may err together, as on an ellipse, and the lens may bend it
LEEWAY = 1.5  # of the limits on another shape while motion speaks for it, or almost all of its outline
PRESENT = 0.3  # share of the lines in the picture below which a shape has left it
SMALLEST = 6.0  # half-width below which there is nothing to tell apart, px

# verdicts
SURE, OUTSIDE, UNCONFIRMED, OTHER_SHAPE, FOREIGN, EDGELESS, LEFT, DOUBTFUL = range(8)


class ValidationParameters(msgspec.Struct, frozen=True):
    """What confirms a shape.

    Parameters
    ----------
    support : float
        Least share of the outline (as far as it is in the picture) that edge points must confirm while following.
    least_agreement : float
        Least agreement of the edge points with the outline while following.
    evidence, small_evidence, tiny_evidence : float
        At first sight, when no motion speaks for it: least evidence of the edge points for half-widths from 24 px on,
        at 12 px and up to 8 px. Chance makes small shapes easily.
    expected : float
        Factor on that evidence for a shape that is expected about here.
    inside, first_inside : float
        Least share of the inside that must look like the target, while following and at first sight: a marker, a
        highlight and things in front of it do not.
    core, first_core : float
        The same for the middle alone, which a ring does not fill.
    in_picture : float
        Least share of the outline that must be in the picture.
    wave, corners, hollow : float
        Largest correlation of neighboring residuals, harmonic of a corner and emptiness of the middle: above them it
        is another shape.
    corner_doubt : float
        By how much more evidence is asked of a shape that nothing speaks for yet, per unit of corners beyond those of
        a disc: less finds a half-covered ball sooner, more keeps a card from passing for one.
    part_doubt : float
        By how much more evidence is asked at first sight per share of the outline outside the picture.
    first_rim : float
        By how much emptier than the middle the inside next to the rim may be, of a shape that nothing speaks for yet:
        a card before a foreign ring fills the middle and not the rim.
    bent : float
        Largest modes, in half-widths: 0.1 is an ellipse of axis ratio 1.22.
    doubt, side_doubt : float
        Agreement below which a fit is looked at again, and evidence below which one of a shape is whose sides move
        alone: one of them may follow another edge while the others look well. More costs time, less finds it late.
    inflation : float
        By how much the covariance of independent edge points is enlarged, since neighboring points err together.
    center_floor, size_floor : float
        Least standard deviation of place and size, px: shading, blur and the grid of pixels shift all points alike.
    """

    support: float = 0.42
    least_agreement: float = 0.25
    evidence: float = 0.5
    small_evidence: float = 0.7
    tiny_evidence: float = 0.8
    expected: float = 0.8
    inside: float = 0.4
    first_inside: float = 0.5
    core: float = 0.12
    first_core: float = 0.25
    in_picture: float = 0.3
    wave: float = 0.5
    corners: float = 4.0
    hollow: float = 0.28
    corner_doubt: float = 0.06
    part_doubt: float = 0.5
    first_rim: float = 0.5
    bent: float = 0.1
    doubt: float = 0.7
    side_doubt: float = 0.92
    inflation: float = 1.15
    center_floor: float = 0.01
    size_floor: float = 0.05


# places of the parameters in `Views.judge`
_PLACES = {name: place for place, name in enumerate(ValidationParameters.__struct_fields__)}
SUPPORT, LEAST_AGREEMENT, IN_PICTURE = _PLACES["support"], _PLACES["least_agreement"], _PLACES["in_picture"]
LEAST_INSIDE, LEAST_CORE = _PLACES["inside"], _PLACES["core"]
MOST_WAVE, MOST_CORNERS, MOST_BENT, MOST_HOLLOW = (_PLACES[name] for name in ("wave", "corners", "bent", "hollow"))
DOUBT, SIDE_DOUBT = _PLACES["doubt"], _PLACES["side_doubt"]
INFLATION, CENTER_FLOOR, SIZE_FLOOR = (_PLACES[name] for name in ("inflation", "center_floor", "size_floor"))


@kernel(refcount=False)
def is_other_shape(fit: Floats, limits: Floats, leeway: float) -> bool:
    """Whether the edge points follow an outline, but not one of this family.

    Parameters
    ----------
    fit, limits
        `Views.fit` and `Views.judge`.
    leeway : float
        Factor on the limits.
    """
    is_certain = fit[EVIDENCE] >= CERTAIN
    drawn = max(leeway, LEEWAY) if is_certain else leeway  # a lens may draw a ball's outline out of shape
    return bool(
        (fit[WAVE] > limits[MOST_WAVE] * leeway and not is_certain)
        or fit[CORNERS] > limits[MOST_CORNERS] * drawn
        or fit[BENT] > limits[MOST_BENT] * drawn
        or fit[HOLLOW] > limits[MOST_HOLLOW] * leeway
    )


@kernel(refcount=False)
def following(fit: Floats, limits: Floats, points: int) -> int:
    """Verdict on a shape that was followed: `SURE` if this frame confirms it, else what speaks against it.

    Parameters
    ----------
    fit, limits
        `Views.fit` and `Views.judge`.
    points : int
        Number of lines.
    """
    if fit[SEEN] < limits[IN_PICTURE] * points:
        return OUTSIDE
    if fit[CONFIRMED] < limits[SUPPORT] * fit[SEEN]:
        return UNCONFIRMED
    if fit[AGREEMENT] < limits[LEAST_AGREEMENT] or is_other_shape(fit, limits, LEEWAY):
        return OTHER_SHAPE
    if fit[INSIDE] < limits[LEAST_INSIDE] or fit[CORE] < limits[LEAST_CORE]:
        return FOREIGN
    return SURE


@kernel(refcount=False)
def missing(seen: float, points: int) -> int:
    """Verdict where there was nothing to fit."""
    return LEFT if seen < PRESENT * points else EDGELESS


@kernel(refcount=False)
def is_doubtful(fit: Floats, limits: Floats, points: int) -> bool:
    """Whether a fit should be looked at again, since its edge points hardly agree, or too few have the color's step."""
    weak = fit[AGREEMENT] < limits[DOUBT] or fit[EVIDENCE] < limits[SIDE_DOUBT]
    return bool(weak and fit[NOISE] > 0.0 and fit[SEEN] > 0.5 * points and fit[SIZE] > SMALLEST)


@kernel(refcount=False)
def is_near(state: Floats, size: float, expected: Floats, expected_size: float, surprise: float) -> bool:
    """Whether a fitted state is so near to its prediction that it needs no other proof.

    Parameters
    ----------
    state, expected : (s,)
    size, expected_size : float
        Their half-widths, px.
    surprise : float
        By how much predictions have lately missed, px.
    """
    far = math.hypot(state[0] - expected[0], state[1] - expected[1])
    change = abs(size - expected_size)
    return bool(change <= 0.1 * expected_size + 1.0 and far <= 0.3 * expected_size + 2.0 * surprise)


@inlined
def answer(parts: Views, points: Floats, covariance: Floats) -> tuple[float, int]:
    """Write match-set and covariance of what was fitted; returns the support and the size of the match-set.

    The match-set is what lies within 4 standard deviations of the fitted outline, which may be an ellipse; the
    covariance that of the edge points, enlarged, and the floor.
    """
    fit, limits = parts.fit, parts.judge
    count = conclude(
        parts.outline,
        parts.edges,
        parts.found,
        4.0 * max(fit[NOISE], 0.4),
        parts.covariance,
        limits[INFLATION] / max(fit[AGREEMENT], 0.1) ** 2,
        limits[CENTER_FLOOR] ** 2,
        limits[SIZE_FLOOR] ** 2,
        points,
        covariance,
    )
    return fit[CONFIRMED] / max(fit[SEEN], 1.0), count


@inlined
def take_in(parts: Views, time: float) -> None:
    """Correct the motion and the usual size with a confirmed shape."""
    correct(parts, time)
    if parts.fit[AGREEMENT] > 0.75:
        usual = parts.clock[USUAL]
        parts.clock[USUAL] = usual + 0.1 * (parts.fit[SIZE] - usual) if usual > 0.0 else parts.fit[SIZE]
