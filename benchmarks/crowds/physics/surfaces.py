"""What is painted on things, blue, green, red: `wood`, `cloth`, `paper`, `bricks`, `marked`."""

import cv2
import numpy as np
import numpy.typing as npt

from benchmarks.crowds.physics.world import Bytes, Color, Floats

COLORS: dict[str, Color] = {
    "orange": (245, 115, 20),
    "red": (190, 28, 30),
    "yellow": (235, 195, 35),
    "green": (35, 140, 60),
    "blue": (35, 80, 190),
    "white": (235, 232, 225),
    "pink": (240, 130, 165),
    "purple": (105, 45, 130),
    "brown": (105, 62, 35),
    "black": (28, 28, 30),
}


def wood(random: np.random.Generator, color: Color, planks: int = 5, contrast: float = 0.22) -> Bytes:
    """Paint planks along the columns, each with a shade and a grain of its own."""
    size = 768
    value = np.zeros((size, size))
    for band in np.array_split(np.arange(size), planks):
        rows, columns = np.meshgrid(band, np.arange(size), indexing="ij")
        wave = 12.0 * _clouds(random, size, 3)[: len(band)]
        rings = np.sin((rows + wave) / random.uniform(2.5, 6.0) + columns * random.uniform(-0.004, 0.004))
        grain = cv2.blur(random.normal(0.0, 1.0, rings.shape), (61, 1)) * 6.0
        value[band] = 0.4 * rings + 0.4 * grain + random.normal(0.0, 0.7)
        value[band[:2]] = -4.0
    return _painted(color, 1.0 + contrast * 0.5 * value)


def cloth(random: np.random.Generator, color: Color) -> Bytes:
    """Paint fine fibers, with stains."""
    size = 768
    fibers = cv2.GaussianBlur(random.normal(0.0, 1.0, (size, size)), (0, 0), 0.9) * 0.12
    return _painted(color, 1.0 + fibers + 0.08 * _clouds(random, size, 6))


def paper(random: np.random.Generator, color: Color) -> Bytes:
    """Paint a pale surface with stains, scratches and a few lines."""
    size = 768
    image = _painted(color, 1.0 + 0.05 * _clouds(random, size, 8) + random.normal(0.0, 0.02, (size, size)))
    for _ in range(14):
        begin, end = (tuple(int(each) for each in random.integers(0, size, 2)) for _ in range(2))
        tone = float(random.uniform(0.7, 0.95))
        shade = tuple(int(tone * each) for each in color[::-1])
        cv2.line(image, begin, end, shade, int(random.integers(1, 4)), cv2.LINE_AA)
    return image


def bricks(random: np.random.Generator, color: Color, rows: int = 14) -> Bytes:
    """Paint a wall of bricks, each of a shade of its own."""
    size = 768
    image = _painted((190, 185, 175), 1.0 + random.normal(0.0, 0.05, (size, size)))
    high, wide = size / rows, 2.0 * size / rows
    rough = 1.0 + 0.1 * _clouds(random, size, 40) + random.normal(0.0, 0.05, (size, size))
    for row in range(rows):
        for column in range(-1, rows // 2 + 1):
            left, top = (column + 0.5 * (row % 2)) * wide, row * high
            x0, x1 = (int(np.clip(each, 0, size)) for each in (left + 3, left + wide - 3))
            y0, y1 = int(top) + 3, int(top + high) - 3
            if x1 > x0:
                shade = rough[y0:y1, x0:x1] * random.uniform(0.7, 1.2)
                image[y0:y1, x0:x1] = _painted(color, shade)
    return image


def marked(random: np.random.Generator, color: Color, marks: int) -> Bytes:
    """Paint a ball's skin: slightly dirty, with dark marks that show how it turns."""
    rows, columns = 128, 256
    image = _painted(color, 1.0 + 0.05 * _clouds(random, columns, 6)[:rows])
    for _ in range(marks):
        middle = (int(random.integers(20, columns - 20)), int(random.integers(30, rows - 30)))
        shade = tuple(int(0.55 * each) for each in color[::-1])
        cv2.ellipse(image, middle, (int(random.integers(5, 12)), 4), 0.0, 0.0, 360.0, shade, -1, cv2.LINE_AA)
    return image


def _painted(color: Color, shade: Floats) -> Bytes:
    values = np.array(color[::-1], float) * np.maximum(shade, 0.05)[..., np.newaxis]
    return np.asarray(np.clip(values, 0.0, 255.0), np.uint8)


def _clouds(random: np.random.Generator, size: int, cells: int) -> npt.NDArray[np.float64]:
    """Smooth noise of unit deviation."""
    rough = random.normal(0.0, 1.0, (cells + 2, cells + 2))
    smooth = cv2.resize(rough, (size, size), interpolation=cv2.INTER_CUBIC)
    return np.asarray(smooth / max(float(smooth.std()), 1e-9), float)
