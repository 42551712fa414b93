"""Every example runs as it stands, in an empty folder; most of them in this process, which has all code loaded."""

import re
import runpy
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pytest

from matchset import cli
from matchset.app.films.clip_export import write_clip
from matchset.app.locate.rows import read_poses
from matchset.sim.clips.clip import Clip

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
LONGEST = 40  # lines


class Ended(NamedTuple):
    """How a program ended, and what it said."""

    code: int
    out: str
    err: str

    @property
    def lines(self) -> list[str]:
        """What it said, if it ended well."""
        assert self.code == 0, self.err
        return self.out.splitlines()


Run = Callable[..., Ended]


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> Run:
    """Run an example, with its arguments."""
    monkeypatch.chdir(tmp_path)

    def run(name: str, *words: str) -> Ended:
        monkeypatch.setattr("sys.argv", [str(EXAMPLES / name), *words])
        capfd.readouterr()
        code: object = 0
        try:
            runpy.run_path(str(EXAMPLES / name), run_name="__main__")
        except SystemExit as end:
            code = end.code
        out, err = capfd.readouterr()
        return Ended(1, out, f"{err}{code}\n") if isinstance(code, str) else Ended(int(bool(code)), out, err)

    return run


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.py")), ids=lambda path: path.stem)
def test_examples_are_short_and_tested(path: Path) -> None:
    assert path.read_text(encoding="utf-8").count("\n") <= LONGEST
    assert f'"{path.name}"' in Path(__file__).read_text(encoding="utf-8")


def test_a_rendered_balloon_is_tracked(run: Run) -> None:
    lines = run("track_rendered.py").lines
    assert len(lines) == 30
    assert all("±" in line for line in lines)


def test_a_clip_is_rendered(run: Run, tmp_path: Path) -> None:
    assert run("render_clip.py").lines
    assert (tmp_path / "ball.mp4").stat().st_size > 0
    assert (tmp_path / "ball.csv").read_text().startswith("video,frame,x,y,r")


@pytest.mark.parametrize(
    ("name", "taken"),
    [
        ("render_clip.py", "ball.mp4"),
        ("render_clip.py", "ball.csv"),
        ("render_flight.py", "camera.toml"),
        ("gym_random.py", "world1.png"),
    ],
)
def test_nothing_is_overwritten(run: Run, tmp_path: Path, name: str, taken: str) -> None:
    (tmp_path / taken).write_text("mine")
    result = run(name)
    assert result.code == 1
    words = f"error: {taken} exists and is not overwritten: go to another folder, or delete it\n"
    assert result.err == words
    assert [path.name for path in tmp_path.iterdir()] == [taken]
    assert (tmp_path / taken).read_text() == "mine"


def test_a_video_is_tracked(run: Run, tmp_path: Path) -> None:
    write_clip(Clip(frames=10), tmp_path / "ball.mp4")
    lines = run("track_video.py", "ball.mp4", "346", "151").lines
    assert len(lines) == 10
    assert all("radius" in line for line in lines)


def test_a_rectangle_is_tracked(run: Run) -> None:
    lines = run("track_rectangle.py").lines
    errors_px = [float(line.split("off by ")[1].removesuffix(" px")) for line in lines]
    assert len(errors_px) == 30
    assert sum(errors_px) / 30 < 0.7


def test_balls_that_cross_keep_their_identities(run: Run) -> None:
    lines = run("many_balls.py").lines
    assert len(lines) == 60
    assert all(set(re.findall(r"(\d+): ", line)) == {"0", "1", "2"} for line in lines[5:])


def test_coins_are_found(run: Run) -> None:
    assert len(run("detect_coins.py").lines) == 3


def test_a_printed_card_is_tracked(run: Run) -> None:
    lines = run("track_print.py").lines
    assert len(lines) == 30
    assert all("confirmed" in line for line in lines)


def test_the_gray_modes_are_compared(run: Run) -> None:
    dark, light, edges = run("begin_roughly.py").lines
    assert "lost" in dark
    for line in (light, edges):
        assert [float(each) for each in re.findall(r"[\d.]+", line)[:3]] == pytest.approx([160, 120, 40], abs=1.0)


