"""The color of the markers, as the command line says it: `--marker-pick` or `--marker-color`."""

import functools
import operator
from pathlib import Path

import msgspec

from matchset.app.track.frame_picker import frame_at
from matchset.app.track.target_options import Target, Wish, parse_pick, target_for
from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.image.video import Video


class MarkerWish(msgspec.Struct, frozen=True):
    """The options that say what color the markers have, as typed; at most one of the two is given."""

    pick: str | None = None
    colors: tuple[Path, ...] = ()

    @property
    def given(self) -> bool:
        """Whether markers are to be looked for."""
        return self.pick is not None or bool(self.colors)


def check_marker_wish(wish: MarkerWish) -> None:
    """Refuse a wish that is both or does not read (ValueError)."""
    if wish.pick is not None and wish.colors:
        raise ValueError("give one of --marker-pick and --marker-color, not both")
    if wish.pick is not None:
        parse_pick(wish.pick, "--marker-pick")


def targets_for(
    source: str, video: Video, wish: Wish, marker: MarkerWish
) -> tuple[Target, ColorModel | None, tuple[Frame, ...]]:
    """Find out what to follow, and the color of its markers, in a video that is about to be read.

    Parameters
    ----------
    source : str
        What was opened: a file is opened once more to look at it.
    video : Video
        Not yet read.
    wish, marker : Wish, MarkerWish
        What to follow, as typed.

    Returns
    -------
    target : Target
        The ball, in its own color and the markers': the paper's filter a.
    color : ColorModel or None
        Of the markers alone: its filter b.
    frames : tuple of Frame
        What a live source gave away for it, to be followed all the same.
    """
    target, ahead = target_for(source, video, wish)
    if not marker.given:
        return target, None, ahead
    if marker.pick is None:
        models = [ColorModel.load(path) for path in marker.colors]
        color = functools.reduce(operator.or_, models)
    else:
        x, y, index = parse_pick(marker.pick, "--marker-pick")
        frame, ahead = _frame_of(source, video, target.frame if index is None else index, ahead)
        color = ColorModel.pick(frame.image, x, y)
    return msgspec.structs.replace(target, color=target.color | color), color, ahead


def _frame_of(source: str, video: Video, index: int, ahead: tuple[Frame, ...]) -> tuple[Frame, tuple[Frame, ...]]:
    """Take the frame in which a marker was clicked; of a live source, that of the ball if it is late enough."""
    if not video.live:
        with Video(source) as look:
            return frame_at(look, index), ahead
    if ahead and ahead[-1].index >= index:
        return ahead[-1], ahead
    frame = frame_at(video, index)
    return frame, (*ahead, frame)
