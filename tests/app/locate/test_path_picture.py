"""The picture of a path: laid out well for paths of every kind, with the times at their places."""

import math
from collections.abc import Callable

import numpy as np
import numpy.typing as npt
import pytest

import matchset as ms
from matchset.app.locate.loop import LocatedFrame, PathLog
from matchset.app.locate.path_picture import coordinates_figure, path_picture, top_figure
from matchset.app.locate.rows import pose_row
from matchset.localization.pose import Pose
from matchset.tracking.track import Lost
from plot_layout import faults, texts

CAMERA = ms.CameraModel(width=640, height=480, fx=450.0, fy=450.0, cx=319.5, cy=239.5)


def wander(time: float) -> tuple[float, float, float]:
    return 0.7 * math.sin(1.1 * time), 0.2 * math.sin(1.9 * time), 1.9 + 0.6 * math.cos(1.4 * time)


def path_of(
    place: Callable[[float], tuple[float, float, float]], frames: int, lost: range = range(0), sigma: float = 2e-3
) -> PathLog:
    path = PathLog()
    ball: Lost[ms.Circle] = Lost("not looked for", 0.0)
    for index in range(frames):
        time, position = index / 30.0, np.array(place(index / 30.0))
        covariance = np.diag([sigma**2, (0.5 * sigma) ** 2, (4.0 * sigma) ** 2, *3 * [math.inf]])
        pose: Pose | Lost[Pose] = Pose(
            position=position, rotation_matrix=None, covariance=covariance, observed="position", time=time
        )
        if index in lost:
            pose = Lost("behind the sofa", time)
        path.append(LocatedFrame(None, ball, (), pose, pose_row(index, pose)))
    return path


PATHS = {
    "wandering": path_of(wander, 150),
    "with gaps": path_of(wander, 150, range(40, 60)),
    "a single place": path_of(wander, 1),
    "two frames": path_of(wander, 2),
    "found once": path_of(wander, 90, range(1, 90)),
    "at rest": path_of(lambda _: (0.1, 0.2, 3.0), 150),
    "on the axis": path_of(lambda time: (0.0, 0.0, 1.0 + time), 60),
    "long": path_of(lambda time: (math.sin(time), 0.1 * math.sin(3.0 * time), 40.0 + 5.0 * math.sin(2.0 * time)), 900),
    "near, and poor": path_of(lambda time: (0.02 * time, 0.0, 0.1), 30, sigma=0.05),
}


@pytest.mark.parametrize("name", sorted(PATHS))
def test_any_path_is_laid_out_well(name: str) -> None:
    for figure in (top_figure(PATHS[name], CAMERA), coordinates_figure(PATHS[name])):
        assert not faults(figure)


def test_times_stand_along_the_path_and_not_on_it() -> None:
    figure = top_figure(PATHS["wandering"], CAMERA)
    (axes,) = figure.axes
    places = axes.transData.transform(PATHS["wandering"].position[:, (0, 2)])
    boxes = dict(texts(figure))
    words = ["0 s", "1", "2", "3", "4", "4.97 s"]
    assert [each for each in boxes if each in words and each.endswith("s")] == ["0 s", "4.97 s"]
    annotated = {text.get_text(): text.get_window_extent() for text in axes.texts}
    for each in words:
        assert not annotated[each].count_contains(places)
        middle: npt.NDArray[np.float64] = np.array(annotated[each].get_points()).mean(axis=0)
        index = round(30.0 * float(each.removesuffix(" s")))
        assert np.hypot(*(places[index] - middle)) < 40.0


def test_the_picture_holds_both_figures() -> None:
    picture = path_picture(PATHS["wandering"], CAMERA)
    height, width = picture.shape[:2]
    assert 1400 < width < 1600
    assert 700 < height < 800
    for half in (picture[:, : width // 2], picture[:, width // 2 :]):
        assert (half < 200).any(axis=2).mean() > 0.01
