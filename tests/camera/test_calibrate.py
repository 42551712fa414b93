import msgspec
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import matchset as ms
from boards import BoardCamera, Floats, exact_view, poses
from matchset.camera.board import Board, BoardFinder, BoardView
from matchset.camera.calibrate import Calibration, calibrate
from matchset.camera.calibration_report import grade_calibration
from matchset.camera.view_selection import ViewSelectionParameters, select_views

CAMERA = ms.CameraModel(
    width=640, height=480, fx=450.0, fy=452.0, cx=323.0, cy=236.0, distortion=(-0.3, 0.11, 0.001, -0.0005, -0.01)
)
CHESS = Board(columns=9, rows=6, square=0.025)
CHARUCO = Board(columns=9, rows=6, square=0.025, marker=0.018)


def exact_views(count: int, seed: int, noise: float = 0.1) -> list[BoardView]:
    chosen = poses(CAMERA, CHESS, count, seed)
    return [exact_view(CAMERA, CHESS, pose, 1000 * seed + i, noise) for i, pose in enumerate(chosen)]


def ray_error(camera: ms.CameraModel) -> float:
    """Rms angle between found and true rays over the middle nine tenths of the picture, in px of the middle.

    A turn of the camera as a whole is taken out: no picture of a board tells it from a turn of the boards.
    """
    x, y = np.meshgrid(np.linspace(32.0, 607.0, 15), np.linspace(24.0, 455.0, 11))
    pixels = np.column_stack((x.ravel(), y.ravel()))
    found, true = camera.rays(pixels), CAMERA.rays(pixels)
    turn, _ = Rotation.align_vectors(true, found)
    return float(450.0 * np.sqrt(((turn.apply(found) - true) ** 2).sum(axis=1).mean()))


@pytest.mark.parametrize(("board", "focal", "rays", "error"), [(CHESS, 0.5, 0.25, 0.06), (CHARUCO, 1.5, 0.6, 0.2)])
def test_a_rendered_barrel_lens_is_recovered(board: Board, focal: float, rays: float, error: float) -> None:
    camera, finder = BoardCamera(CAMERA, board), BoardFinder(board)
    views = []
    for index, pose in enumerate(poses(CAMERA, board, 16, seed=101)):
        view = finder.find(ms.Frame(camera.picture(*pose, seed=index), 0.0, index))
        if isinstance(view, BoardView):
            views.append(view)
    assert len(views) >= 13
    calibration = calibrate(select_views(views, 640), 640, 480)
    assert calibration.error < error
    assert calibration.camera.intrinsics[:2] == pytest.approx(CAMERA.intrinsics[:2], abs=focal)
    assert calibration.camera.intrinsics[2:4] == pytest.approx(CAMERA.intrinsics[2:4], abs=2.0 * focal)
    assert calibration.camera.distortion[0] == pytest.approx(-0.3, abs=0.01)
    assert ray_error(calibration.camera) < rays


def test_the_covariance_is_honest() -> None:
    """Normalized error squared of the nine numbers over 20 calibrations: the mean of chi-square is 9."""
    values = []
    for seed in range(100, 120):
        camera = calibrate(exact_views(12, seed), 640, 480).camera
        error = camera.intrinsics - CAMERA.intrinsics
        assert camera.covariance is not None
        values.append(float(error @ np.linalg.solve(camera.covariance, error)))
    assert 6.0 < np.mean(values) < 13.0


def test_a_view_that_does_not_fit_is_left_out() -> None:
    views = exact_views(14, 3)
    bad = msgspec.structs.replace(views[4], pixels=views[4].pixels + np.linspace(0.0, 25.0, 54)[:, None] ** 2 / 60.0)
    views[4] = bad
    calibration = calibrate(views, 640, 480)
    assert [view.index for view in calibration.left_out] == [bad.index]
    assert calibration.camera.fx == pytest.approx(450.0, abs=3.0)
    assert "1 left out" in grade_calibration(calibration).findings[1].words


