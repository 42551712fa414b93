"""Truth files: where the ball really was, in `video,frame,x,y,r,visible,method`."""

from pathlib import Path

import msgspec

from matchset.app.tables import Cells, read_csv

COLUMNS = ("video", "frame", "x", "y", "r", "visible", "method")


class Truth(msgspec.Struct, frozen=True):
    """Where the ball is in one frame.

    Parameters
    ----------
    frame : int
        The frame's place in the video, from 0, in decode order.
    circle : tuple of three floats, or None
        Center x, y and radius, px; None where the ball is absent.
    lowconf : bool
        The circle is good to a few pixels only: it says that the ball is there, but is left out of tight
        scores.
    """

    frame: int
    circle: tuple[float, float, float] | None
    lowconf: bool = False

    @property
    def tight(self) -> bool:
        """Whether the circle is visible and known well enough to measure an error against."""
        return self.circle is not None and not self.lowconf


def read_truth(path: str | Path, video: str | None = None) -> list[Truth]:
    """Read a truth file.

    Parameters
    ----------
    path : str or Path
        A CSV file with the columns ``video,frame,x,y,r,visible,method``.
    video : str, optional
        Which video's rows to take; needed only if the file holds several.

    Returns
    -------
    list of Truth
        One for each row, in the order of their frames.

    Raises
    ------
    ValueError
        If the file cannot be read or a row is wrong; the message holds the file and the line.
    """
    rows = read_csv(path, required=("frame", "x", "y", "r", "visible"))
    videos = sorted({row.text("video") for row in rows})
    if video is not None and video not in videos:
        raise ValueError(f"{path} holds no rows of the video {video!r}; it has {', '.join(videos) or 'none'}")
    if video is None and len(videos) > 1:
        raise ValueError(f"{path} holds several videos ({', '.join(videos)}): say which")
    chosen = [row for row in rows if video is None or row.text("video") == video]
    truths: dict[int, Truth] = {}
    for row in chosen:
        truth = _truth(row)
        if truth.frame in truths:
            raise row.error(f"frame {truth.frame} was given before")
        truths[truth.frame] = truth
    return [truths[frame] for frame in sorted(truths)]


def _truth(row: Cells) -> Truth:
    frame = row.index("frame")
    if not row.flag("visible"):
        return Truth(frame, None)
    circle = row.number("x"), row.number("y"), row.number("r")
    if circle[2] <= 0.0:
        raise row.error(f"the radius must be positive, got {row.text('r')}")
    return Truth(frame, circle, lowconf=row.text("method").endswith("|lowconf"))
