"""Is it there? What a fit must show before anyone is told, and how certain it is."""

from typing import TypeVar

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.shapes.shape import Shape
from matchset.tracking.matcher import Matcher
from matchset.tracking.track import Track

S = TypeVar("S", bound=Shape)
Floats = npt.NDArray[np.float64]

FOLLOWING = 1.5  # leeway of the limits on another shape while motion speaks for it


class JudgeParameters(msgspec.Struct, frozen=True):
    """What confirms a shape.

    Parameters
    ----------
    support : float
        Least share of the outline (as far as it is in the picture) that edge points must confirm while following.
    agreement, least_agreement : float
        Least agreement of the edge points with the outline: at first sight, when no motion speaks for it, and while
        following.
    small : float
        Half-width below which chance makes shapes easily, px: there the agreement must be `small_agreement`.
    inside, first_inside : float
        Least share of the inside that must look like the target, while following and at first sight: a marker, a
        highlight and things in front of it do not.
    core, first_core : float
        The same for the middle alone, which a ring does not fill.
    in_picture : float
        Least share of the outline that must be in the picture.
    wave, corners : float
        Largest correlation of neighboring residuals and largest harmonic of a corner: above them the outline is of
        another shape.
    bent : float
        Largest modes, in half-widths: 0.1 is an ellipse of axis ratio 1.22.
    inflation : float
        By how much the covariance of independent edge points is enlarged, since neighboring points err together.
    center_floor, size_floor : float
        Least standard deviation of place and size, px: shading, blur and the grid of pixels shift all points alike.
    """

    support: float = 0.42
    agreement: float = 0.55
    least_agreement: float = 0.25
    small: float = 8.0
    small_agreement: float = 0.75
    inside: float = 0.4
    first_inside: float = 0.5
    core: float = 0.12
    first_core: float = 0.25
    in_picture: float = 0.3
    wave: float = 0.45
    corners: float = 4.0
    bent: float = 0.13
    inflation: float = 1.8
    center_floor: float = 0.04
    size_floor: float = 0.09


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

    def first_sight(self, matcher: Matcher[S]) -> str:
        """Why a shape found by a search is not confirmed, in words; empty if it is."""
        limits = self.parameters
        if matcher.seen < limits.in_picture * matcher.points:
            return "most of it is outside the picture"
        small = matcher.family.half_width(matcher.state) < limits.small
        if matcher.agreement < (limits.small_agreement if small else limits.agreement):
            return f"only {100.0 * matcher.agreement:.0f} % of the outline agrees"
        if self._other_shape(matcher, 1.0):
            return "its outline has another shape"
        return self._content(matcher, limits.first_inside, limits.first_core)

    def _other_shape(self, matcher: Matcher[S], leeway: float) -> bool:
        limits = self.parameters
        return (
            matcher.wave > limits.wave * leeway
            or matcher.corners > limits.corners * leeway
            or matcher.bent > limits.bent * leeway
        )

    def _content(self, matcher: Matcher[S], inside: float, core: float) -> str:
        """Whether the inside looks like the target."""
        if matcher.inside < inside or matcher.core < core:
            return f"only {100.0 * max(matcher.inside, 0.0):.0f} % of the inside has the target's color"
        return ""

    def merit(self, matcher: Matcher[S]) -> float:
        """How good a confirmed shape is, to rank candidates: agreement of the outline times share of the inside."""
        return matcher.agreement * matcher.seen / matcher.points * matcher.inside

    def covariance(self, matcher: Matcher[S]) -> Floats:
        """Covariance of the shape's parameters: of the edge points, enlarged, and the floor, (p, p)."""
        limits, p = self.parameters, matcher.count
        result: Floats = limits.inflation * matcher.full_covariance[:p, :p]
        for k in range(p):
            result[k, k] += (limits.center_floor if k < 2 else limits.size_floor) ** 2
        return result

    def track(self, matcher: Matcher[S], time: float) -> Track[S]:
        """The answer for a confirmed shape."""
        return Track(
            matcher.family.from_state(matcher.state),
            self.covariance(matcher),
            matcher.confirmed / matcher.seen,
            matcher.match_set(),
            time,
        )
