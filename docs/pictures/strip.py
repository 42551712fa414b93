"""Draw the picture of the README: `python docs/pictures/strip.py`, from the root of the repository."""

from pathlib import Path

import numpy as np
import numpy.typing as npt
from PIL import Image

import matchset as ms
from matchset.app.drawing.contact_sheet import SheetFrame, rim_tile, whole_tile
from matchset.app.track.score import error_px
from matchset.sim.clips.clip import Clip

TILE, GAP = 262, 10  # px
COLORS = 240  # of the palette: few enough to keep the file small
CLIPS = (
    (Clip(preset="typical", seed=100), (57, 130)),
    (Clip.hard(seed=101), (10, 106)),
)


def shots(clip: Clip, wanted: tuple[int, ...]) -> list[SheetFrame]:
    """Follow the ball of a clip from one click; keep some frames, their answers and errors."""
    tracker: ms.Tracker[ms.Circle] | None = None
    kept = []
    for frame, truth in clip:
        if tracker is None:
            color = ms.ColorModel.pick(frame.image, *clip.first_click)
            tracker = ms.Tracker(ms.Circle, color, start=clip.first_click)
        answer = tracker.update(frame)
        if frame.index in wanted:
            seen, true = answer.shape if isinstance(answer, ms.Track) else None, truth.circle
            error = None
            if seen is not None and true is not None:
                error = error_px((seen.x, seen.y, seen.radius), (true.x, true.y, true.radius))
            kept.append(SheetFrame(frame, answer, error))
        if frame.index >= max(wanted):
            break
    return kept


def column(shot: SheetFrame) -> npt.NDArray[np.uint8]:
    """Show the whole frame, and below it the enlarged ball with its match-set."""
    tile = np.vstack([whole_tile(shot, TILE), rim_tile(shot, TILE)])
    return np.pad(tile, ((GAP, 0), (GAP, GAP), (0, 0)), constant_values=255)


def main() -> None:
    """Write docs/pictures/strip.png."""
    strip = np.hstack([column(shot) for clip, wanted in CLIPS for shot in shots(clip, wanted)])
    picture = Image.fromarray(strip[..., ::-1]).quantize(COLORS, dither=Image.Dither.NONE)
    path = Path(__file__).with_name("strip.png")
    picture.save(path, optimize=True)
    print(f"{path}: {path.stat().st_size // 1000} kB")


if __name__ == "__main__":
    main()
