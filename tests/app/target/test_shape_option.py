"""`--shape` and `--gray`: what they read, what they refuse, and a run with them."""

import csv
from pathlib import Path

import cv2
import numpy as np
import pytest
from typer.testing import CliRunner

import matchset as ms
from matchset.app.target.shape_option import parse_shape
from matchset.cli import app
from matchset.shapes.shape import outline
from matchset.sim.rendering.coverage import draw_polygon

run = CliRunner().invoke


def test_names_corners_and_pictures(tmp_path: Path) -> None:
    assert parse_shape("circle") is ms.Circle
    assert parse_shape("Rectangle") is ms.Rectangle
    assert parse_shape("quadrilateral") is ms.Quadrilateral
    assert parse_shape("octagon").parameters == ("x", "y", "scale", "angle")
    assert len(parse_shape("0,0 4,0 0,3:affine").parameters) == 6
    picture = np.zeros((80, 100), np.uint8)
    cv2.ellipse(picture, (50, 40), (30, 20), 0, 0, 360, 255, -1)
    cv2.imwrite(str(tmp_path / "leaf.png"), picture)
    assert parse_shape(str(tmp_path / "leaf.png")).parameters == ("x", "y", "scale", "angle")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("blob", "or a picture file"),
        ("circle:affine", "has no ':affine'"),
        ("0,0 4,0 4,4 2,1", "convex"),
        ("octagon:affine2", "nothing follows"),
    ],
)
def test_what_is_no_shape_is_refused(text: str, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        parse_shape(text)


def write_video(path: Path, frames: int = 6) -> None:
    """A dark rectangle that turns on a light ground."""
    folder = path
    folder.mkdir()
    for index in range(frames):
        picture = np.full((240, 320, 3), (210, 205, 200), np.float32)
        corners = ms.Rectangle(150 + 2 * index, 120, 120, 70, 0.2 + 0.02 * index).corners
        draw_polygon(picture, [corners], (60, 50, 40))
        cv2.imwrite(str(folder / f"{index:03d}.png"), np.rint(picture).astype(np.uint8))


def test_a_dark_rectangle_is_written_by_its_parameters(tmp_path: Path) -> None:
    write_video(tmp_path / "video")
    words = ["track", str(tmp_path / "video"), "--shape", "rectangle", "--gray", "dark", "-o", str(tmp_path / "out")]
    result = run(app, [*words, "--video", str(tmp_path / "seen.webm")])
    assert result.exit_code == 0, result.output
    with (tmp_path / "out" / "tracks.csv").open() as table:
        rows = list(csv.DictReader(table))
    assert list(rows[0])[3:8] == ["x", "y", "width", "height", "angle"]
    assert "angle_std" in rows[0]
    assert [row["found"] for row in rows] == ["1"] * 6
    assert float(rows[-1]["width"]) == pytest.approx(120.0, abs=1.0)
    assert float(rows[-1]["angle"]) == pytest.approx(0.3, abs=0.01)
    assert (tmp_path / "seen.webm").stat().st_size > 0


@pytest.mark.parametrize("shape", ["circle", "ellipse", "quadrilateral", "0,0 4,0 0,3", "hexagon:affine", "picture"])
def test_every_family_is_tracked_from_the_command_line(tmp_path: Path, shape: str) -> None:
    outlines = {"circle": ms.Circle(0, 0, 45), "ellipse": ms.Ellipse(0, 0, 60, 40, 0.3)}
    if shape == "picture":  # of an egg, bright inside
        egg = ms.Convex.of(lambda t: 10.0 + 2.0 * np.cos(t) + 0.7 * np.cos(2.0 * t))
        drawing = np.zeros((300, 300, 3), np.float32)
        draw_polygon(drawing, [outline(egg(150.0, 150.0, 9.0, 0.0), 360)], (255, 255, 255))
        cv2.imwrite(str(tmp_path / "egg.png"), drawing.astype(np.uint8))
    name = str(tmp_path / "egg.png") if shape == "picture" else shape
    family = parse_shape(name)
    truth = outlines.get(shape) or family.from_coarse(0.0, 0.0, 50.0)
    (tmp_path / "video").mkdir()
    for index in range(3):
        picture = np.full((240, 320, 3), (210, 205, 200), np.float32)
        draw_polygon(picture, [np.add(outline(truth, 360), (150.0 + 2.0 * index, 120.0))], (60, 50, 40))
        cv2.imwrite(str(tmp_path / "video" / f"{index}.png"), np.rint(picture).astype(np.uint8))
    words = ["track", str(tmp_path / "video"), "--shape", name, "--gray", "dark", "-o", str(tmp_path / "out")]
    result = run(app, words)
    assert result.exit_code == 0, result.output
    with (tmp_path / "out" / "tracks.csv").open() as table:
        rows = list(csv.DictReader(table))
    assert list(rows[0])[3 : 3 + len(family.parameters)] == list(family.parameters)
    assert [row["found"] for row in rows] == ["1"] * 3
    moved = np.diff([[float(row[each]) for each in family.parameters] for row in rows], axis=0)
    assert np.abs(moved[:, 0] - 2.0).max() < 0.3


def test_a_wrong_gray_is_one_line(tmp_path: Path) -> None:
    write_video(tmp_path / "video", 1)
    result = run(app, ["track", str(tmp_path / "video"), "--gray", "pale"])
    assert result.exit_code == 2
    assert "--gray is dark, light or edges" in result.output
