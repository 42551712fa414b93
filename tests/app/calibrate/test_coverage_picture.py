"""The picture of a calibration: words are whole, and what the board never covered is marked."""

import numpy as np
import numpy.typing as npt
import pytest

from matchset.app.calibrate import coverage_picture as module
from matchset.app.calibrate.coverage_picture import coverage_picture
from matchset.app.drawing.text import text_width
from matchset.camera.board import BoardView
from matchset.camera.calibration_report import CalibrationReport, Finding

Picture = npt.NDArray[np.uint8]
REPORT = CalibrationReport(
    "poor",
    [
        Finding("error", "good", "corners are 0.03 px off (rms)"),
        Finding("coverage", "poor", "31 % of the picture: hold the board at the upper left, upper right, " * 3),
    ],
)


def view(left: float, right: float) -> BoardView:
    x, y = np.meshgrid(np.linspace(left, right, 7), np.linspace(40.0, 300.0, 5))
    pixels = np.column_stack((x.ravel(), y.ravel()))
    points = np.column_stack((pixels, np.zeros(len(pixels))))
    return BoardView(np.arange(len(pixels)), points, pixels, 0.5, 0)


@pytest.mark.parametrize("size", [(480, 360), (360, 480), (1920, 1080)])
@pytest.mark.parametrize("report", [REPORT, None])
def test_every_word_is_inside(
    size: tuple[int, int], report: CalibrationReport | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    written: list[str] = []

    def record(image: Picture, text: str, at: tuple[float, float], size: int, *_: object) -> None:
        written.append(text)
        assert at[0] + text_width(text, size) <= image.shape[1]
        assert 0.5 * size <= at[1] <= image.shape[0] - 0.5 * size

    monkeypatch.setattr(module, "draw_text", record)
    gray = np.full(size[::-1], 200, np.uint8)
    picture = coverage_picture(gray, [view(40.0, 200.0)], report, "" if report else "the views are all alike " * 9)
    assert picture.shape[1] >= 900
    said = " ".join(" ".join(written).split())
    for words in ["in 1 view", "good", "poor"] if report else ["refused", "the views are all alike the views"]:
        assert words in said


def test_what_the_board_never_covered_is_colored() -> None:
    picture = coverage_picture(np.full((360, 480), 255, np.uint8), [view(40.0, 240.0)], REPORT)
    row = picture[picture.shape[0] // 3].astype(int)
    tinted = row[:, 2] - row[:, 0] > 40
    left, right = tinted[: len(row) // 2].mean(), tinted[len(row) // 2 :].mean()
    assert left < 0.3
    assert right > 0.8
