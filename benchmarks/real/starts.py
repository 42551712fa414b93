"""Where and when a clip is clicked: nine places on the disc, three frames to begin at."""

import math

import msgspec

from benchmarks.real.clips import Clip
from matchset.app.track.score import TruthRow

DIAGONAL = 0.6 * math.sqrt(0.5)
CLICKS = (
    (-0.5, 0.0),
    (0.5, 0.0),
    (0.0, -0.5),
    (0.0, 0.5),
    (0.0, 0.0),
    (-DIAGONAL, -DIAGONAL),
    (DIAGONAL, -DIAGONAL),
    (-DIAGONAL, DIAGONAL),
    (DIAGONAL, DIAGONAL),
)
"""Where on the disc a click hits, in radii from the center; the first is the standard one."""

BEGINNINGS = 3
QUICK_CLICKS = (0, 4, 8)
LEFT = 5  # tight rows that must come after the one that is clicked


class Start(msgspec.Struct, frozen=True):
    """One click.

    Parameters
    ----------
    click : int
        Which of `CLICKS`.
    beginning : int
        Which of the frames to begin at: 0 is the first tight row, 1 and 2 are about 1/3 and 2/3 through.
    frame : int
        That frame's index.
    x, y : float
        The click, px.
    """

    click: int
    beginning: int
    frame: int
    x: float
    y: float

    @property
    def standard(self) -> bool:
        """Whether this is the click that the goals of single clips are for."""
        return self.click == 0 and self.beginning == 0


def starts_of(clip: Clip, quick: bool = False) -> list[Start]:
    """List the starts of a clip, the standard one first.

    Parameters
    ----------
    clip : Clip
    quick : bool
        Three clicks in the first tight row instead of nine in three.

    Returns
    -------
    list of Start
        Up to 27: other clicks than the standard one that would miss the picture are left out, and so are frames with
        fewer than five tight rows behind them, but for the first.
    """
    rows = beginnings(clip)[: 1 if quick else BEGINNINGS]
    chosen = QUICK_CLICKS if quick else range(len(CLICKS))
    starts = [start_at(row, click, number) for number, row in enumerate(rows) for click in chosen]
    return [each for each in starts if each.standard or _hits(clip, each)]


def beginnings(clip: Clip) -> list[TruthRow]:
    """Tight rows to begin at: the first, and those 1/3 and 2/3 through."""
    tight = clip.tight
    rows = sorted({len(tight) * k // BEGINNINGS for k in range(BEGINNINGS)})
    return [tight[row] for row in rows if row == 0 or len(tight) - 1 - row >= LEFT]


def start_at(row: TruthRow, click: int, beginning: int = 0) -> Start:
    """Make the start of a click into a row's disc."""
    if row.circle is None:
        raise ValueError(f"frame {row.frame} shows no ball to click at")
    x, y, radius = row.circle
    across, down = CLICKS[click]
    return Start(click, beginning, row.frame, x + across * radius, y + down * radius)


def _hits(clip: Clip, start: Start) -> bool:
    return 0.0 <= start.x <= clip.width - 1 and 0.0 <= start.y <= clip.height - 1
