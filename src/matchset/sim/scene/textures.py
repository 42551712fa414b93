"""Pictures for the surfaces of a room: planks, plaster, books, posters, a window."""

import cv2
import numpy as np
import numpy.typing as npt

from matchset.sim.clips.balloon import Color

Random = np.random.Generator
Picture = npt.NDArray[np.float32]
Texture = npt.NDArray[np.uint8]

# format: colors, BGR; the balloon's blue and the marker's purple are left out on purpose
PAINTS: tuple[Color, ...] = (
    (38, 62, 196),
    (44, 120, 226),
    (60, 178, 232),
    (74, 140, 92),
    (96, 168, 148),
    (150, 196, 206),
    (58, 88, 150),
    (64, 66, 74),
    (206, 214, 222),
    (112, 132, 190),
    (92, 118, 60),
    (120, 156, 186),
)


def plain(height: int, width: int, color: Color) -> Picture:
    """Return a picture of one color, float32 BGR of shape (height, width, 3)."""
    return np.full((height, width, 3), color, np.float32)


def texture(picture: Picture) -> Texture:
    """Make a picture an opaque BGRA texture of bytes."""
    opaque = np.full((*picture.shape[:2], 4), 255, np.uint8)
    opaque[..., :3] = np.clip(picture, 0.0, 255.0)
    return opaque


