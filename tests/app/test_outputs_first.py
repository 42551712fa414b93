"""No output is opened before all of them are compared with all that is read; a wrong name is said at once."""

import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest

from blue_ball import Matchset
from matchset.app.disk import WholeFile
from matchset.app.films.video_writer import FilmWriter
from matchset.app.run_folder import check_outputs, check_run
from matchset.app.tables import Column, RowWriter

SIZE = 64, 48
HEAVY = ("numba", "cv2", "scipy", "matplotlib", "PIL", "numpy", "av", "mcap")


# What is typed, and which file of it is both read and written. `film.avi`, `c.npz`, `c.toml`, `shape.png` are there.
BOTH = {
    "track": ("film.avi", "track film.avi --pick 1,1 --video OUT.avi"),
    "track's film": ("DIR/film.avi", "track DIR/film.avi --pick 1,1 --video DIR/film.avi"),
    "track's table": ("DIR/tracks.csv", "track DIR/tracks.csv --pick 1,1 -o DIR"),
    "track's shape": ("shape.png", "track film.avi --pick 1,1 --shape shape.png --video OUT.avi"),
    "track's color": ("c.npz", "track film.avi --color c.npz --video OUT.webm"),
    "track's parameters": ("c.toml", "track film.avi --pick 1,1 --params c.toml --video OUT.mp4"),
    "learn": ("shape.png", "learn shape.png -o OUT.png"),
    "learn a color": ("shape.png", "learn shape.png --pick 1,1 -o OUT.npz"),
    "learn's mask": ("DIR/b-mask.png", "learn DIR/b-mask.png --pick 1,1 -o DIR/b.npz"),
    "locate": ("film.avi", "locate film.avi --pick 1,1 --fov 60 --diameter 1 --video OUT.avi"),
    "locate's picture": ("DIR/poses.png", "locate DIR/poses.png --pick 1,1 --fov 60 --diameter 1 -o DIR"),
    "locate's camera": ("c.toml", "locate film.avi --pick 1,1 --camera c.toml --diameter 1 --video OUT.avi"),
    "locate's markers": ("c.npz", "locate film.avi --pick 1,1 --fov 60 --marker-color c.npz --video OUT.avi"),
    "calibrate": ("film.avi", "calibrate film.avi --board 9x6 --square 0.02 -o OUT.toml"),
    "calibrate's picture": (
        "DIR/b-coverage.png",
        "calibrate DIR/b-coverage.png --board 9x6 --square 0.02 -o DIR/b.toml",
    ),
    "calibrate with a ball": (
        "shape.png",
        "calibrate film.avi shape.png --ball-diameter 0.2 --at 1,2 --pick 1,1 -o OUT.toml",
    ),
    "demo": ("DIR/sheet.png", "demo --shape DIR/sheet.png -o DIR"),
    "fly": ("c.toml", "fly --config c.toml --report OUT.html"),
    "fly's film": ("c.toml", "fly --config c.toml --video OUT.webm"),
    "fly's camera": ("c.toml", "fly --camera 0 --link serial:///dev/x --camera-file c.toml --report OUT.html"),
    "fly's color": ("c.npz", "fly --camera 0 --link serial:///dev/x --color c.npz --video OUT.webm"),
    "preflight": ("c.toml", "preflight --config c.toml --camera 0 --link serial:///dev/x -o OUT.json"),
    "identify": ("c.toml", "identify sim://chain --config c.toml -o OUT.toml"),
    "identify's color": ("c.npz", "identify serial:///dev/x --camera 0 --color c.npz -o OUT.npz"),
    "identify's report": ("c.toml", "identify sim://chain --config c.toml --report OUT.html"),
    "simulate": ("DIR/table.md", "simulate --config DIR/table.md -o DIR"),
    "replay": ("film.avi", "replay film.avi --report OUT.html"),
}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with one of each kind of input."""
    writer = cv2.VideoWriter(str(tmp_path / "film.avi"), cv2.VideoWriter.fourcc(*"MJPG"), 30.0, SIZE)
    for level in (10, 20, 30):
        writer.write(np.full((SIZE[1], SIZE[0], 3), level, np.uint8))
    writer.release()
    cv2.imwrite(str(tmp_path / "shape.png"), np.full((48, 64, 3), 255, np.uint8))
    (tmp_path / "c.npz").write_bytes(b"a color")
    (tmp_path / "c.toml").write_text("duration = 1.0\n")
    return tmp_path


@pytest.mark.parametrize(
    ("title", "link"),
    [
        (title, link)
        for title, (read, _) in BOTH.items()
        for link in ("symbolic", "hard", "itself")
        if link != "itself" or read.startswith("DIR")  # elsewhere its ending differs
    ],
)
def test_an_input_is_never_overwritten(
    folder: Path, matchset: Matchset, capsys: pytest.CaptureFixture[str], title: str, link: str
) -> None:
    read, line = BOTH[title]
    words = tuple(line.split())
    original = folder / read
    if read.startswith("DIR"):
        original.parent.mkdir()
        if link == "itself":
            original.write_bytes((folder / "shape.png").read_bytes())
        else:  # the input has another name: the file in the folder is a link to it
            words = tuple("shape.png" if word == read else word for word in words)
            _link(original, folder / "shape.png", link)
        protected = folder / "shape.png"
    else:
        out = next(word for word in words if word.startswith("OUT."))
        _link(folder / out, original, link)
        protected = original
    before = {path: path.read_bytes() for path in (original, protected)}
    assert matchset(*words, "--force") == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "is what is read" in said
    assert all(path.read_bytes() == content for path, content in before.items())


def _link(new: Path, target: Path, kind: str) -> None:
    if kind == "symbolic":
        new.symlink_to(target.resolve())
    else:
        new.hardlink_to(target)


def test_two_outputs_are_never_one_file(tmp_path: Path) -> None:
    one, other = tmp_path / "a.html", tmp_path / "b.html"
    with pytest.raises(ValueError, match="are one file"):
        check_outputs([one, tmp_path / "." / "a.html"], [], True)
    one.write_text("a")
    other.symlink_to(one)
    with pytest.raises(ValueError, match="are one file"):
        check_outputs([one, other], [], True)
    with pytest.raises(ValueError, match="are one file"):
        check_run(tmp_path, ["a.html"], [one], [], True)


def test_nothing_is_made_by_the_check(tmp_path: Path) -> None:
    check_run(tmp_path / "new" / "run", ["a.csv"], [tmp_path / "films" / "a.webm"], ["0", "rtsp://camera/1"])
    assert list(tmp_path.iterdir()) == []


WRONG = {
    "a file that exists": ("track", "film.avi", "--pick", "1,1", "--video", "shape.png"),
    "a wrong ending": ("track", "film.avi", "--pick", "1,1", "--video", "new.xyz"),
    "a folder with files": ("track", "film.avi", "--pick", "1,1", "-o", "."),
    "a folder below a file": ("track", "film.avi", "--pick", "1,1", "-o", "film.avi/run"),
    "learn": ("learn", "film.avi", "-o", "shape.png"),
    "learn, wrong ending": ("learn", "film.avi", "--pick", "1,1", "-o", "a.txt"),
    "locate": ("locate", "film.avi", "--pick", "1,1", "--fov", "60", "--diameter", "1", "--video", "film.avi"),
    "calibrate": ("calibrate", "film.avi", "--board", "9x6", "--square", "0.02", "-o", "c.toml"),
    "a board": ("calibrate", "--board", "9x6", "--square", "0.02", "--board-picture", "shape.png"),
    "demo": ("demo", "-o", "."),
    "fly": ("fly", "--report", "film.avi"),
    "fly, wrong ending": ("fly", "--report", "new.txt"),
    "replay": ("replay", "film.avi", "--video", "shape.png"),
    "simulate": ("simulate", "-o", "."),
}


@pytest.mark.parametrize("words", WRONG.values(), ids=list(WRONG))
def test_a_wrong_output_is_said_before_anything_heavy_is_loaded(folder: Path, words: tuple[str, ...]) -> None:
    program = (
        f"import sys\nfrom matchset.cli import main\nsys.argv[1:] = {words!r}\n"
        f"try: main()\nexcept SystemExit as end: print(end.code, *[n for n in {HEAVY!r} if n in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, cwd=folder, check=True)
    assert done.stdout.split() == ["2"]
    assert done.stderr.startswith("error: ")
    assert done.stderr.count("\n") == 1
    assert len(list(folder.iterdir())) == 4


def test_what_exists_is_there_until_the_new_one_is_finished(tmp_path: Path) -> None:
    film, table = tmp_path / "film.webm", tmp_path / "table.csv"
    for path in (film, table):
        path.write_text("old")
    columns = [Column("number", lambda row: int(row))]
    rows: RowWriter[int] = RowWriter(table, columns)
    with FilmWriter(film, 30.0, SIZE) as recorder, rows:
        recorder.write(np.zeros((SIZE[1], SIZE[0], 3), np.uint8))
        rows.write(1)
        assert film.read_text() == table.read_text() == "old"
        assert sorted(path.name for path in tmp_path.iterdir()) == [
            "film.part.webm", "film.webm", "table.csv", "table.part.csv",
        ]  # fmt: skip
    assert sorted(path.name for path in tmp_path.iterdir()) == ["film.webm", "table.csv"]
    assert table.read_text() == "number\n1\n"
    assert film.stat().st_size > 100


def test_a_film_of_nothing_leaves_no_half(tmp_path: Path) -> None:
    old, new = tmp_path / "old.webm", tmp_path / "new.webm"
    old.write_text("old")
    for path in (old, new):
        with FilmWriter(path, 30.0, SIZE):
            pass
    assert [path.name for path in tmp_path.iterdir()] == ["old.webm"]
    assert old.read_text() == "old"


def test_what_lies_beside_is_never_overwritten(tmp_path: Path) -> None:
    path, left = tmp_path / "a.csv", tmp_path / "a.part.csv"
    path.write_text("old")
    left.write_text("of a killed run")
    with WholeFile(path) as file:
        file.append(b"new")
    assert (path.read_text(), left.read_text()) == ("new", "of a killed run")
