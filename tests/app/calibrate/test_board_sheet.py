"""A printed board: its squares and its ruler have the lengths that it says, on paper that people have."""

import re
import xml.etree.ElementTree as ET
import zlib
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from blue_ball import Matchset
from matchset.app.calibrate.board_sheet import EDGE, PAPERS, Sheet, as_pdf, as_svg, board_sheet
from matchset.camera.board import Board, BoardFinder, BoardView
from matchset.image.frame import Frame

BOARD = Board(columns=9, rows=6, square=0.025)
CHARUCO = Board(columns=9, rows=6, square=0.025, marker=0.018)


def drawn(sheet: Sheet, scale: float = 5.0) -> npt.NDArray[np.uint8]:
    """The sheet as a picture, `scale` px a mm."""
    image = np.full((round(sheet.size[1] * scale), round(sheet.size[0] * scale)), 255, np.uint8)
    for x, y, w, h in sheet.black:
        image[round(y * scale) : round((y + h) * scale), round(x * scale) : round((x + w) * scale)] = 0
    return image


@pytest.mark.parametrize("paper", sorted(PAPERS))
@pytest.mark.parametrize("board", [BOARD, CHARUCO, Board(columns=6, rows=9, square=0.02)], ids=str)
def test_a_board_fits_its_paper_and_is_found_on_it(board: Board, paper: str) -> None:
    sheet = board_sheet(board, paper)
    assert sorted(sheet.size) == sorted(PAPERS[paper])
    boxes = np.array(sheet.black)
    assert boxes[:, :2].min() >= EDGE - 1e-6
    assert (np.array(sheet.size) - (boxes[:, :2] + boxes[:, 2:])).min() >= EDGE - 1e-6
    assert sheet.board.square <= board.square
    view = BoardFinder(sheet.board).find(Frame(drawn(sheet), 0.0))
    assert isinstance(view, BoardView)
    assert len(view.corners) == board.columns * board.rows
    by_row = view.pixels[np.argsort(view.corners)].reshape(board.rows, board.columns, 2)
    sides = np.linalg.norm(np.diff(by_row, axis=1), axis=2) / 5.0
    assert sides.mean() == pytest.approx(1000.0 * sheet.board.square, rel=0.002)


def test_25_mm_fill_an_a4_and_are_fitted_to_a_letter() -> None:
    assert board_sheet(BOARD, "a4").board == BOARD
    fitted = board_sheet(CHARUCO, "letter").board
    assert fitted.square == pytest.approx(0.0245)
    assert fitted.marker == pytest.approx(0.018 * 24.5 / 25.0)
    with pytest.raises(ValueError, match=r"does not fit on a4: its squares would be smaller than 5 mm"):
        board_sheet(Board(columns=90, rows=60, square=0.025), "a4")


@pytest.mark.parametrize("paper", sorted(PAPERS))
def test_the_ruler_is_100_mm_and_the_name_is_there(paper: str) -> None:
    sheet = board_sheet(BOARD, paper)
    assert any(max(w, h) == 100.0 and min(w, h) < 0.5 for _, _, w, h in sheet.black)
    (name, *_) = sheet.words
    assert name.text.startswith(f"9x6, {1000.0 * sheet.board.square:.1f} mm")
    assert "print at 100 %" in name.text
    assert all(
        EDGE <= each.x <= sheet.size[0] - EDGE and EDGE <= each.y <= sheet.size[1] - EDGE for each in sheet.words
    )


def test_pdf_and_svg_have_the_true_scale() -> None:
    sheet = board_sheet(BOARD, "a4")
    svg = ET.fromstring(as_svg(sheet))
    assert (svg.attrib["width"], svg.attrib["height"]) == ("297.0mm", "210.0mm")
    assert svg.attrib["viewBox"] == "0 0 297.0 210.0"
    pdf = as_pdf(sheet)
    box = re.search(rb"/MediaBox \[0 0 ([\d.]+) ([\d.]+)\]", pdf)
    assert box is not None
    assert [float(each) / 72.0 * 25.4 for each in box.groups()] == pytest.approx([297.0, 210.0], abs=0.001)
    scale = re.search(rb"([\d.]+) 0 0 -([\d.]+) 0 [\d.]+ cm", pdf)
    assert scale is not None
    assert [float(each) * 25.4 / 72.0 for each in scale.groups()] == pytest.approx([1.0, 1.0], abs=1e-6)
    for number, begin in enumerate(re.findall(rb"(\d{10}) 00000 n", pdf), 1):
        assert pdf[int(begin) :].startswith(b"%d 0 obj" % number)
    start = re.search(rb"startxref\n(\d+)", pdf)
    assert start is not None
    assert pdf[int(start[1]) :].startswith(b"xref")
    assert b"/PrintScaling /None" in pdf
    assert zlib.crc32(pdf) == zlib.crc32(as_pdf(board_sheet(BOARD, "a4")))


@pytest.mark.parametrize("name", ["board.pdf", "board.svg"])
def test_the_command_says_what_it_fitted_and_how_to_go_on(
    matchset: Matchset, capsys: pytest.CaptureFixture[str], name: str
) -> None:
    words = ("calibrate", "--board", "9x6", "--square", "0.025", "--board-picture", name)
    assert matchset(*words) == 0
    assert "do not fit" not in capsys.readouterr().out
    assert matchset(*words) == 2  # nothing is overwritten
    assert matchset(*words, "--paper", "letter", "--force") == 0
    said = capsys.readouterr().out
    assert "Squares of 25.0 mm do not fit on letter: they are 24.5 mm." in said
    assert "matchset calibrate 0 --board 9x6 --square 0.0245 -o camera.toml" in said
    assert Path(name).stat().st_size > 1000
