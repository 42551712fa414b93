"""Is it there? What a fit must show before anyone is told, and how certain it is."""

from typing import TypeVar

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.shapes.shape import Shape
from matchset.tracking.matcher import Matcher
from matchset.tracking.review import conclude
from matchset.tracking.track import Track

S = TypeVar("S", bound=Shape)
Floats = npt.NDArray[np.float64]

WHOLE = 0.9  # share of the outline in the picture from which a shape counts as whole
CERTAIN = 0.85  # evidence from which neighbors may err together, as on an ellipse
FOLLOWING = 1.5  # leeway of the limits on another shape while motion speaks for it


class JudgeParameters(msgspec.Struct, frozen=True):
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
    bent : float
        Largest modes, in half-widths: 0.1 is an ellipse of axis ratio 1.22.
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
    bent: float = 0.1
    inflation: float = 1.8
    center_floor: float = 0.02
    size_floor: float = 0.05


class Judge:
    """Judges what a matcher found.

    Parameters
    ----------
    parameters : JudgeParameters
    """

    def __init__(self, parameters: JudgeParameters | None = None) -> None:
        self.parameters = parameters or JudgeParameters()

    def following(self, matcher: Matcher[S]) -> str:
        """Why the shape that was followed is not confirmed, in words; empty if it is."""
        limits = self.parameters
        if matcher.seen < limits.in_picture * matcher.points:
            return "most of it is outside the picture"
        if matcher.confirmed < limits.support * matcher.seen:
            return f"only {100.0 * matcher.confirmed / matcher.seen:.0f} % of the outline is confirmed"
        if matcher.agreement < limits.least_agreement or self._other_shape(matcher, FOLLOWING):
            return "its outline has another shape"
        return self._content(matcher, limits.inside, limits.core)

    def first_sight(self, matcher: Matcher[S], expected: bool = False) -> str:
        """Why a shape found by a search is not confirmed, in words; empty if it is.

        A shape that is `expected` about here needs less evidence than one that may be anywhere.
        """
        limits = self.parameters
        if matcher.seen < limits.in_picture * matcher.points:
            return "most of it is outside the picture"
        size = matcher.family.half_width(matcher.state)
        least = limits.evidence, limits.small_evidence, limits.tiny_evidence
        whole = matcher.seen >= WHOLE * matcher.points  # at the border a card may pass for a ball that leaves
        leeway = limits.expected if expected and whole else 1.0
        if matcher.evidence < leeway * np.interp(size, (8.0, 12.0, 24.0), least[::-1]):
            return f"only {100.0 * matcher.evidence:.0f} % of the outline speaks for it"
        if self._other_shape(matcher, 1.0):
            return "its outline has another shape"
        return self._content(matcher, limits.first_inside, limits.first_core)

    def _other_shape(self, matcher: Matcher[S], leeway: float) -> bool:
        limits = self.parameters
        return (
            (matcher.wave > limits.wave * leeway and matcher.evidence < CERTAIN)
            or matcher.corners > limits.corners * leeway
            or matcher.bent > limits.bent * leeway
            or matcher.hollow > limits.hollow * leeway
        )

    def _content(self, matcher: Matcher[S], inside: float, core: float) -> str:
        """Whether the inside looks like the target."""
        if matcher.inside < inside or matcher.core < core:
            return f"only {100.0 * max(matcher.inside, 0.0):.0f} % of the inside has the target's color"
        return ""

    def merit(self, matcher: Matcher[S]) -> float:
        """How good a confirmed shape is, to rank candidates: evidence of the outline times share of the inside."""
        return matcher.evidence * matcher.seen / matcher.points * matcher.inside

    def track(self, matcher: Matcher[S], time: float) -> Track[S]:
        """Answer with a confirmed shape.

        Its match-set is what lies within 4 standard deviations of the fitted outline, which may be an ellipse; its
        covariance that of the edge points, enlarged, and the floor.
        """
        limits = self.parameters
        points, covariance = conclude(
            matcher.lines.outline,
            matcher.lines.edges,
            matcher.found,
            4.0 * max(matcher.noise, 0.4),
            matcher.full_covariance,
            limits.inflation,
            limits.center_floor**2,
            limits.size_floor**2,
        )
        shape = matcher.family.from_state(matcher.state)
        return Track(shape, covariance, matcher.confirmed / matcher.seen, points, time)
