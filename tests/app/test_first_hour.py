"""What a newcomer types wrongly, or reads first: names that are no text, units, terminals, notes before long work."""

import itertools
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from blue_ball import Matchset
from chain_flight import Flown
from matchset.app.cli_options import LARGE_BALL, LARGE_SQUARE, unit_note
from matchset.app.exit_codes import compiling_announced
from matchset.app.progress import duration_text
from matchset.flight.fly.output_files import FlightFiles
from matchset.flight.fly.outputs import FlightOutputs
from matchset.flight.simulate.flights import work_text
from matchset.links.simulation_parameters import parse_uri
from matchset.media.camera_stream import _hint
from matchset.media.video import Video
from matchset.numeric.compiling import compiling

PACKAGE = Path(__file__).parent.parent.parent / "src" / "matchset"


def type_it(folder: Path, *words: str | bytes, **environment: str) -> subprocess.CompletedProcess[bytes]:
    """Run the command line in a process of its own."""
    asked = [sys.executable, "-c", "from matchset.cli import main; main()", *words]
    return subprocess.run(asked, capture_output=True, cwd=folder, env=os.environ | environment, check=False)


@pytest.mark.parametrize(
    "words",
    [
        ("learn", "SOURCE"),
        ("track", "SOURCE", "--pick", "50,60"),
        ("locate", "SOURCE", "--pick", "50,60", "--fov", "60", "--diameter", "0.3"),
        ("calibrate", "SOURCE", "--board", "9x6", "--square", "0.025"),
    ],
)
def test_a_name_that_is_not_utf8_is_an_error_not_a_crash(
    matchset: Matchset, ball_video: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], words: tuple[str, ...]
) -> None:
    strange = tmp_path / os.fsdecode(b"ball\xff\xe9.mp4")
    shutil.copy(ball_video, strange)
    assert matchset(*(strange if word == "SOURCE" else word for word in words)) == 2
    said = capsys.readouterr().err
    assert "OpenCV cannot open a name that is not UTF-8: rename" in said
    assert said.count("\n") == 1


def test_the_answer_is_printed_of_a_folder_whose_name_is_no_text(ball_video: Path, tmp_path: Path) -> None:
    out = os.fsdecode(b"o\xff.npz")
    done = type_it(tmp_path, "learn", str(ball_video), "--pick", "60,60", "-o", out, PYTHONIOENCODING="utf-8:strict")
    assert done.returncode == 0, done.stderr
    assert b"o\xff.npz" in done.stdout
    assert (tmp_path / out).exists()


def test_a_film_whose_name_opencv_cannot_take_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from matchset.app.films.video_writer import FilmWriter

    monkeypatch.setitem(sys.modules, "av", None)
    with pytest.raises(ValueError, match="not UTF-8: rename"):
        FilmWriter(tmp_path / os.fsdecode(b"o\xff.avi"), 30.0, (64, 48))


def test_nothing_can_be_written_where_the_package_is(tmp_path: Path) -> None:
    """A container with a read-only root: no folder of the package, no home, no cache."""
    setpriv = shutil.which("setpriv")
    if os.getuid() != 0 or setpriv is None:
        pytest.skip("needs root, to become a user who may write nothing")
    copy = tmp_path / "root" / "matchset"
    shutil.copytree(PACKAGE, copy, ignore=shutil.ignore_patterns("__pycache__"))
    temporary = Path(tempfile.gettempdir()).resolve()
    for folder in itertools.takewhile(
        lambda each: each != temporary, (tmp_path.resolve(), *tmp_path.resolve().parents)
    ):
        folder.chmod(folder.stat().st_mode | 0o055)
    program = "import numpy; from matchset.numeric.linalg import norm; norm(numpy.ones(3)); print('fine')"
    nobody = [setpriv, "--reuid=65534", "--regid=65534", "--clear-groups"]
    kept = {"PATH": os.environ["PATH"], "PYTHONPATH": str(tmp_path / "root"), "HOME": "/nonexistent"}
    for asked in (["-c", program], ["-c", "from matchset.cli import main; main()", "track", "--help"]):
        done = subprocess.run(
            [*nobody, sys.executable, "-B", *asked], capture_output=True, text=True, cwd="/", env=kept, check=False
        )
        if "Permission denied" in done.stderr and not done.stdout:
            pytest.skip("nobody may not read this Python")
        assert done.returncode == 0, done.stderr
        assert "Traceback" not in done.stderr
        if asked[1] == program:
            assert done.stdout == "fine\n"
            assert done.stderr.count("\n") == 1
            assert "NUMBA_CACHE_DIR" in done.stderr


def test_compiling_is_said_once_and_only_if_something_is_compiled(capsys: pytest.CaptureFixture[str]) -> None:
    with compiling_announced():
        pass
    assert capsys.readouterr().err == ""
    with compiling_announced():
        compiling()
        compiling()
    assert capsys.readouterr().err == "compiling kernels (only once on this machine) ...\n"
    compiling()
    assert capsys.readouterr().err == ""


