"""What a lens that distorts makes of a picture: `LensView`."""

import math

import cv2
import numpy as np
import numpy.typing as npt

from matchset.camera.camera_model import CameraModel
from matchset.sim.rendering.renderer import Picture

_FINER = 2.0  # the pinhole picture has so many pixels for one of the camera's, along x and along y
_SAMPLES = 3  # places per pixel, along x and along y
_WIDEST = 1.5  # largest |X / Z| that is rendered


class LensView:
    """Sees a scene through a camera's lens: rendered by a finer and wider pinhole camera, then bent.

    Every pixel is the mean of 3 x 3 bilinear samples of the pinhole picture. Where the lens has no direction the
    picture is black. Without distortion the pinhole camera is the camera, and nothing is bent.

    Parameters
    ----------
    camera : CameraModel
        Whose lens it is.

    Attributes
    ----------
    pinhole : CameraModel
        The camera to render with.
    """

    def __init__(self, camera: CameraModel) -> None:
        self.camera, self.pinhole = camera, camera
        self._maps: list[tuple[npt.NDArray[np.float32], npt.NDArray[np.float32]]] = []
        if any(camera.distortion):
            self._plan()

    def _plan(self) -> None:
        shape = self.camera.height, self.camera.width
        rows, columns = np.indices(shape).reshape(2, -1).astype(np.float64)
        rays = self.camera.rays(np.column_stack((columns, rows)))
        with np.errstate(invalid="ignore"):
            slopes = [(rays[:, k] / rays[:, 2]).reshape(shape) for k in range(2)]
        right, below = (min(float(np.nanmax(np.abs(slope))), _WIDEST) for slope in slopes)
        focal = _FINER * self.camera.fx
        width, height = 2 * math.ceil(focal * right) + 8, 2 * math.ceil(focal * below) + 8
        self.pinhole = CameraModel(
            width=width, height=height, fx=focal, fy=focal, cx=(width - 1) / 2.0, cy=(height - 1) / 2.0
        )
        shifts = (np.arange(_SAMPLES) + 0.5) / _SAMPLES - 0.5
        bends = [np.gradient(slope) for slope in slopes]
        for down in shifts:
            for across in shifts:
                places = [
                    focal * (slope + down * bend[0] + across * bend[1]) + center
                    for slope, bend, center in zip(slopes, bends, (self.pinhole.cx, self.pinhole.cy), strict=True)
                ]
                maps = [np.nan_to_num(place, nan=-1e4).astype(np.float32) for place in places]
                self._maps.append((maps[0], maps[1]))

    def bend(self, picture: Picture) -> Picture:
        """Bend a picture of the pinhole camera.

        Parameters
        ----------
        picture : ndarray of shape (h, w, 3), float32
            Of the size of `pinhole`; unchanged.

        Returns
        -------
        ndarray of shape (h, w, 3), float32
            Of the size of the camera.
        """
        if not self._maps:
            return picture
        total = np.zeros((self.camera.height, self.camera.width, 3), np.float32)
        for x, y in self._maps:
            total += cv2.remap(picture, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT)
        return np.asarray(total / np.float32(len(self._maps)), np.float32)
