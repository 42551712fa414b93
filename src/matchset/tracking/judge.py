"""Is it there? The verdicts in words, and what a first sight must show."""

import enum
import math
from typing import TypeVar

import numpy as np

from matchset.shapes.shape import Shape
from matchset.tracking.matcher import Matcher
from matchset.tracking.memory import CONFIRMED, CORE, CORNERS, EVIDENCE, HOLLOW, INSIDE, SEEN
from matchset.tracking.verdict import (
    EDGELESS,
    FOREIGN,
    LEFT,
    MOST_CORNERS,
    OTHER_SHAPE,
    OUTSIDE,
    UNCONFIRMED,
    following,
    is_other_shape,
)

S = TypeVar("S", bound=Shape)

ROUND = 1.5  # corners that noise and a stick leave on a disc, in standard deviations
CLICKED = 1.25  # of the limits on another shape where somebody says that it is there
WHOLE = 0.9  # share of the outline in the picture from which a shape counts as whole


class Prior(enum.Enum):
    """What is known of a shape before it is seen.

    Attributes
    ----------
    NONE
        Nothing: there may be none in the picture.
    PRESENT
        It is in the picture: somebody clicked at it, or it was followed until now.
    HERE
        It is expected about here.
    """

    NONE, PRESENT, HERE = range(3)


class Judge:
    """Judges what a matcher found, by the limits of that matcher's parameters."""

    def words(self, matcher: Matcher[S], verdict: int) -> str:
        """Say why a shape that was followed is not confirmed; empty if it is."""
        seen, confirmed = matcher.fit(SEEN), matcher.fit(CONFIRMED)
        return {
            OUTSIDE: "most of it is outside the picture",
            UNCONFIRMED: f"only {100.0 * confirmed / max(seen, 1.0):.0f} % of the outline is confirmed",
            OTHER_SHAPE: "its outline has another shape",
            FOREIGN: _content(matcher),
            EDGELESS: "no edges of the target's color where it should be",
            LEFT: "it left the picture",
        }.get(verdict, "")

    def following(self, matcher: Matcher[S]) -> str:
        """Why the shape that was followed is not confirmed, in words; empty if it is."""
        parts = matcher.parts
        return self.words(matcher, following(parts.fit, parts.judge, matcher.points))

    def first_sight(self, matcher: Matcher[S], prior: Prior = Prior.PRESENT) -> str:
        """Why a shape found by a search is not confirmed, in words; empty if it is.

        A shape that is expected about here needs less evidence than one that may be anywhere; one that nothing else
        speaks for needs more, the more corners it has. So does one of which only a part is in the picture.
        """
        limits, fit = matcher.parameters.validation, matcher.fit
        if fit(SEEN) < limits.in_picture * matcher.points:
            return "most of it is outside the picture"
        least = limits.evidence, limits.small_evidence, limits.tiny_evidence
        whole = fit(SEEN) >= WHOLE * matcher.points  # at the border a card may pass for a ball that leaves
        leeway = limits.expected if prior is Prior.HERE and whole else 1.0
        doubt = limits.part_doubt * max(WHOLE - fit(SEEN) / matcher.points, 0.0)
        if prior is Prior.NONE and matcher.parts.judge[MOST_CORNERS] < math.inf:
            doubt += limits.corner_doubt * max(fit(CORNERS) - ROUND, 0.0)
        if fit(EVIDENCE) < leeway * np.interp(matcher.size, (8.0, 12.0, 24.0), least[::-1]) + doubt:
            return f"only {100.0 * fit(EVIDENCE):.0f} % of the outline speaks for it"
        unfilled = prior is Prior.NONE and fit(HOLLOW) < -limits.first_rim
        drawn = CLICKED if prior is Prior.PRESENT else 1.0
        if unfilled or is_other_shape(matcher.parts.fit, matcher.parts.judge, drawn):
            return "its outline has another shape"
        if fit(INSIDE) < limits.first_inside or fit(CORE) < limits.first_core:
            return _content(matcher)
        return ""

    def merit(self, matcher: Matcher[S]) -> float:
        """How good a confirmed shape is, to rank candidates: evidence of the outline times share of the inside."""
        return matcher.fit(EVIDENCE) * matcher.fit(SEEN) / matcher.points * matcher.fit(INSIDE)


def _content(matcher: Matcher[S]) -> str:
    """Say that the inside does not look like the target."""
    return f"only {100.0 * max(matcher.fit(INSIDE), 0.0):.0f} % of the inside has the target's color"
