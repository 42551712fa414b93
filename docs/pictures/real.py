"""Draw real clips with what was found in them: `python docs/pictures/real.py FOLDER`, with the folder of the clips.

The clips are other people's, under the MIT license; `CLIPS` says whose. They are not part of the repository.
"""

import sys
from pathlib import Path

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

import matchset as ms
from matchset.app.drawing.annotate import draw_points, draw_shape

Picture = npt.NDArray[np.uint8]

HEIGHT, GAP, QUALITY = 330, 8, 80  # px; WebP


class Clip(msgspec.Struct, frozen=True):
    """A clip: its file, the click with its frame, the frame to show, and how wide a part of it around the ball."""

    file: str
    first: int
    click: tuple[int, int]
    shown: int
    aspect: float


CLIPS = (
    # github.com/trflorian/ball-tracking-live-plot, MIT
    Clip("green_ball_hand/video.mp4", 60, (427, 146), 130, 1.25),
    # github.com/akdenizz/ball_segmentation, MIT (c) 2022 Ayşe Nur Akdeniz
    Clip("yellow_occlusion/video.avi", 0, (909, 277), 43, 1.25),
)


def main() -> None:
    """Write docs/pictures/real.webp."""
    tiles = [tile(Path(sys.argv[1]), clip) for clip in CLIPS]
    gap = np.full((HEIGHT, GAP, 3), 255, np.uint8)
    row = np.hstack([each for pair in ((one, gap) for one in tiles) for each in pair][:-1])
    path = Path(__file__).with_name("real.webp")
    cv2.imwrite(str(path), row, [cv2.IMWRITE_WEBP_QUALITY, QUALITY])
    print(f"{path}: {path.stat().st_size // 1000} kB")


def tile(folder: Path, clip: Clip) -> Picture:
    """Follow the ball from the click to the frame to show; return that with the outline and its match-set."""
    tracker = None
    with ms.Video(str(folder / clip.file)) as video:
        for frame in video:
            if frame.index < clip.first:
                continue
            if tracker is None:
                color = ms.ColorModel.pick(frame.image, *clip.click)
                tracker = ms.Tracker(ms.Circle, color, start=clip.click)
            track = tracker.update(frame)
            if frame.index == clip.shown:
                break
    if not track:
        raise SystemExit(f"{clip.file}, frame {clip.shown}: {track.reason}")
    image = frame.image.copy()
    draw_points(image, track.match_set)
    draw_shape(image, track.shape)
    return cut(image, track.shape, clip.aspect)


def cut(image: Picture, ball: ms.Circle, aspect: float) -> Picture:
    """Cut a part of a picture with the ball in it, as high as the picture allows, and scale it."""
    high = min(image.shape[0], round(image.shape[1] / aspect), round(9.0 * ball.radius))
    wide = round(high * aspect)
    left = round(min(max(ball.x - wide / 2.0, 0.0), image.shape[1] - wide))
    top = round(min(max(ball.y - high / 2.0, 0.0), image.shape[0] - high))
    part = image[top : top + high, left : left + wide]
    return np.asarray(cv2.resize(part, (round(HEIGHT * aspect), HEIGHT), interpolation=cv2.INTER_AREA), np.uint8)


if __name__ == "__main__":
    main()
