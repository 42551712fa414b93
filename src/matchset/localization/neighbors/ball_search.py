"""Who has come into view? A search of the picture, a strip in each frame: `Newcomers`."""

import math
from collections.abc import Sequence

import msgspec

from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.shapes.circle import Circle
from matchset.tracking.detect import channels_last
from matchset.tracking.judge import Judge
from matchset.tracking.look import Look
from matchset.tracking.matcher import Matcher
from matchset.tracking.voting import Searcher

HOPELESS = 0.25  # agreement below which a candidate is given up at once
STRIPS = 3  # each half as high as the picture, each overlapping the next by half


class NewcomerParameters(msgspec.Struct, frozen=True):
    """How newcomers are looked for.

    Parameters
    ----------
    points : int
        Lines across the outline of a candidate.
    candidates : int
        How many places of a strip are looked at closely in one frame: more finds faster in a crowd and takes longer.
    smallest : float
        Least radius of a newcomer, px: smaller ones are mostly noise.
    """

    points: int = 64
    candidates: int = 4
    smallest: float = 6.0


class Newcomers:
    """Looks for balls that nobody follows yet; the whole picture takes three frames.

    A strip is searched on its coarse grid alone; what it proposes is fitted in the picture itself, so a ball may be
    larger than its strip. The strips overlap by half, so every ball's middle is well inside one of them.

    Parameters
    ----------
    color : ColorModel
        Of the balls.
    parameters : NewcomerParameters, optional
    """

    def __init__(self, color: ColorModel, parameters: NewcomerParameters | None = None) -> None:
        self.color = color
        self.parameters = parameters or NewcomerParameters()
        self._matcher: Matcher[Circle] = Matcher(Circle, self.parameters.points)
        self._judge = Judge()
        self._searcher: Searcher | None = None
        self._strip = 0

    def update(self, frame: Frame, known: Sequence[Circle]) -> list[Circle]:
        """Search the next strip.

        Parameters
        ----------
        frame : Frame
        known : sequence of Circle
            What is followed already, or expected.

        Returns
        -------
        list of Circle
            Confirmed balls that are none of these, best first.
        """
        image = channels_last(frame.image)
        height, width = image.shape[:2]
        size = width, max(height // 2, 1)
        if self._searcher is None or self._searcher.size != size:
            self._searcher = Searcher(*size)
        top = self._strip * (height - size[1]) // (STRIPS - 1)
        self._strip = (self._strip + 1) % STRIPS
        found: list[Circle] = []
        looks = 0
        for x, y, radius, _ in self._searcher.candidates(image[top : top + size[1]], self.color).tolist():
            rough = Circle(x, y + top, radius)
            if covered(rough, [*known, *found]) or looks == self.parameters.candidates:
                continue
            looks += 1
            reach = max(2.0 * self._searcher.stride, 0.2 * radius)
            if not self._matcher.settle(image, self.color, rough.state, Look(reach, least=HOPELESS)):
                continue
            if self._matcher.size < self.parameters.smallest or self._judge.first_sight(self._matcher):
                continue
            circle = Circle.from_state(self._matcher.state)
            if not covered(circle, [*known, *found]):
                found.append(circle)
        self._matcher.forget()
        return found


def covered(circle: Circle, others: Sequence[Circle]) -> bool:
    """Whether a circle is one of the others, or inside one, or around one."""
    return any(
        math.hypot(circle.x - other.x, circle.y - other.y) < 0.7 * max(circle.radius, other.radius) for other in others
    )