def test_numba_tells_when_it_compiles_and_not_when_it_loads(tmp_path: Path) -> None:
    (tmp_path / "made.py").write_text("from matchset.numeric.jit import kernel\n\n\n@kernel\ndef f(x):\n    return x\n")
    program = (
        "from matchset.numeric.compiling import WATCHERS\n"
        "WATCHERS.append(lambda: print('compiling'))\nimport made\nmade.f(1.0)\nprint('done')"
    )
    said = [
        subprocess.run(
            [sys.executable, "-c", program],
            capture_output=True,
            text=True,
            check=True,
            cwd=tmp_path,
            env=os.environ | {"NUMBA_CACHE_DIR": str(tmp_path / "kept")},
        ).stdout.split()
        for _ in range(2)
    ]
    assert said == [["compiling", "done"], ["done"]]


@pytest.mark.parametrize(
    ("option", "value", "most", "words"),
    [
        ("--diameter", 28.0, LARGE_BALL, "28 cm are --diameter 0.28"),
        ("--diameter", 280.0, LARGE_BALL, "280 mm are --diameter 0.28"),
        ("--square", 25.0, LARGE_SQUARE, "25 mm are --square 0.025"),
        ("--diameter", 0.28, LARGE_BALL, ""),
        ("--square", 0.5, LARGE_SQUARE, ""),
    ],
)
def test_lengths_that_are_hardly_in_meters(
    capsys: pytest.CaptureFixture[str], option: str, value: float, most: float, words: str
) -> None:
    unit_note(option, value, most)
    said = capsys.readouterr().err
    assert words in said
    assert bool(said) == bool(words)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("locate", "a.mp4", "--diameter", "28cm"), "'--diameter'.*got '28cm'; wanted is M: The ball's diameter"),
        (("live", "a.mp4", "--port", "99999"), "'--port'.*got '99999'; wanted is Port"),
        (("track", "a.mp4", "--diameter", "0.28"), "No such option: --diameter.*it is an option of locate"),
    ],
)
def test_a_wrong_option_shows_what_was_typed_and_what_is_wanted(tmp_path: Path, words: tuple[str], said: str) -> None:
    done = type_it(tmp_path, *words)
    assert done.returncode == 2
    assert re.fullmatch(f"error: .*{said}.*", done.stderr.decode().strip()), done.stderr


def test_calibrate_warns_of_squares_in_millimeters(matchset: Matchset, capsys: pytest.CaptureFixture[str]) -> None:
    matchset("calibrate", "no.mp4", "--board", "9x6", "--square", 25)
    assert "note: --square 25 is in m" in capsys.readouterr().err


def test_a_file_behind_http_a_missing_camera_and_a_real_link_are_explained(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Path, "glob", lambda self, _: iter([self / "video0", self / "video2"]))
    assert "there are /dev/video0, /dev/video2" in _hint(7)
    monkeypatch.setattr(Path, "glob", lambda *_: iter(()))
    assert "no camera" in _hint(0)
    assert "address" in _hint("rtsp://x")
    with pytest.raises(ValueError, match=r"real links do not fly yet"):
        parse_uri("serial:///dev/ttyUSB0")


def test_a_port_that_is_not_there_is_named_once(matchset: Matchset, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("serial")
    assert matchset("radio", "bind", "/dev/not-there") == 3
    assert capsys.readouterr().err == "error: cannot open /dev/not-there: No such file or directory\n"


def test_a_color_file_that_is_none_says_nothing_of_pickles(tmp_path: Path) -> None:
    from matchset.image.color import ColorModel

    (tmp_path / "bad.npz").write_bytes(b"no archive at all")
    with pytest.raises(ValueError, match=r"bad\.npz") as raised:
        ColorModel.load(tmp_path / "bad.npz")
    assert "pickle" not in str(raised.value)


def test_flags_want_no_value_and_narrow_terminals_get_lines(tmp_path: Path) -> None:
    wide = type_it(tmp_path, "track", "--help", COLUMNS="100", TERMINAL_WIDTH="100").stdout.decode()
    assert [line for line in wide.splitlines() if "<bool>" in line and "--help" not in line] == []
    assert "--force" in wide
    narrow = type_it(tmp_path, "track", "--help", COLUMNS="44").stdout.decode()
    assert max(map(len, narrow.splitlines())) <= 80
    assert "--candidate N[@FRAME]" in narrow
    assert "[bold]" not in narrow
    assert "…" not in narrow


def test_a_flight_says_what_it_will_take(flown: Flown, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("mcap")
    with FlightOutputs(flown.setup, FlightFiles(record=tmp_path / "a.mcap", video=tmp_path / "a.webm")):
        pass
    found = re.search(
        r"note: ([\d.]+) s of flight take about ([\d.]+) (MB|GB) of disk, .* are free", capsys.readouterr().err
    )
    assert found is not None
    size = float(found[2]) * (1.0 if found[3] == "MB" else 1000.0)
    assert 20.0 < size / float(found[1]) < 60.0


def test_many_flights_say_how_long_they_take(flown: Flown) -> None:
    flight = flown.setup.parameters
    assert work_text([flight] * 8, 2).startswith(f"8 flights of {flight.duration:g} s, 2 at once: about ")
    assert [duration_text(each) for each in (40.0, 240.0, 9000.0)] == ["40 s", "4 min", "2.5 h"]


def test_ctrl_c_while_loading_is_answered(
    matchset: Matchset, ball_video: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupted(*_: object, **__: object) -> Video:
        raise KeyboardInterrupt

    monkeypatch.setattr("matchset.media.video.Video.__init__", interrupted)
    assert matchset("track", ball_video, "--pick", "1,1") == 130
    assert "stopped" in capsys.readouterr().err
