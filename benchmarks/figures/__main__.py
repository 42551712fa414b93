"""Draw all figures again from their kept data: `python -m benchmarks.figures`."""

from pathlib import Path

from benchmarks.figures.kept import redraw

if __name__ == "__main__":
    for path in redraw(Path(__file__).resolve().parents[1] / "pictures"):
        print(path)
