"""Real balls without what holds them, and real backgrounds without balls: `cutouts`, `Background`."""

import os
from functools import cache
from pathlib import Path
from typing import NamedTuple

import cv2
import numpy as np
import numpy.typing as npt

from matchset.app.track.score import read_truth

Floats = npt.NDArray[np.float32]
Bytes = npt.NDArray[np.uint8]

ROOT = Path(__file__).resolve().parents[3]
VARIABLE = "MATCHSET_REAL_DATA"  # names another folder with real clips
LABELS = ROOT / "benchmarks" / "real" / "labels"
WIDTH, HEIGHT = 640, 480
RADIUS = 40.0  # of a ball in its cut-out, px
SIDE = 104  # of a cut-out, px
WHOLE = {"green": 0.93, "yellow": 0.93, "red": 0.93, "lime": 0.85, "cyan": 0.75}
"""Share of the radius within which pixels are the ball's alone: less where it is blurred."""
SPREADS = (1.5, 4.0, 10.0, 25.0)  # px: hidden parts take the color of what is so near


class Ball(NamedTuple):
    """Where a real ball is cut out.

    Parameters
    ----------
    video : str
        In the folder with real clips.
    truth : str
        A file beside the video, or one of `benchmarks/real/labels`.
    frames : tuple of int
        Frames in which it is whole, but for what is told by its color.
    color : str
        "green", "cyan", "yellow", "red" or "lime".
    most : float
        Largest radius at which it is shown, px.
    gain : float
        By which it is made brighter.
    """

    video: str
    truth: str
    frames: tuple[int, ...]
    color: str
    most: float = 32.0
    gain: float = 1.0


MARBLED = "green_ball_hand/video.mp4"
BALLS = {
    "marbled": Ball(MARBLED, "green_ball_hand/truth.csv", (347, 366, 386, 692, 730, 749, 883), "green"),
    "dull": Ball("unlabelled/green_hand_a.mp4", "green_hand_a.csv", (80, 88, 164, 298, 340), "green", gain=1.4),
    "striped": Ball("unlabelled/green_hand_b.mp4", "green_hand_b.csv", (154, 224, 308, 322, 350), "green"),
    "yellow": Ball("yellow_occlusion/video.avi", "yellow_occlusion/truth.csv", (16, 18, 36, 38, 45, 48), "yellow"),
    "painted": Ball("unlabelled/green_throw.mp4", "green_throw.csv", (30, 31, 40, 41, 46), "cyan", 11.0),
    "bagged": Ball("unlabelled/red_pendulum.mp4", "red_pendulum.csv", (52, 154, 167, 206, 232, 245), "red"),
    "tennis": Ball("unlabelled/tennis_throw.mp4", "tennis_throw.csv", (11, 12, 14, 15, 16), "lime"),
}
TUNED = ("marbled", "dull", "striped", "yellow", "painted")
REPORTED = ("bagged", "tennis")


class Background(NamedTuple):
    """Real frames without balls.

    Parameters
    ----------
    file : str
        A video or a picture, in the folder with real clips.
    first, last : int
        Frames of a video, in which it goes to and fro.
    part : tuple of float
        Left, top and width of what is shown, as shares of the picture's width, height and width; 4 : 3.
    without : tuple of str
        Colors of balls that are not laid into it.
    rest : bool
        Take the median of the frames, in which a ball flies past, as a photograph.
    """

    file: str
    first: int = 0
    last: int = 0
    part: tuple[float, float, float] = (0.0, 0.0, 1.0)
    without: tuple[str, ...] = ()
    rest: bool = False


TUNED_BACKGROUNDS = (
    Background("stills/box.mp4", 0, 100, without=("yellow",)),
    Background("stills/box.mp4", 250, 350, without=("yellow",)),
    Background("green_ball_hand/video.mp4", 0, 20),
    Background("unlabelled/green_hand_a.mp4", 0, 50, (0.25, 0.0, 0.75)),
    Background("yellow_occlusion/video.avi", 25, 28, (0.1, 0.0, 0.75), without=("yellow",)),  # its leaves hide those
    Background("unlabelled/green_throw.mp4", 0, 18, (0.37, 0.0, 0.63)),
    Background("stills/stuff.jpg"),
)
REPORTED_BACKGROUNDS = (
    Background("unlabelled/green_thrown.mp4", 0, 10, (0.2, 0.0, 0.75)),
    Background("unlabelled/tennis_throw.mp4", 0, 26, (0.12, 0.1, 0.65), rest=True),
    Background("stills/skimage_coffee.png", without=("red",)),
    Background("stills/apriltag_33369213973_9d9bb4cc96_c.jpg", part=(0.0, 0.0, 0.88)),
    Background("stills/apriltag_34139872896_defdb2f8d9_c.jpg", part=(0.1, 0.0, 0.88)),
)


def folder() -> Path:
    """Return where the real clips should be."""
    return Path(os.environ.get(VARIABLE, str(ROOT.parent / "shared" / "data")))


