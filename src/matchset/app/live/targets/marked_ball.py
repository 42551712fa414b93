"""A click on a marker means the ball around it: `around_marker`, `meant_target`."""

import math
from typing import Any

import msgspec

from matchset.app.live.targets.messages import Begin, Pick
from matchset.app.live.targets.target import Target
from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.shapes.circle import Circle
from matchset.tracking.track import Track
from matchset.tracking.tracker import Tracker


class MarkedBallParameters(msgspec.Struct, frozen=True, kw_only=True):
    """When a disc that was clicked is taken for a marker on a ball.

    Parameters
    ----------
    beside : float
        Where beside the disc the ball's color is learned, radii of the disc from its middle. More: also beside discs
        with a soft rim, and outside of balls with a large marker. Chosen by hand: markers have a third of the ball's
        radius at most.
    larger : float
        Radius of the ball at least, radii of the disc. Less: larger markers, and a ball's own bright spot or a ring
        around a ball may count. Chosen by hand, below the third.
    outside : float
        How far the disc may reach over the ball's rim, radii of the ball. More: markers that are seen from the side,
        and discs before something round. Chosen by hand.
    support : float
        Share of the ball's outline that is confirmed at least. More: balls that are partly hidden do not count, nor do
        chance circles of the background. Of 20 rendered balls with a marker it was 0.95 to 1, of chance circles 0.2 to
        0.73.
    """

    beside: float = 1.6
    larger: float = 1.8
    outside: float = 0.05
    support: float = 0.9


def around_marker(begin: Begin, frame: Frame, parameters: MarkedBallParameters | None = None) -> Begin:
    """Return a click on the ball around a marker that was clicked; where there is none, the click itself.

    Both are learned and looked for in the same picture, which takes some tenths of a second.

    Parameters
    ----------
    begin : Pick or Outline
        What is drawn is meant as it is.
    frame : Frame
        In which it was.
    parameters : MarkedBallParameters, optional
    """
    if not isinstance(begin, Pick) or begin.shape != "circle":
        return begin
    limits, seen = parameters or MarkedBallParameters(), _circle_at(frame, begin.x, begin.y)
    if seen is None:
        return begin
    disc = seen.shape
    toward = 1.0 if disc.x < 0.5 * frame.image.shape[1] else -1.0  # the side on which there is more of the picture
    x, y = disc.x + toward * limits.beside * disc.radius, disc.y
    around = _circle_at(frame, x, y)
    if around is None or around.support < limits.support or around.shape.radius < limits.larger * disc.radius:
        return begin
    ball = around.shape
    reach = math.hypot(disc.x - ball.x, disc.y - ball.y) + disc.radius
    return msgspec.structs.replace(begin, x=x, y=y) if reach < (1.0 + limits.outside) * ball.radius else begin


def meant_target(number: int, begin: Begin, frame: Frame) -> Target:
    """Make what a click means: a target, and a ball where its marker was clicked."""
    meant = around_marker(begin, frame)
    target = Target(number, meant, frame)
    if meant is not begin and not target.note:
        target.note = "the click was on a marker: the ball around it is followed"
    return target


def _circle_at(frame: Frame, x: float, y: float) -> Track[Circle] | None:
    """Return what a click would follow; None if there is no circle around the point."""
    try:
        tracker: Tracker[Any] = Tracker(Circle, ColorModel.pick(frame.image, x, y), start=(x, y))
    except ValueError:
        return None
    track = tracker.update(frame)
    if not isinstance(track, Track):
        return None
    found: Circle = track.shape
    return track if math.hypot(x - found.x, y - found.y) < found.radius else None