def facing(offsets: list[tuple[float, float, float]]) -> list[BoardView]:
    chosen: list[tuple[Rotation, Floats]] = [(Rotation.identity(), np.array(offset)) for offset in offsets]
    return [exact_view(CAMERA, CHESS, pose, i, 0.1) for i, pose in enumerate(chosen)]


def test_refusals_are_in_words() -> None:
    with pytest.raises(ValueError, match="0 different views of the board: at least 6 are needed"):
        calibrate([], 640, 480)
    with pytest.raises(ValueError, match="1 different view of the board: at least 6"):
        calibrate(exact_views(1, 1), 640, 480)
    with pytest.raises(ValueError, match="5 different views"):
        calibrate(exact_views(5, 1), 640, 480)
    moved = [(0.02 * i, 0.015 * j, 0.4 + 0.1 * i) for i in (-1, 0, 1) for j in (-1, 0, 1)]
    with pytest.raises(ValueError, match="too similar"):
        calibrate(facing(moved), 640, 480)
    with pytest.raises(ValueError, match="too similar"):
        calibrate(facing([(0.0, 0.0, 0.4)] * 9), 640, 480)
    with pytest.raises(ValueError, match="is the board flat"):
        calibrate(exact_views(12, 1, noise=6.0), 640, 480)


def test_nonsense_is_refused_in_words() -> None:
    """Corners that belong to no board: refused, never a camera with impossible numbers."""
    rng = np.random.default_rng(0)
    for spread in (0.0, 1.0, 300.0):
        places = exact_views(1, 1)[0]
        views = [
            msgspec.structs.replace(places, pixels=200.0 + rng.normal(0.0, 1.0, (54, 2)) * spread, index=i)
            for i in range(8)
        ]
        with pytest.raises(ValueError, match=r"view|corners"):
            calibrate(views, 640, 480)


def test_views_of_a_video_are_thinned() -> None:
    """A hand that pauses, shakes and moves on: alike and blurred views go, the sharper of two stays."""
    rng = np.random.default_rng(0)
    views = []
    for number, view in enumerate(exact_views(20, 5)):
        for repeat in range(4):
            pixels = view.pixels + rng.normal(0.0, 1.0, 2)
            views.append(BoardView(view.corners, view.points, pixels, 1.0 + 0.05 * repeat, 4 * number + repeat))
    views += [msgspec.structs.replace(view, blur=4.0, index=1000 + view.index) for view in exact_views(10, 6)]
    chosen = select_views(views, 640)
    assert len(chosen) <= 20
    assert len(chosen) >= 17
    assert all(view.index < 1000 and view.index % 4 == 0 for view in chosen)
    assert [view.index for view in chosen] == sorted(view.index for view in chosen)
    assert len(select_views(views, 640, ViewSelectionParameters(max_views=7))) == 7
    assert select_views([], 640) == []
    around = msgspec.structs.replace(views[0], pixels=views[0].pixels[::-1], index=1)
    assert len(select_views([views[0], around], 640)) == 1


def grades(calibration: Calibration) -> dict[str, str]:
    return {finding.name: finding.grade for finding in grade_calibration(calibration).findings}


def test_the_verdict_says_what_to_do() -> None:
    good = calibrate(exact_views(20, 13), 640, 480)
    assert grades(good) == dict.fromkeys(("error", "views", "coverage", "tilt", "numbers"), "good")
    assert grade_calibration(good).grade == "good"
    left = [view for view in exact_views(60, 2) if view.pixels[:, 0].max() < 420.0][:8]
    report = grade_calibration(calibrate(left, 640, 480))
    words = {finding.name: finding.words for finding in report.findings}
    assert report.grade in ("usable", "poor")
    assert "hold the board at the" in words["coverage"]
    assert "right" in words["coverage"]
    assert "12 are better" in words["views"]
    noisy = grade_calibration(calibrate(exact_views(20, 4, noise=0.9), 640, 480))
    assert noisy.findings[0].grade == "poor"
    assert "hold the board still" in noisy.findings[0].words
