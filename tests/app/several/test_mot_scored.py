"""The text of `--mot`, read and scored by others: TrackEval's own reader of MOTChallenge, and pandas."""

import contextlib
import io
from pathlib import Path
from typing import Any

import pytest

from blue_ball import Matchset
from several_balls import BALLS, FRAMES, RADIUS, SIZE, places, write_pictures

COLUMNS = ["frame", "id", "left", "top", "width", "height", "confidence", "x", "y", "z"]
BLUE_PICK = "60,60"
CLIP, RUNS = "balls", "runs/crowd-train"


@pytest.fixture(scope="module")
def balls(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_pictures(tmp_path_factory.mktemp("scored") / CLIP)


def write_truth(folder: Path) -> None:
    """Write what is known of the two blue balls, as MOTChallenge has it."""
    sequence = folder / "truth" / "crowd-train" / CLIP
    (sequence / "gt").mkdir(parents=True)
    lines = []
    for frame in range(FRAMES):
        for ball in range(len(BALLS) - 1):
            x, y = places(frame)[ball]
            box = f"{x - RADIUS},{y - RADIUS},{2 * RADIUS},{2 * RADIUS}"
            lines.append(f"{frame + 1},{ball + 1},{box},1,1,1.0\n")
    (sequence / "gt" / "gt.txt").write_text("".join(lines))
    known = f"name={CLIP}\nframeRate=30\nseqLength={FRAMES}\nimWidth={SIZE[0]}\nimHeight={SIZE[1]}\nimExt=.png\n"
    (sequence / "seqinfo.ini").write_text("[Sequence]\n" + known)
    maps = folder / "truth" / "seqmaps"
    maps.mkdir()
    (maps / "crowd-train.txt").write_text(f"name\n{CLIP}\n")


def scored(folder: Path, run: str) -> dict[str, Any]:
    """Score the text of a run with TrackEval, as its own script does."""
    quiet = {"PRINT_RESULTS": False, "PRINT_CONFIG": False, "TIME_PROGRESS": False, "LOG_ON_ERROR": None}
    files = {"OUTPUT_SUMMARY": False, "OUTPUT_DETAILED": False, "PLOT_CURVES": False, "DISPLAY_LESS_PROGRESS": True}
    where = {"GT_FOLDER": str(folder / "truth"), "TRACKERS_FOLDER": str(folder / "runs"), "PRINT_CONFIG": False}
    with contextlib.redirect_stdout(io.StringIO()):
        import trackeval
        from trackeval.datasets import MotChallenge2DBox
        from trackeval.metrics import HOTA, Identity

        evaluator = trackeval.Evaluator(quiet | files | {"BREAK_ON_ERROR": True})
        clips = MotChallenge2DBox(where | {"BENCHMARK": "crowd", "TRACKERS_TO_EVAL": [run], "DO_PREPROC": False})
        results, _ = evaluator.evaluate([clips], [HOTA(), Identity({"PRINT_CONFIG": False})])
    found = results["MotChallenge2DBox"][run][CLIP]["pedestrian"]
    return {"HOTA": float(found["HOTA"]["HOTA"].mean()), "IDF1": float(found["Identity"]["IDF1"])}


def text_of(matchset: Matchset, balls: Path, path: Path, *options: str) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    command = "track", balls, "--pick", BLUE_PICK, "--all", "--no-video", "-o", "out", "--force", "--mot", path
    assert matchset(*command, *options) == 0
    return path


def test_trackeval_reads_and_scores_the_text_of_the_command_line(
    matchset: Matchset, balls: Path, tmp_path: Path
) -> None:
    pytest.importorskip("trackeval.metrics", exc_type=ImportError)
    write_truth(tmp_path)
    for run, options in (("update", ()), ("smooth", ("--smooth",))):
        text_of(matchset, balls, tmp_path / RUNS / run / "data" / f"{CLIP}.txt", *options)
    found = scored(tmp_path, "update")
    assert found["HOTA"] > 0.9
    assert found["IDF1"] > 0.95
    both = scored(tmp_path, "smooth")
    assert both["IDF1"] >= found["IDF1"]
    assert both["IDF1"] == 1.0
    exchanged = tmp_path / RUNS / "exchanged" / "data" / f"{CLIP}.txt"
    exchanged.parent.mkdir(parents=True)
    lines = (tmp_path / RUNS / "smooth" / "data" / f"{CLIP}.txt").read_text().splitlines()
    cells = [line.split(",") for line in lines]
    late = [[cell[0], str(3 - int(cell[1])), *cell[2:]] if int(cell[0]) > FRAMES // 2 else cell for cell in cells]
    exchanged.write_text("".join(",".join(cell) + "\n" for cell in late))
    assert scored(tmp_path, "exchanged")["IDF1"] == pytest.approx(0.5, abs=0.05)


@pytest.mark.parametrize("options", [(), ("--smooth",)])
def test_pandas_reads_the_text_as_motchallenge_says(
    matchset: Matchset, balls: Path, tmp_path: Path, options: tuple[str, ...]
) -> None:
    pandas = pytest.importorskip("pandas")
    text = text_of(matchset, balls, tmp_path / "out.txt", *options)
    table = pandas.read_csv(text, header=None, names=COLUMNS, index_col=["frame", "id"])
    assert table.index.is_unique
    assert table.index.get_level_values("frame").min() >= 1
    assert set(table.index.get_level_values("id")) == {1, 2}
    assert (table[["x", "y", "z"]] == -1).all(axis=None)
    assert table["confidence"].between(0.0, 1.0).all()
    center = table["left"] + table["width"] / 2.0
    for (frame, _), x in center.items():
        assert min(abs(x - place[0]) for place in places(frame - 1)[:2]) < 0.5
    if options:
        assert len(table) == 2 * FRAMES
