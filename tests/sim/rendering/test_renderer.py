import math

import numpy as np
import numpy.typing as npt
import pytest

from matchset.camera.camera_model import CameraModel
from matchset.sim.clips.balloon import Balloon
from matchset.sim.clips.occluder import bar_over, bar_width, board_over, visible_share
from matchset.sim.clips.truth import SphereOutline, sphere_outline
from matchset.sim.rendering.renderer import draw_balloon, draw_occluder
from matchset.sim.rendering.shutter import ShutterRows

CAMERA = CameraModel.from_fov(640, 480, 1.07)
BALLOON = Balloon()


def blank(value: float = 0.0) -> npt.NDArray[np.float32]:
    return np.full((CAMERA.height, CAMERA.width, 3), value, np.float32)


def coverage(positions: object, rows: ShutterRows | None = None) -> npt.NDArray[np.float64]:
    """Coverage of each pixel, from the same ball over black and over white."""
    black, white = blank(), blank(255.0)
    for picture in (black, white):
        draw_balloon(picture, CAMERA, BALLOON, positions, rows=rows or ShutterRows())  # type: ignore[arg-type]
    covered: npt.NDArray[np.float64] = 1.0 - (white - black)[..., 0].astype(float) / 255.0
    return covered


@pytest.mark.parametrize(
    "position", [(0.0, 0.0, 1.07), (0.3, 0.2, 1.2), (-0.5, 0.35, 1.5), (0.0, 0.0, 3.77), (1.4, 0.9, 3.0)]
)
def test_area_and_centroid_of_the_disc_are_exact(position: tuple[float, float, float]) -> None:
    outline = sphere_outline(CAMERA, position, BALLOON.radius)
    covered = coverage([position])
    y, x = np.mgrid[: CAMERA.height, : CAMERA.width]
    area = covered.sum()
    assert math.sqrt(area / math.pi) == pytest.approx(math.sqrt(outline.a * outline.b), abs=0.01)
    assert (covered * x).sum() / area == pytest.approx(outline.x, abs=0.01)
    assert (covered * y).sum() / area == pytest.approx(outline.y, abs=0.01)


def test_a_ball_of_four_px_is_still_true() -> None:
    outline = sphere_outline(CAMERA, (0.5, 0.4, 19.0), BALLOON.radius)
    area = coverage([(0.5, 0.4, 19.0)]).sum()
    assert math.sqrt(area / math.pi) == pytest.approx(math.sqrt(outline.a * outline.b), abs=0.02)


def test_motion_blur_is_the_mean_of_the_sub_exposures() -> None:
    path = [(0.05 * i, 0.0, 1.5) for i in range(3)]
    mean = np.mean([coverage([p]) for p in path], axis=0)
    np.testing.assert_allclose(coverage(path), mean, atol=1e-4)


def test_a_field_touches_only_its_own_rows() -> None:
    whole, upper, lower = (
        coverage([(0.1, 0.1, 1.2)]),
        *(coverage([(0.1, 0.1, 1.2)], ShutterRows(start, 2)) for start in (0, 1)),
    )
    assert not upper[1::2].any()
    assert not lower[0::2].any()
    np.testing.assert_array_equal(upper + lower, whole)


def test_the_ball_is_blue_with_a_purple_marker_that_faces_the_camera() -> None:
    picture = blank(128.0)
    draw_balloon(picture, CAMERA, BALLOON, [(0.0, 0.0, 1.0)])
    blue, green, red = picture[240, 320]
    assert min(blue, red) > green + 30.0
    blue, green, red = picture[240, 285]
    assert blue > green + 50.0
    assert blue > red + 80.0


def test_a_marker_can_point_away() -> None:
    away, without = blank(), blank()
    draw_balloon(away, CAMERA, Balloon(marker=(0.0, 0.0, 1.0)), [(0.0, 0.0, 1.0)])
    draw_balloon(without, CAMERA, Balloon(marker_radius=0.0), [(0.0, 0.0, 1.0)])
    np.testing.assert_array_equal(away, without)


@pytest.mark.parametrize("share", [0.1, 0.2, 0.5])
def test_a_stick_covers_the_share_it_is_built_for(share: float) -> None:
    outline = sphere_outline(CAMERA, (0.2, 0.1, 1.3), BALLOON.radius)
    assert visible_share(outline, CAMERA, []) == 1.0
    assert visible_share(outline, CAMERA, [bar_over(outline, share, 1.9)]) == pytest.approx(1.0 - share, abs=0.012)
    picture = blank()
    draw_occluder(picture, [bar_over(outline, share, 1.9)])
    covered = coverage([(0.2, 0.1, 1.3)])
    assert (covered * (picture[..., 0] > 0.0)).sum() / covered.sum() == pytest.approx(share, abs=0.03)


def test_a_board_hides_everything() -> None:
    outline = sphere_outline(CAMERA, (0.2, 0.1, 1.3), BALLOON.radius)
    assert visible_share(outline, CAMERA, [board_over(outline)]) == 0.0


def test_a_disc_half_out_of_the_picture_is_half_visible() -> None:
    outline = SphereOutline(x=639.5, y=200.0, a=50.0, b=40.0, angle=0.7, projected_x=639.5, projected_y=200.0)
    assert visible_share(outline, CAMERA, []) == pytest.approx(0.5, abs=0.01)


def test_misuse() -> None:
    with pytest.raises(ValueError, match=r"0\.1"):
        draw_balloon(blank(), CAMERA, BALLOON, [(0.0, 0.0, 0.1)])
    with pytest.raises(ValueError, match="float64"):
        draw_balloon(blank().astype(float), CAMERA, BALLOON, [(0.0, 0.0, 1.0)])
    with pytest.raises(ValueError, match=r"\(1, 2\)"):
        draw_balloon(blank(), CAMERA, BALLOON, [(0.0, 1.0)])
    with pytest.raises(ValueError, match=r"1\.5"):
        bar_width(1.5, 0.0)
    with pytest.raises(ValueError, match="-1"):
        Balloon(radius=-1.0)
    with pytest.raises(ValueError, match=r"0\.2"):
        Balloon(marker_radius=0.2)
    with pytest.raises(ValueError, match="length 1"):
        Balloon(marker=(1.0, 1.0, 0.0))
