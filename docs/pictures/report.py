"""Draw what `--report` makes: `python docs/pictures/report.py`, from the root of the repository; it needs Chromium.

The report of ten seconds as a phone shows it, one column, cut into three that stand side by side.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from PIL import Image

HERE = Path(__file__).resolve().parent
WIDTH, HEIGHT, GAP = 500, 6000, 24  # geometry: of the window and between the columns, px
COLUMNS = 3  # geometry: of the picture
BLANK_PX = 30  # geometry: least height of a gap at which the page is cut


def photograph(page: Path, picture: Path) -> Image.Image:
    """Open a page in a browser without a window; return what it shows."""
    look = "--headless", "--no-sandbox", "--hide-scrollbars", f"--window-size={WIDTH},{HEIGHT}"
    subprocess.run(["chromium", *look, f"--screenshot={picture}", page.as_uri()], check=True, capture_output=True)
    return Image.open(picture).convert("RGB")


def cut(page: Image.Image) -> Image.Image:
    """Cut a page at its gaps into columns of about one height, side by side."""
    pixels = np.asarray(page)
    blank = (pixels == pixels[0, 0]).all(axis=(1, 2))
    last = int(np.flatnonzero(~blank)[-1]) + BLANK_PX
    gaps = [row for row in range(BLANK_PX, last) if blank[row - BLANK_PX : row].all()]
    wanted = [last * part / COLUMNS for part in range(1, COLUMNS)]
    ends = [min(gaps, key=lambda row, place=place: abs(row - place)) for place in wanted]
    pieces = [page.crop((0, top, WIDTH, end)) for top, end in zip([0, *ends], [*ends, last], strict=True)]
    size = COLUMNS * (WIDTH + GAP) - GAP, max(piece.height for piece in pieces)
    sheet = Image.new("RGB", size, tuple(int(value) for value in pixels[0, 0]))
    for number, piece in enumerate(pieces):
        sheet.paste(piece, (number * (WIDTH + GAP), 0))
    return sheet


def main() -> None:
    """Fly, photograph, cut, write report.webp."""
    with tempfile.TemporaryDirectory() as name:
        page = Path(name) / "flight.html"
        if len(sys.argv) > 1:
            page = Path(sys.argv[1]).resolve()
        else:
            words = "fly", "sim://chain", "--duration", "10", "--quiet", "--report", str(page)
            subprocess.run([sys.executable, "-m", "matchset.cli", *words], check=True)
        cut(photograph(page, Path(name) / "page.png")).save(HERE / "report.webp", quality=80, method=6)


if __name__ == "__main__":
    main()
