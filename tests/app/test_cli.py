import io
import json
import subprocess
import sys
import threading
import time
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import cv2
import pytest
from rich.console import Console
from typer.testing import CliRunner

from blue_ball import Matchset
from matchset.app.progress import ComputingLine, FrameBar, FrameRate, LiveLine, announce_if_slow, live_line
from matchset.app.timing.durations import Durations
from matchset.app.track.rows import TrackRow
from matchset.cli import app

TRUTH = "video,frame,x,y,r,visible,method\nv,0,10,10,5,1,eye\nv,1,10,10,5,1,eye\nv,2,,,,0,eye:absent\n"
TRACKS = "frame,time,found,x,y,radius,support,reason\n0,0,1,10,10,5,1,\n1,0.1,1,11,10,5,1,\n2,0.2,0,,,,,gone\n"


@pytest.mark.parametrize("command", [(), ("track",), ("learn",), ("score",), ("demo",)])
def test_every_command_has_help(command: tuple[str, ...]) -> None:
    result = CliRunner().invoke(app, [*command, "--help"])
    assert result.exit_code == 0
    assert "Usage" in result.output


def test_the_version_is_printed(matchset: Matchset, capsys: pytest.CaptureFixture[str]) -> None:
    assert matchset("--version") == 0
    assert capsys.readouterr().out.startswith("matchset 0")


def test_the_package_is_a_command_too() -> None:
    run = [sys.executable, "-m", "matchset", "--version"]
    assert subprocess.run(run, capture_output=True, text=True, check=True).stdout.startswith("matchset 0")


def test_help_needs_no_heavy_imports() -> None:
    code = (
        "import sys, matchset.cli as cli\n"
        "sys.argv = ['matchset', '--help']\n"
        "try: cli.main()\n"
        "except SystemExit: pass\n"
        "heavy = 'numpy', 'numba', 'cv2', 'scipy', 'matplotlib', 'PIL', 'pygments', 'matchset.app.track.loop'\n"
        "print([name for name in heavy if name in sys.modules])\n"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert out.splitlines()[-1] == "[]"


@pytest.mark.parametrize("command", [(), ("track",), ("locate",), ("fly",), ("radio", "config")])
def test_help_is_the_same_with_the_faster_printer(command: tuple[str, ...], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "100")
    run = "import sys, matchset.cli as cli; sys.argv[0] = 'matchset'; cli.main()"
    plain = "import typer.rich_utils; " + run
    pages = [
        subprocess.run([sys.executable, "-c", code, *command, "--help"], capture_output=True, text=True, check=True)
        for code in (run, plain)
    ]
    assert pages[0].stdout == pages[1].stdout
    assert "Usage: matchset" in pages[0].stdout


def test_a_score_is_printed_as_a_table_and_as_json(matchset: Matchset, capsys: pytest.CaptureFixture[str]) -> None:
    Path("tracks.csv").write_text(TRACKS)
    Path("truth.csv").write_text(TRUTH)
    assert matchset("score", "tracks.csv", "truth.csv") == 0
    out = capsys.readouterr().out
    for words in ("mean error", "0.500 px", "100.0 %", "trembling", "1.000 px"):
        assert words in out
    assert matchset("score", "tracks.csv", "truth.csv", "--json", "--from", "1") == 0
    result = json.loads(capsys.readouterr().out)
    assert result["mean_error_px"] == 1.0
    assert result["trembling_px"] is None
    assert result["false_locks"] == 0


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("none.csv", "truth.csv"), "cannot read none.csv"),
        (("truth.csv", "truth.csv"), "there is no column found, radius"),
        (("tracks.csv", "truth.csv", "--video", "w"), "no rows of the video 'w'"),
        (("tracks.csv", "truth.csv", "--from", "9"), "holds no frames from frame 9 on"),
        (("tracks.csv",), "truth"),
    ],
)
def test_a_bad_score_is_one_line(
    matchset: Matchset, capsys: pytest.CaptureFixture[str], options: tuple[str, ...], words: str
) -> None:
    Path("tracks.csv").write_text(TRACKS)
    Path("truth.csv").write_text(TRUTH)
    assert matchset("score", *options) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("error: ")
    assert words in line


def test_the_demo_needs_nothing_and_leaves_everything(matchset: Matchset, capsys: pytest.CaptureFixture[str]) -> None:
    assert matchset("demo", "--frames", "24") == 0
    out = capsys.readouterr().out
    assert "mean error" in out
    folder = Path("runs/0001-demo")
    assert sorted(path.name for path in folder.iterdir()) == [
        "demo.webm",
        "sheet.png",
        "tracks.csv",
        "truth.csv",
    ]
    sheet = cv2.imread(str(folder / "sheet.png"))
    assert sheet is not None
    assert sheet.shape[0] > 1000
    assert (folder / "demo.webm").stat().st_size < 0.4e6  # 150 frames take less than 2 MB
    assert matchset("score", folder / "tracks.csv", folder / "truth.csv", "--json") == 0
    assert json.loads(capsys.readouterr().out)["valid_percent"] > 90.0
    assert matchset("demo", "--frames", "24", "-o", folder) == 2


def test_the_live_line_says_what_matters() -> None:
    found = TrackRow(3, 1.0, {"x": 12.34, "y": 5.0, "radius": 9.0})
    words = " ".join(live_line(found, 29.97, 0.0123, 4).plain.split())
    assert words == "30.0 frames/s age 12 ms dropped 4 x 12.3 y 5.0 r 9.0"
    assert live_line(TrackRow(3, 1.0, reason="gone"), None, 0.5, 0).plain.endswith("Lost: gone")


def test_below_it_stands_what_the_frames_took() -> None:
    durations = Durations()
    screen = Console(file=io.StringIO(), force_terminal=True, width=80)
    video: Any = SimpleNamespace(dropped=4)
    with LiveLine(video, screen, durations) as line, screen.capture() as capture:
        for seconds in [0.00015] * 90 + [0.21] * 9 + [1.02]:
            durations.add(seconds)
        line.show(TrackRow(3, time.monotonic(), reason="longer than what is left of the line of a terminal"))
        screen.print(ComputingLine(durations))
    last = capture.get().rstrip().splitlines()[-1]
    assert "computing a frame: median 0.15, mean 29.2, 95 % 210, worst 1020 ms" in last
    with FrameBar("rendering, tracking, recording", 300, screen, True, durations) as bar:
        bar.advance()
        assert isinstance(list(bar._progress.get_renderables())[-1], ComputingLine)
    assert ComputingLine(Durations()).__rich__().plain == ""


def test_the_rate_is_that_of_the_frames() -> None:
    rate = FrameRate()
    assert rate.update(0.0) is None
    assert [rate.update(0.1 * step) for step in range(1, 5)] == pytest.approx([10.0] * 4)


def test_only_what_is_slow_is_announced(capsys: pytest.CaptureFixture[str]) -> None:
    with announce_if_slow("quick", after=30.0):
        pass
    said = threading.Event()
    with announce_if_slow("slow", after=0.0):
        said.wait(0.2)
    assert capsys.readouterr().err == "slow\n"
