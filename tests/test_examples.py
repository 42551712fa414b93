"""Every example runs as it stands, in an empty folder."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from matchset.app.films.clip_export import write_clip
from matchset.app.locate.rows import read_poses
from matchset.sim.clips.clip import Clip

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
LONGEST = 40  # lines


def run(folder: Path, name: str, *words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, str(EXAMPLES / name), *words],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )


def lines_of(result: subprocess.CompletedProcess[str]) -> list[str]:
    assert result.returncode == 0, result.stderr
    return result.stdout.splitlines()


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.py")), ids=lambda path: path.stem)
def test_examples_are_short_and_tested(path: Path) -> None:
    assert path.read_text(encoding="utf-8").count("\n") <= LONGEST
    assert f'"{path.name}"' in Path(__file__).read_text(encoding="utf-8")


def test_a_rendered_balloon_is_tracked(tmp_path: Path) -> None:
    lines = lines_of(run(tmp_path, "track_rendered.py"))
    assert len(lines) == 30
    assert all("±" in line for line in lines)


def test_a_clip_is_rendered(tmp_path: Path) -> None:
    lines_of(run(tmp_path, "render_clip.py"))
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
def test_nothing_is_overwritten(tmp_path: Path, name: str, taken: str) -> None:
    (tmp_path / taken).write_text("mine")
    result = run(tmp_path, name)
    assert result.returncode == 1
    words = f"error: {taken} exists and is not overwritten: go to another folder, or delete it\n"
    assert result.stderr == words
    assert [path.name for path in tmp_path.iterdir()] == [taken]
    assert (tmp_path / taken).read_text() == "mine"


def test_a_video_is_tracked(tmp_path: Path) -> None:
    write_clip(Clip(frames=10), tmp_path / "ball.mp4")
    lines = lines_of(run(tmp_path, "track_video.py", "ball.mp4", "346", "151"))
    assert len(lines) == 10
    assert all("radius" in line for line in lines)


def test_a_rectangle_is_tracked(tmp_path: Path) -> None:
    lines = lines_of(run(tmp_path, "track_rectangle.py"))
    errors_px = [float(line.split("off by ")[1].removesuffix(" px")) for line in lines]
    assert len(errors_px) == 30
    assert sum(errors_px) / 30 < 0.7


def test_coins_are_found(tmp_path: Path) -> None:
    assert len(lines_of(run(tmp_path, "detect_coins.py"))) == 3


def test_a_printed_card_is_tracked(tmp_path: Path) -> None:
    lines = lines_of(run(tmp_path, "track_print.py"))
    assert len(lines) == 30
    assert all("confirmed" in line for line in lines)


def test_the_gray_modes_are_compared(tmp_path: Path) -> None:
    dark, light, edges = lines_of(run(tmp_path, "begin_roughly.py"))
    assert "lost" in dark
    for line in (light, edges):
        assert [float(each) for each in re.findall(r"[\d.]+", line)[:3]] == pytest.approx([160, 120, 40], abs=1.0)


def test_the_corners_of_a_mark_are_found(tmp_path: Path) -> None:
    (line,) = lines_of(run(tmp_path, "printed_mark.py"))
    assert line.startswith("[[")


def test_a_shape_is_given_by_a_picture(tmp_path: Path) -> None:
    lines = lines_of(run(tmp_path, "shape_from_picture.py"))
    assert [line.split("  ")[0] for line in lines] == ["x 150.0", "x 430.0"]


def test_a_missing_video_is_one_line(tmp_path: Path) -> None:
    result = run(tmp_path, "track_video.py", "nothing.mp4", "1", "1")
    assert (result.returncode, result.stderr) == (1, "error: no such file: nothing.mp4\n")


def test_the_balls_of_a_picture_are_found(tmp_path: Path) -> None:
    lines = lines_of(run(tmp_path, "detect_picture.py"))
    found = sorted(float(x) for x in re.findall(r"x ([\d.]+)", "\n".join(lines)))
    assert found == pytest.approx([150.0, 420.0, 500.0], abs=0.3)


def test_colors_are_given_as_hsv(tmp_path: Path) -> None:
    red, blue, either = lines_of(run(tmp_path, "color_from_hsv.py"))
    assert red.endswith("found at (100.0, 120.0)")
    assert blue.endswith("found at (230.0, 120.0)")
    assert "(100.0, 120.0)" in either
    assert "(230.0, 120.0)" in either


def test_without_a_camera_the_reason_is_said(tmp_path: Path) -> None:
    result = run(tmp_path, "own_loop_camera.py", "99")
    assert result.returncode == 1
    assert result.stderr.startswith("cannot open camera 99")
    assert "Traceback" not in result.stderr


def test_a_rendered_balloon_is_placed(tmp_path: Path) -> None:
    lines = lines_of(run(tmp_path, "locate_rendered.py"))
    errors_mm = [float(line.split("error ")[1].removesuffix(" mm")) for line in lines]
    assert len(errors_mm) == 20
    assert max(errors_mm) < 60.0
    assert sorted(errors_mm)[10] < 10.0


def test_the_rotation_of_a_rendered_balloon_is_found(tmp_path: Path) -> None:
    lines = lines_of(run(tmp_path, "markers_rendered.py"))
    assert len(lines) == 15
    assert all("full:" in line and float(line.split("off by ")[1].removesuffix("°")) < 3.0 for line in lines)


def test_a_predicted_pose_is_nearer_to_the_truth(tmp_path: Path) -> None:
    plain, ahead = (float(re.findall(r"([\d.]+) mm", line)[0]) for line in lines_of(run(tmp_path, "predict_pose.py")))
    assert ahead < 0.7 * plain


def test_a_simulated_neighbor_is_measured(tmp_path: Path) -> None:
    lines = lines_of(run(tmp_path, "simulated_world.py"))
    off_mm = [float(line.split("off ")[1].removesuffix(" mm")) for line in lines]
    assert len(off_mm) == 30
    assert sorted(off_mm)[15] < 30.0


def test_a_place_is_held_in_the_environment(tmp_path: Path) -> None:
    *lines, last = lines_of(run(tmp_path, "gym_follow_pid.py"))
    assert len(lines) == 10
    assert float(re.findall(r"by ([\d.]+) m rms", last)[0]) < 0.1


def test_random_sticks_end_on_the_floor(tmp_path: Path) -> None:
    lines = lines_of(run(tmp_path, "gym_random.py"))
    assert len(lines) == 2
    assert all("hit" in line and float(line.split("return ")[1]) < -1800.0 for line in lines)
    assert {path.name for path in tmp_path.iterdir()} == {"world0.png", "world1.png"}


def test_a_flight_is_rendered_and_located(tmp_path: Path) -> None:
    lines = lines_of(run(tmp_path, "render_flight.py"))
    words = lines[-1].split()[1:]
    subprocess.run([sys.executable, "-m", "matchset.app.cli", *words, "-o", "out"], cwd=tmp_path, check=True)
    poses = read_poses(tmp_path / "out" / "poses.csv")
    truth = [[float(cell) for cell in line.split(",")] for line in (tmp_path / "flight.csv").read_text().split()[1:]]
    assert [pose.frame for pose in poses] == [int(row[0]) for row in truth]
    for pose, (_, time, x, y, z) in zip(poses, truth, strict=True):
        assert pose.values is not None, pose.reason
        assert pose.observed == "level"
        assert pose.time == pytest.approx(time, abs=1e-3)
        assert [pose.values[name] for name in "xyz"] == pytest.approx([x, y, z], abs=0.05)
