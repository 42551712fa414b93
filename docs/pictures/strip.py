"""Draw the picture of ARCHITECTURE.md: `python docs/pictures/strip.py`, from the root of the repository."""

from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

import matchset as ms
from matchset.app.drawing.contact_sheet import LETTERS_PX, SheetFrame, label, rim_tile, whole_tile
from matchset.app.track.score import error_px
from matchset.sim.clips.clip import Clip

TILE, GAP, LETTERS = 262, 10, 22  # px; to be read where the strip is as wide as a phone
QUALITY = 88  # WebP
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
    whole, rim = (tile[: -2 * LETTERS_PX] for tile in (whole_tile(shot, TILE), rim_tile(shot, TILE)))
    points = len(shot.answer.match_set) if isinstance(shot.answer, ms.Track) else 0
    words = (f"error {shot.error_px:.2f} px", f"{points} edge points")
    above, below = (label(each, TILE, LETTERS) for each in words)
    return np.pad(np.vstack([whole, above, rim, below]), ((GAP, 0), (GAP, GAP), (0, 0)), constant_values=255)


def main() -> None:
    """Write docs/pictures/strip.webp."""
    strip = np.hstack([column(shot) for clip, wanted in CLIPS for shot in shots(clip, wanted)])
    path = Path(__file__).with_name("strip.webp")
    cv2.imwrite(str(path), strip, [cv2.IMWRITE_WEBP_QUALITY, QUALITY])
    print(f"{path}: {path.stat().st_size // 1000} kB")


if __name__ == "__main__":
    main()