def cloud(rng: Random, height: int, width: int, grain: int) -> Picture:
    """Smooth random field of shape (height, width, 1), deviation about 1, with spots of `grain` px."""
    small = rng.standard_normal((max(height // grain, 2), max(width // grain, 2))).astype(np.float32)
    smooth = cv2.resize(small, (width, height), interpolation=cv2.INTER_CUBIC)
    return np.asarray(smooth, dtype=np.float32)[..., None]


def plaster(rng: Random, height: int, width: int, color: Color) -> Picture:
    """Painted wall: color, blotches, fine grain; `height`, `width` in px."""
    blotches = 1.0 + 0.012 * cloud(rng, height, width, 50) + 0.008 * cloud(rng, height, width, 3)
    return np.asarray(blotches * np.array(color, np.float32), dtype=np.float32)


def planks(rng: Random, height: int, width: int, color: Color, board: int) -> Picture:
    """Wooden floor: boards of `board` px width that run down the picture, staggered, each of its own tone."""
    floor = plain(height, width, color)
    for left in range(0, width, board):
        top = -int(rng.integers(0, height // 2 + 1))
        while top < height:
            bottom = top + int(rng.integers(height // 3, height // 2 + 2))
            part = (slice(max(top, 0), bottom), slice(left, left + board))
            floor[part] *= np.float32(rng.normal(1.0, 0.07)) * np.array(rng.normal(1.0, 0.012, 3), np.float32)
            if 0 <= top < height:
                floor[top : top + 2, left : left + board] *= np.float32(0.7)
            top = bottom
        floor[:, left] *= np.float32(0.62)
    streaks = cv2.resize(rng.standard_normal((max(height // 24, 2), width)).astype(np.float32), (width, height))[
        ..., None
    ]
    floor *= 1.0 + 0.035 * streaks
    return floor


def wood(rng: Random, height: int, width: int, color: Color) -> Picture:
    """Board with a grain along its longer side."""
    across = height > width
    shape = (max(height // 20, 2), width) if across else (height, max(width // 20, 2))
    grain = cv2.resize(rng.standard_normal(shape).astype(np.float32), (width, height))[..., None]
    return plain(height, width, color) * (1.0 + 0.05 * grain)


def books(rng: Random, height: int, width: int, shelves: int) -> Picture:
    """Front of a bookcase: dark niches full of books in all colors but blue, between boards."""
    tone = np.array((82, 118, 156), np.float32) * np.float32(rng.uniform(0.6, 1.15))
    front = wood(rng, height, width, tuple(tone.tolist()))
    board = max(height // (shelves * 12), 3)
    for i in range(shelves):
        top, bottom = (
            i * height // shelves + board,
            (i + 1) * height // shelves - (board if i == shelves - 1 else 0),
        )
        front[top:bottom, board : width - board] = np.array((34, 40, 48), np.float32)
        x = board + 2
        while x < width - board - 6:
            thick = int(rng.integers(5, 15))
            if rng.random() < 0.1:
                x += int(rng.integers(10, 40))
                continue
            tall = int((bottom - top) * rng.uniform(0.6, 0.94))
            paint = np.array(PAINTS[rng.integers(len(PAINTS))], np.float32) * np.float32(rng.uniform(0.55, 1.0))
            right = min(x + thick, width - board)
            ramp = np.linspace(0.75, 1.05, right - x, dtype=np.float32)[None, :, None]
            front[bottom - tall : bottom, x:right] = paint * ramp
            band = bottom - int(tall * rng.uniform(0.6, 0.85))
            front[band : band + 4, x:right] = paint * np.float32(0.4) + np.float32(120.0)
            x = right + 1
        front[top : top + 8, board : width - board] *= np.float32(0.55)
    return front


def poster(rng: Random, height: int, width: int) -> Picture:
    """Abstract print with a white margin and a dark frame."""
    kinds = np.array(PAINTS, np.float32)
    ground, first, second = kinds[rng.permutation(len(kinds))[:3]]
    art = plain(height, width, tuple((0.35 * ground + 150.0).tolist()))
    kind = rng.integers(3)
    if kind == 0:
        for i in range(4):
            level = int(height * (0.35 + 0.16 * i))
            x = np.linspace(0.0, width, 12)
            y = level + rng.normal(0.0, 0.05 * height, 12)
            outline = np.concatenate((np.column_stack((x, y)), [[width, height], [0, height]]))
            mix = first + (second - first) * np.float32(i / 3.0)
            cv2.fillPoly(art, [outline.astype(np.int32)], mix.tolist(), cv2.LINE_AA)
        sun = (int(width * rng.uniform(0.3, 0.7)), int(height * 0.24))
        cv2.circle(art, sun, width // 9, (70.0, 170.0, 240.0), -1, cv2.LINE_AA)
    elif kind == 1:
        for _ in range(9):
            corner = rng.uniform(0.0, 1.0, 2) * (width, height)
            size = rng.uniform(0.1, 0.45, 2) * (width, height)
            color = (first if rng.random() < 0.5 else second) * np.float32(rng.uniform(0.7, 1.2))
            low, high = corner.astype(int).tolist(), (corner + size).astype(int).tolist()
            cv2.rectangle(art, low, high, color.tolist(), -1)
    else:
        for i in range(7, 0, -1):
            color = first if i % 2 else second
            axes = (width * i // 16, height * i // 18)
            cv2.ellipse(art, (width // 2, height // 2), axes, 20.0 * i, 0, 360, color.tolist(), -1, cv2.LINE_AA)
    margin = max(min(height, width) // 12, 3)
    cv2.rectangle(art, (0, 0), (width - 1, height - 1), (232.0, 238.0, 240.0), 2 * margin)
    cv2.rectangle(art, (0, 0), (width - 1, height - 1), (40.0, 44.0, 52.0), max(margin // 2, 2))
    return art


def window(height: int, width: int) -> Picture:
    """Window with four panes before a bright white sky and distant trees."""
    sky = np.linspace(255.0, 236.0, height, dtype=np.float32)[:, None, None]
    panes = np.repeat(sky * np.array((0.99, 0.985, 0.97), np.float32), width, axis=1)
    horizon = int(height * 0.72)
    x = np.arange(width)
    edge = horizon + 0.03 * height * (np.sin(x / 17.0) + np.sin(x / 7.3 + 1.0))
    trees = np.arange(height)[:, None] > edge[None, :]
    panes[trees] = np.array((150, 176, 160), np.float32)
    bar, color = max(width // 22, 3), (226.0, 232.0, 234.0)
    cv2.rectangle(panes, (0, 0), (width - 1, height - 1), color, 2 * bar)
    cv2.line(panes, (width // 2, 0), (width // 2, height), color, bar)
    cv2.line(panes, (0, height * 2 // 5), (width, height * 2 // 5), color, bar)
    return panes


def framed(panel: Picture, border: int, color: Color) -> Picture:
    """Return a picture with a border of `border` px in one color drawn over its edge."""
    framed_panel = panel.copy()
    cv2.rectangle(framed_panel, (0, 0), (panel.shape[1] - 1, panel.shape[0] - 1), color, border)
    return framed_panel


def leaves(rng: Random, height: int, width: int) -> Texture:
    """House plant without its pot, on a transparent ground."""
    plant = np.zeros((height, width, 4), np.uint8)
    plant[..., :3] = (46, 98, 58)
    for _ in range(46):
        angle = rng.uniform(-1.25, 1.25)
        reach = rng.uniform(0.35, 0.95) * height
        root = np.array([width / 2.0, height * 0.98])
        tip = root + reach * np.array([np.sin(angle) * 0.62, -np.cos(angle)])
        middle = 0.5 * (root + tip) + reach * 0.12 * np.array([0.0, -1.0])
        tone = rng.uniform(0.55, 1.25)
        color = (40 * tone, 120 * tone, 64 * tone, 255)
        stem = np.array([root, middle, tip], np.int32)
        cv2.polylines(plant, [stem], False, color, max(width // 90, 1), cv2.LINE_AA)
        blade = (0.16 * reach, 0.055 * reach)
        center = (float(tip[0]), float(tip[1]))
        cv2.ellipse(plant, (center, (2 * blade[0], 2 * blade[1]), np.degrees(angle) - 90.0), color, -1, cv2.LINE_AA)
    return plant
