"""Draw a real ball that moves, and what was found: `python docs/pictures/real.py FOLDER`, the folder of the clips.

The clip is somebody else's, under the MIT license; `CLIP` says whose. It is not part of the repository.
"""

import sys
from pathlib import Path

import cv2
import msgspec
import numpy as np
import numpy.typing as npt
from PIL import Image

import matchset as ms
from matchset.app.drawing.annotate import center_of, draw_answer
from matchset.app.drawing.text import draw_text, text_width
from matchset.app.drawing.trail import Trail

Picture = npt.NDArray[np.uint8]

EVERY = 2  # pictures of the clip
HEIGHT, LETTERS, STRIP = 360, 18, 30  # px
QUALITY, METHOD = 55, 6  # WebP
LARGEST = 400_000  # bytes


class Clip(msgspec.Struct, frozen=True):
    """A clip: its file, the click with its frame, and the last frame to show."""

    file: str
    first: int
    click: tuple[int, int]
    last: int


# github.com/trflorian/ball-tracking-live-plot, MIT
CLIP = Clip("green_ball_hand/video.mp4", 60, (427, 146), 200)


def main() -> None:
    """Write docs/pictures/real.webp."""
    pictures, rate = follow(Path(sys.argv[1]), CLIP)
    path = Path(__file__).with_name("real.webp")
    first, *others = [Image.fromarray(np.ascontiguousarray(each[..., ::-1])) for each in pictures]
    times = np.round(1000.0 * EVERY / rate * np.arange(len(pictures) + 1))
    shown_ms = np.diff(times).astype(int).tolist()
    first.save(path, save_all=True, append_images=others, duration=shown_ms, loop=0, quality=QUALITY, method=METHOD)
    size = path.stat().st_size
    print(f"{path}: {len(pictures)} pictures, {size // 1000} kB")
    if size > LARGEST:
        raise SystemExit(f"more than {LARGEST // 1000} kB: lower QUALITY")


def follow(folder: Path, clip: Clip) -> tuple[list[Picture], float]:
    """Follow the ball from the click; return what is shown, with outline, trail and numbers, and the rate."""
    tracker, trail, pictures = None, Trail(), []
    with ms.Video(str(folder / clip.file)) as video:
        rate = video.fps or 30.0
        for frame in video:
            if frame.index < clip.first:
                continue
            if tracker is None:
                color = ms.ColorModel.pick(frame.image, *clip.click)
                tracker = ms.Tracker(ms.Circle, color, start=clip.click)
            answer = tracker.update(frame)
            trail.append(center_of(answer))
            if (frame.index - clip.first) % EVERY == 0:
                image = frame.image.copy()
                trail.draw(image)
                draw_answer(image, answer)
                pictures.append(labeled(image, answer))
            if frame.index == clip.last:
                break
    return pictures, rate


def labeled(image: Picture, answer: ms.Track[ms.Circle] | ms.Lost[ms.Circle]) -> Picture:
    """Scale a picture, and write what was found below it."""
    width = round(HEIGHT * image.shape[1] / image.shape[0])
    small = cv2.resize(image, (width, HEIGHT), interpolation=cv2.INTER_AREA)
    if isinstance(answer, ms.Track):
        ball, sigma = answer.shape, answer.covariance.diagonal() ** 0.5
        words = f"x {ball.x:.1f}   y {ball.y:.1f}   radius {ball.radius:.1f} ± {sigma[2]:.1f} px"
    else:
        words = f"lost: {answer.reason}"
    strip = np.full((STRIP, width, 3), 32, np.uint8)
    draw_text(strip, words, (max((width - text_width(words, LETTERS)) // 2, 4), STRIP / 2), LETTERS)
    return np.vstack([small, strip])


if __name__ == "__main__":
    main()
