"""Pictures of boards with exact truth: every pixel of a picture is looked up on the board along its own ray."""

from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

import matchset as ms
from matchset.camera.board import Board, BoardView

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]

SAMPLES = 2
SQUARE_PX = 48
_NO_MAP: Any = None


class BoardCamera:
    """A camera before which boards are held."""

    def __init__(self, camera: ms.CameraModel, board: Board) -> None:
        self.camera, self.board = camera, board
        self._texture = board.picture(SQUARE_PX)
        steps = (np.arange(SAMPLES) + 0.5) / SAMPLES - 0.5
        x = (np.arange(camera.width)[:, None] + steps).ravel()
        y = (np.arange(camera.height)[:, None] + steps).ravel()
        self._rays = camera.rays(np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2))
        self._shape = len(y), len(x)

    def picture(
        self, rotation: Rotation, position: npt.ArrayLike, noise: float = 2.0, blur: float = 0.6, seed: int = 0
    ) -> Image:
        """The board with its middle at `position` (m, camera frame), turned by `rotation`."""
        axes = rotation.as_matrix()
        middle = np.array([self.board.columns - 1, self.board.rows - 1, 0.0]) * 0.5 * self.board.square
        corner = np.asarray(position, np.float64) - axes @ middle
        normal = axes[:, 2]
        with np.errstate(divide="ignore", invalid="ignore"):
            depth = (normal @ corner) / (self._rays @ normal)
            on_board = (depth[:, None] * self._rays - corner) @ axes[:, :2]
        hidden = ~((depth > 0.0) & (self._rays[:, 2] > 0.0))
        # The first inner corner lies between the pixels 2 SQUARE_PX - 1 and 2 SQUARE_PX of the texture.
        texels = on_board / self.board.square * SQUARE_PX + 2.0 * SQUARE_PX - 0.5
        texels[hidden] = -1e6
        maps = np.clip(texels, -1e6, 1e6).astype(np.float32).reshape(*self._shape, 2)
        fine = cv2.remap(self._texture, maps, _NO_MAP, cv2.INTER_LINEAR, borderValue=120.0)
        image = cv2.resize(fine, (self.camera.width, self.camera.height), interpolation=cv2.INTER_AREA)
        soft = cv2.GaussianBlur(image.astype(np.float32) * 0.8 + 20.0, (0, 0), blur) if blur else image
        noisy = soft + np.random.default_rng(seed).normal(0.0, noise, image.shape)
        return np.asarray(np.clip(np.rint(noisy), 0, 255), np.uint8)


def seen_corners(camera: ms.CameraModel, board: Board, rotation: Rotation, position: npt.ArrayLike) -> Floats:
    """Where the board's inner corners are seen, px."""
    column, row = np.meshgrid(np.arange(board.columns), np.arange(board.rows))
    places = np.column_stack((column.ravel(), row.ravel(), np.zeros(column.size)))
    middle = np.array([board.columns - 1, board.rows - 1, 0.0]) * 0.5
    return camera.project(rotation.apply((places - middle) * board.square) + np.asarray(position))


def poses(camera: ms.CameraModel, board: Board, count: int, seed: int) -> list[tuple[Rotation, Floats]]:
    """Poses as a person holds a board: all over the picture, tilted by up to 40 degrees, its corners in the picture."""
    rng = np.random.default_rng(seed)
    width = board.columns * board.square * camera.fx / camera.width
    found: list[tuple[Rotation, Floats]] = []
    while len(found) < count:
        tilt = np.deg2rad(rng.uniform((-40.0, -40.0, -30.0), (40.0, 40.0, 30.0)))
        depth = rng.uniform(1.2, 2.4) * width
        pixel = rng.uniform((0.0, 0.0), (camera.width, camera.height))
        (ray,) = camera.rays([pixel])
        pose = Rotation.from_euler("xyz", tilt), ray / max(ray[2], 0.3) * depth
        try:
            seen = seen_corners(camera, board, *pose)
        except ValueError:
            continue
        if (seen > 8.0).all() and (seen < np.array([camera.width, camera.height]) - 9.0).all():
            found.append(pose)
    return found


def exact_view(
    camera: ms.CameraModel, board: Board, pose: tuple[Rotation, Floats], index: int, noise: float
) -> BoardView:
    """A view without a picture: the true corners with some noise, px."""
    column, row = np.meshgrid(np.arange(board.columns), np.arange(board.rows))
    places = np.asarray(np.column_stack((column.ravel(), row.ravel(), np.zeros(column.size))) * board.square, float)
    pixels = seen_corners(camera, board, *pose)
    pixels = pixels + np.random.default_rng(index).normal(0.0, noise, pixels.shape)
    return BoardView(np.arange(len(places)), places, pixels, 1.0, index)