def backdrop(background: Background) -> list[Bytes]:
    """Read the frames of a background, 640 x 480; one of a photograph.

    Raises
    ------
    FileNotFoundError
        If its file is not here.
    """
    path = folder() / background.file
    if path.suffix in (".mp4", ".avi"):
        whole = list(_frames(path, tuple(range(background.first, background.last + 1))).values())
    else:
        picture = cv2.imread(str(path))
        whole = [] if picture is None else [picture.astype(np.uint8)]
    if not whole:
        raise FileNotFoundError(f"no {path}: set {VARIABLE} to the folder with real clips")
    if background.rest:
        whole = [np.median(np.stack(whole[::2]), axis=0).astype(np.uint8)]
    return [_part(each, background.part) for each in whole]


def _part(picture: Bytes, part: tuple[float, float, float]) -> Bytes:
    height, width = picture.shape[:2]
    left, top = round(part[0] * width), round(part[1] * height)
    wide = min(part[2] * width, (height - top) * 4.0 / 3.0, width - left)
    shown = picture[top : top + round(wide * 0.75), left : left + round(wide)]
    way = cv2.INTER_AREA if shown.shape[1] > WIDTH else cv2.INTER_CUBIC
    return cv2.resize(shown, (WIDTH, HEIGHT), interpolation=way).astype(np.uint8)


@cache
def cutouts(name: str) -> tuple[Floats, ...]:
    """Cut a ball out of its frames: squares of `SIDE` px, its center in the middle, filled beyond its outline.

    Parameters
    ----------
    name : str
        One of `BALLS`.

    Raises
    ------
    FileNotFoundError
        If its clip is not here.
    """
    ball = BALLS[name]
    truth = folder() / ball.truth if "/" in ball.truth else LABELS / ball.truth
    pictures = _frames(folder() / ball.video, ball.frames)
    circles = {row.frame: row.circle for row in read_truth(truth)}
    cut = []
    for frame in ball.frames:
        circle = circles[frame]
        assert circle is not None
        cut.append(_cut(pictures[frame], *circle, ball.color))
    return tuple(cut)


def _frames(path: Path, wanted: tuple[int, ...]) -> dict[int, Bytes]:
    if not path.exists():
        raise FileNotFoundError(f"no {path}: set {VARIABLE} to the folder with real clips")
    video = cv2.VideoCapture(str(path))
    found: dict[int, Bytes] = {}
    for number in range(max(wanted) + 1):
        ok, picture = video.read()
        if not ok:
            break
        if number in wanted:
            found[number] = picture.astype(np.uint8)
    video.release()
    return found


def _cut(picture: Bytes, x: float, y: float, radius: float, color: str) -> Floats:
    """Cut a disc out; fingers and what else hides it, and all beyond it, take the color of what is near."""
    scale, middle = RADIUS / radius, (SIDE - 1) / 2.0
    soft = cv2.GaussianBlur(picture, (0, 0), 0.4 / scale) if scale < 0.8 else picture
    matrix = np.array(((scale, 0.0, middle - scale * x), (0.0, scale, middle - scale * y)))
    square = cv2.warpAffine(soft, matrix, (SIDE, SIDE), flags=cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE)
    cut = square.astype(np.float32)
    rows, columns = np.indices((SIDE, SIDE))
    far = np.hypot(columns - middle, rows - middle) / RADIUS
    own = (far < WHOLE[color]) & ~_foreign(cut, far, color)
    filled, missing = cut.copy(), ~own
    for spread in SPREADS:
        weight = cv2.GaussianBlur(own.astype(np.float32), (0, 0), spread)
        color_near = cv2.GaussianBlur(cut * own[:, :, np.newaxis], (0, 0), spread)
        enough = missing & (weight > 0.02)
        filled[enough] = (color_near / np.maximum(weight, 1e-6)[:, :, np.newaxis])[enough]
        missing &= ~enough
    seam = cv2.GaussianBlur((~own).astype(np.float32), (0, 0), 1.5)[:, :, np.newaxis]
    blurred = cv2.GaussianBlur(filled, (0, 0), 1.5)
    return np.asarray(filled + np.minimum(2.0 * seam, 1.0) * (blurred - filled), np.float32)


def _foreign(cut: Floats, far: npt.NDArray[np.float64], color: str) -> npt.NDArray[np.bool_]:
    """Pixels of a disc that are not the ball's, with some around them."""
    blue, green, red = (cv2.GaussianBlur(cut[:, :, channel], (0, 0), 1.0) for channel in range(3))
    if color == "green":
        other = (red > green - 4.0) & (far > 0.55)
    elif color == "yellow":
        other = ((green < 0.55 * red) | (np.minimum(red, green) - blue < 45.0)) & (far > 0.45)
    else:
        other = np.zeros(far.shape, bool)
    return np.asarray(cv2.dilate(other.astype(np.uint8), np.ones((5, 5), np.uint8)) > 0)
