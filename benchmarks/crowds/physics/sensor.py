"""What a cheap camera makes of light: `Sensor`."""

import cv2
import numpy as np
import numpy.typing as npt

from benchmarks.crowds.physics.camera import GAMMA, HEIGHT, WIDTH, Light

WHITE = 16383.0  # largest number of a pixel before the colors are found
FULL = 9000.0  # electrons that fill a pixel, at the lowest gain


class Sensor:
    """A camera's lens, sensor and coder, with faults that a seed decides.

    Parameters
    ----------
    random : Generator
    """

    def __init__(self, random: np.random.Generator) -> None:
        self._gain = float(np.exp(random.uniform(0.0, 2.2)))  # 1 to 9: a dim room
        self._full = FULL / self._gain
        self._read = float(random.uniform(3.0, 9.0))  # electrons
        self._blur = float(random.uniform(0.5, 1.1))  # px
        self._balance = np.array([random.uniform(0.85, 1.15), 1.0, random.uniform(0.88, 1.12)], np.float32)
        self._exposure = float(random.uniform(0.95, 1.35))
        self._flicker = float(random.choice([0.0, 0.02, 0.05]))
        self._sharpening = float(random.choice([0.0, 0.4, 0.8]))
        self._quality = int(random.integers(70, 86))
        self._contrast = float(random.uniform(0.9, 1.15))
        rows, columns = np.indices((HEIGHT, WIDTH), np.float32)
        far = np.hypot(columns - WIDTH / 2.0, rows - HEIGHT / 2.0) / np.hypot(WIDTH / 2.0, HEIGHT / 2.0)
        self._vignette = (1.0 - random.uniform(0.1, 0.4) * far**2).astype(np.float32)[..., np.newaxis]
        self._fixed = random.normal(1.0, 0.006, (HEIGHT, WIDTH)).astype(np.float32)
        blue_first, first_row = (bool(each) for each in random.integers(0, 2, 2))
        self._corner = (int(blue_first), int(first_row))

    def coded(self, light: Light, index: int, random: np.random.Generator) -> npt.NDArray[np.uint8]:
        """Return the bytes of a frame, as JPEG, of linear light, 1 = white.

        Parameters
        ----------
        light : (HEIGHT, WIDTH, 3) float32
            Blue, green, red.
        index : int
            Number of the frame; lamps flicker with it.
        random : Generator
            Decides the noise.
        """
        light = cv2.GaussianBlur(light, (0, 0), self._blur) * self._vignette
        light *= self._exposure * (1.0 + self._flicker * np.sin(2.1 * index))
        image = self._mosaic(light / self._balance, random) * self._balance * self._balance
        shown = np.clip(image, 0.0, 1.0) ** (self._contrast / GAMMA)
        if self._sharpening:
            shown = shown + self._sharpening * (shown - cv2.GaussianBlur(shown, (0, 0), 1.2))
        picture = np.clip(255.0 * shown + 0.5, 0.0, 255.0).astype(np.uint8)
        good, coded = cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, self._quality])
        if not good:
            raise RuntimeError("OpenCV cannot code JPEG")
        return np.asarray(coded, np.uint8).ravel()

    def _mosaic(self, light: Light, random: np.random.Generator) -> Light:
        """See one color a pixel, with shot noise, and guess the two others."""
        across, down = self._corner
        raw = light[..., 1].copy()
        raw[down::2, across::2] = light[down::2, across::2, 0]
        raw[1 - down :: 2, 1 - across :: 2] = light[1 - down :: 2, 1 - across :: 2, 2]
        electrons = random.poisson(np.maximum(raw * self._fixed * self._full, 0.0)).astype(np.float32)
        electrons += random.normal(0.0, self._read, electrons.shape).astype(np.float32)
        numbers = np.clip(electrons / self._full * (WHITE / 2.0) + 64.0, 0.0, 65535.0).astype(np.uint16)
        code = {
            (0, 0): cv2.COLOR_BayerRGGB2RGB,
            (1, 1): cv2.COLOR_BayerBGGR2RGB,
            (1, 0): cv2.COLOR_BayerGRBG2RGB,
            (0, 1): cv2.COLOR_BayerGBRG2RGB,
        }[self._corner]
        colors = cv2.cvtColor(numbers, code).astype(np.float32)
        return np.asarray(np.maximum((colors - 64.0) / (WHITE / 2.0), 0.0), np.float32)
