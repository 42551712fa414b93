"""Calibration boards: chessboard and ChArUco, found in images to a fraction of a pixel."""

from typing import Any

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image.brightness import as_gray
from matchset.image.frame import Frame
from matchset.tracking.track import Lost

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]

DICTIONARIES = {name.removeprefix("DICT_").upper(): name for name in dir(cv2.aruco) if name.startswith("DICT_")}
"""The marker dictionaries that OpenCV has, by the names that `Board` takes."""

_QUICK = cv2.CALIB_CB_ADAPTIVE_THRESH | cv2.CALIB_CB_NORMALIZE_IMAGE | cv2.CALIB_CB_FAST_CHECK


class Board(msgspec.Struct, frozen=True, kw_only=True):
    """A flat board of squares.

    Parameters
    ----------
    columns, rows : int
        Inner corners, where four squares meet: a board of 10 x 7 squares has 9 x 6.
    square : float
        Side of a square, m.
    marker : float, optional
        Side of a marker, m: the board is a ChArUco board. None by default: a chessboard.
    dictionary : str, default "5X5_100"
        The markers' dictionary, one of `DICTIONARIES`.

    Raises
    ------
    ValueError
        If there are fewer than 3 x 3 corners or more than 100 x 100, a side is not positive, a marker does not fit into
        its square, or there is no such dictionary, or it has too few markers.
    """

    columns: int
    rows: int
    square: float
    marker: float | None = None
    dictionary: str = "5X5_100"

    def __post_init__(self) -> None:
        if not (3 <= self.columns <= 100 and 3 <= self.rows <= 100):
            raise ValueError(f"a board has 3 x 3 to 100 x 100 inner corners, got {self.columns} x {self.rows}")
        if not 0.0 < self.square < 100.0:
            raise ValueError(f"a square's side must be positive, in m, got {self.square}")
        if self.marker is not None:
            if not 0.0 < self.marker < self.square:
                raise ValueError(f"a marker must fit into its square of {self.square} m, got {self.marker} m")
            if self.dictionary not in DICTIONARIES:
                names = ", ".join(sorted(DICTIONARIES))
                raise ValueError(f"there is no marker dictionary {self.dictionary!r}; there are {names}")
            needed, have = (self.columns + 1) * (self.rows + 1) // 2, len(_markers(self.dictionary).bytesList)
            if needed > have:
                raise ValueError(f"the board needs {needed} markers, {self.dictionary} has {have}")

    def __str__(self) -> str:
        kind = "chessboard" if self.marker is None else f"ChArUco board ({self.dictionary})"
        return f"{kind} of {self.columns} x {self.rows} inner corners"

    def picture(self, square_px: int) -> Image:
        """Draw the board with a white margin.

        Parameters
        ----------
        square_px : int
            Side of a square, px; 20 and more.

        Returns
        -------
        ndarray of shape (h, w), uint8
            ((rows + 3) by (columns + 3)) squares.
        """
        row, column = np.indices(((self.rows + 1) * square_px, (self.columns + 1) * square_px)) // square_px
        inner = np.where((row + column) % 2, 255, 0).astype(np.uint8)
        if self.marker is not None:
            markers, side = _markers(self.dictionary), max(round(self.marker / self.square * square_px), 1)
            white = [(r, c) for r in range(self.rows + 1) for c in range(self.columns + 1) if (r + c) % 2]
            for number, place in enumerate(white):
                top, left = (index * square_px + (square_px - side) // 2 for index in place)
                inner[top : top + side, left : left + side] = cv2.aruco.generateImageMarker(markers, number, side)
        return np.pad(inner, square_px, constant_values=255)


class BoardParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How a board is found.

    All were chosen by hand; tests/camera/test_board.py would show a change.

    Parameters
    ----------
    min_corners : int, default 8
        With fewer the board counts as not seen.
    window : float, default 0.4
        Half the window in which a corner is refined, in distances to the next corner: it must see only two edges.
    min_window_px : float, default 2.0
        The same is at least this.
    iterations : int, default 50
    tolerance_px : float, default 1e-4
        The refinement ends after so many steps, or with a step as short as this.
    min_markers : int, default 4
        With fewer different ones no dictionary is named: single markers are seen in much that is black and white.
    """

    min_corners: int = 8
    window: float = 0.4
    min_window_px: float = 2.0
    iterations: int = 50
    tolerance_px: float = 1e-4
    min_markers: int = 4


class BoardView(msgspec.Struct, frozen=True):
    """A board in one picture.

    Parameters
    ----------
    corners : ndarray of shape (n,), int64
        Which of the board's corners are seen, row by row.
    points : ndarray of shape (n, 3), float64
        Where they are on the board, m; z = 0.
    pixels : ndarray of shape (n, 2), float64
        Where they are seen, px.
    blur : float
        Standard deviation of the blur of the edges around them, px.
    index : int
        The frame's.
    """

    corners: npt.NDArray[np.int64]
    points: Floats
    pixels: Floats
    blur: float
    index: int


class BoardFinder:
    """Finds a board in pictures.

    Parameters
    ----------
    board : Board
    parameters : BoardParameters, optional
    """

    def __init__(self, board: Board, parameters: BoardParameters | None = None) -> None:
        self.board, self.parameters = board, parameters or BoardParameters()
        column, row = np.meshgrid(np.arange(board.columns), np.arange(board.rows))
        places = np.column_stack((column.ravel(), row.ravel(), np.zeros(column.size)))
        self._places = np.asarray(places * board.square, np.float64)
        self._detectors: list[Any] = []
        if board.marker is not None:  # OpenCV before 4.6 began boards of an even number of rows with a marker
            kinds = (False, True) if board.rows % 2 else (False,)
            self._detectors = [cv2.aruco.CharucoDetector(_charuco(board, legacy)) for legacy in kinds]

    def find(self, frame: Frame) -> BoardView | Lost[None]:
        """Look for the board.

        Parameters
        ----------
        frame : Frame

        Returns
        -------
        View or Lost
            All corners of a chessboard, those that are seen of a ChArUco board.
        """
        image = np.ascontiguousarray(as_gray(frame.image), np.uint8)
        found = self._chessboard(image) if self.board.marker is None else self._charuco(image)
        if found is None or len(found[0]) < self.parameters.min_corners:
            return Lost(f"no {self.board} in the picture", frame.time)
        corners, pixels = found
        return BoardView(corners, self._places[corners], pixels, blur_at(image, pixels), frame.index)

    def _chessboard(self, image: Image) -> tuple[npt.NDArray[np.int64], Floats] | None:
        size = self.board.columns, self.board.rows
        if min(image.shape) < 30:
            return None
        found, pixels = cv2.findChessboardCorners(image, size, flags=_QUICK)
        if not found:
            found, pixels = cv2.findChessboardCornersSB(image, size, flags=cv2.CALIB_CB_EXHAUSTIVE)
        if not found:
            return None
        return np.arange(len(self._places)), self._refined(image, np.asarray(pixels, np.float64).reshape(-1, 2))

    def _charuco(self, image: Image) -> tuple[npt.NDArray[np.int64], Floats] | None:
        for detector in self._detectors:
            pixels, corners, _, _ = detector.detectBoard(image)
            if corners is not None and len(corners) >= self.parameters.min_corners:
                self._detectors = [detector]
                return np.asarray(corners, np.int64).ravel(), np.asarray(pixels, np.float64).reshape(-1, 2)
        return None

    def _refined(self, image: Image, pixels: Floats) -> Floats:
        """Refine corners by the gradients around them (`cv2.cornerSubPix`): three times as exact as detected.

        Not for ChArUco boards: their markers have edges of their own in the window, and the corners would get worse.
        """
        distance = np.linalg.norm(pixels[:, None] - pixels[None], axis=2)
        np.fill_diagonal(distance, np.inf)
        refined, limits = pixels.copy(), self.parameters
        criteria = cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, limits.iterations, limits.tolerance_px
        for i, reach in enumerate(np.maximum(limits.window * distance.min(axis=1), limits.min_window_px)):
            corner = pixels[i].astype(np.float32).reshape(1, 1, 2)
            moved = cv2.cornerSubPix(image, corner, (int(reach), int(reach)), (-1, -1), criteria).reshape(2)
            if np.isfinite(moved).all() and np.abs(moved - pixels[i]).max() < reach:
                refined[i] = moved
        return refined


def blur_at(image: Image, pixels: Floats) -> float:
    """Blur of the edges around some points: contrast over steepest slope, as of a step under a Gaussian.

    Parameters
    ----------
    image : ndarray of shape (h, w), uint8
    pixels : ndarray of shape (n, 2), float64
        Corners of a board, px.

    Returns
    -------
    float
        Standard deviation of the Gaussian, px; median over the points.
    """
    half = 6  # px around a corner
    wide = cv2.copyMakeBorder(image, half, half, half, half, cv2.BORDER_REPLICATE)
    values = []
    for x, y in np.rint(pixels).astype(int):
        x, y = min(max(x, 0), image.shape[1] - 1), min(max(y, 0), image.shape[0] - 1)
        patch = cv2.GaussianBlur(wide[y : y + 2 * half + 1, x : x + 2 * half + 1].astype(np.float32), (0, 0), 0.7)
        steepest = float(np.hypot(*np.gradient(patch)).max())
        values.append(float(patch.max() - patch.min()) / max(steepest * np.sqrt(2.0 * np.pi), 1e-3))
    return float(np.median(values))


def markers_seen(image: Image, parameters: BoardParameters | None = None) -> str:
    """Return the dictionary of most markers in a picture, of those that hold them the smallest; empty if there are few.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3) or (h, w), uint8
    parameters : BoardParameters, optional
    """
    seen: dict[str, int] = {}
    for name in sorted(DICTIONARIES, key=lambda each: len(_markers(each).bytesList)):
        _, numbers, _ = cv2.aruco.ArucoDetector(_markers(name)).detectMarkers(image)
        seen[name] = 0 if numbers is None else len(set(np.ravel(numbers).tolist()))
    name = max(seen, key=lambda each: seen[each])
    return name if seen[name] >= (parameters or BoardParameters()).min_markers else ""


def _markers(dictionary: str) -> Any:
    return cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, DICTIONARIES[dictionary]))


def _charuco(board: Board, legacy: bool) -> Any:
    size = board.columns + 1, board.rows + 1
    charuco = cv2.aruco.CharucoBoard(size, board.square, board.marker or 0.0, _markers(board.dictionary))
    charuco.setLegacyPattern(legacy)
    return charuco