def test_the_corners_of_a_mark_are_found(run: Run) -> None:
    (line,) = run("printed_mark.py").lines
    assert line.startswith("[[")


def test_a_shape_is_given_by_a_picture(run: Run) -> None:
    lines = run("shape_from_picture.py").lines
    assert [line.split("  ")[0] for line in lines] == ["x 150.0", "x 430.0"]


def test_a_missing_video_is_one_line(tmp_path: Path) -> None:
    words = [sys.executable, str(EXAMPLES / "track_video.py"), "nothing.mp4", "1", "1"]
    result = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, timeout=120, check=False)
    assert (result.returncode, result.stderr) == (1, "error: no such file: nothing.mp4\n")


def test_the_balls_of_a_picture_are_found(run: Run) -> None:
    lines = run("detect_picture.py").lines
    found = sorted(float(x) for x in re.findall(r"x ([\d.]+)", "\n".join(lines)))
    assert found == pytest.approx([150.0, 420.0, 500.0], abs=0.3)


def test_colors_are_given_as_hsv(run: Run) -> None:
    red, blue, either = run("color_from_hsv.py").lines
    assert red.endswith("found at (100.0, 120.0)")
    assert blue.endswith("found at (230.0, 120.0)")
    assert "(100.0, 120.0)" in either
    assert "(230.0, 120.0)" in either


def test_without_a_camera_the_reason_is_said(run: Run) -> None:
    result = run("own_loop_camera.py", "99")
    assert result.code == 1
    assert result.err.startswith("cannot open camera 99")
    assert "Traceback" not in result.err


def test_a_rendered_balloon_is_placed(run: Run) -> None:
    lines = run("locate_rendered.py").lines
    errors_mm = [float(line.split("error ")[1].removesuffix(" mm")) for line in lines]
    assert len(errors_mm) == 20
    assert max(errors_mm) < 60.0
    assert sorted(errors_mm)[10] < 10.0


def test_the_rotation_of_a_rendered_balloon_is_found(run: Run) -> None:
    lines = run("markers_rendered.py").lines
    assert len(lines) == 15
    assert all("full:" in line and float(line.split("off by ")[1].removesuffix("°")) < 3.0 for line in lines)


def test_a_predicted_pose_is_nearer_to_the_truth(run: Run) -> None:
    plain, ahead = (float(re.findall(r"([\d.]+) mm", line)[0]) for line in run("predict_pose.py").lines)
    assert ahead < 0.7 * plain


def test_a_simulated_neighbor_is_measured(run: Run) -> None:
    lines = run("simulated_world.py").lines
    off_mm = [float(line.split("off ")[1].removesuffix(" mm")) for line in lines]
    assert len(off_mm) == 30
    assert sorted(off_mm)[15] < 30.0


def test_a_place_is_held_in_the_environment(run: Run) -> None:
    *lines, last = run("gym_follow_pid.py").lines
    assert len(lines) == 10
    assert float(re.findall(r"by ([\d.]+) m rms", last)[0]) < 0.1


def test_random_sticks_end_on_the_floor(run: Run, tmp_path: Path) -> None:
    lines = run("gym_random.py").lines
    assert len(lines) == 2
    assert all("hit" in line and float(line.split("return ")[1]) < -1800.0 for line in lines)
    assert {path.name for path in tmp_path.iterdir()} == {"world0.png", "world1.png"}


def test_a_flight_is_rendered_and_located(run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    typed = run("render_flight.py").lines[-1].split()
    monkeypatch.setattr("sys.argv", [*typed, "-o", "out"])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    assert not ended.value.code
    poses = read_poses(tmp_path / "out" / "poses.csv")
    truth = [[float(cell) for cell in line.split(",")] for line in (tmp_path / "flight.csv").read_text().split()[1:]]
    assert [pose.frame for pose in poses] == [int(row[0]) for row in truth]
    for pose, (_, time, x, y, z) in zip(poses, truth, strict=True):
        assert pose.values is not None, pose.reason
        assert pose.observed == "level"
        assert pose.time == pytest.approx(time, abs=1e-3)
        assert [pose.values[name] for name in "xyz"] == pytest.approx([x, y, z], abs=0.05)
