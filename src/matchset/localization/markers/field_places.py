"""Where each field of half-frames showed the ball: a half-frame as an interlaced picture, `FieldPlaces`."""

from msgspec.structs import replace

from matchset.image.frame import Rows
from matchset.shapes.circle import Circle
from matchset.tracking.track import Track

OTHER: dict[Rows, Rows] = {"top": "bottom", "bottom": "top"}  # geometry: rows that a half-frame holds from before
Point = tuple[float, float]


class FieldPlaces:
    """Remembers where the ball was when the rows of either field were new.

    So the rows that a half-frame still holds from the field before can be read where they show the ball.
    """

    def __init__(self) -> None:
        self._places: dict[Rows, Point] = {}

    def forget(self) -> None:
        """Know of no ball."""
        self._places.clear()

    def as_interlaced(self, ball: Track[Circle], rows: Rows) -> tuple[Track[Circle], Point]:
        """Describe the ball of a half-frame as that of an interlaced picture.

        Parameters
        ----------
        ball : Track
            In the new rows.
        rows : str
            Which those are, `Frame.rows`: "top" or "bottom".

        Returns
        -------
        ball : Track
            Midway between where both fields show it, with its `field_offset`.
        moved : (float, float)
            From there to where the new rows show it, px.
        """
        here = float(ball.shape.x), float(ball.shape.y)
        self._places[rows] = here
        before = self._places.get(OTHER[rows], here)
        moved = 0.5 * (here[0] - before[0]), 0.5 * (here[1] - before[1])
        middle = Circle(here[0] - moved[0], here[1] - moved[1], ball.shape.radius)
        sign = 2.0 if rows == "top" else -2.0
        return replace(ball, shape=middle, field_offset=(sign * moved[0], sign * moved[1])), moved
