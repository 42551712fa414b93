"""`matchset warm` compiles all that a command may need: which kernels, and that they can be compiled as it says."""

import functools
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from blue_ball import Matchset
from matchset.app import warm
from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.shapes.circle import Circle
from matchset.shapes.ellipse import Ellipse
from matchset.shapes.quadrilateral import Quadrilateral
from matchset.shapes.rectangle import Rectangle

OTHERS = {
    "click": "matchset.tracking.tracker.Tracker",
    "localizer": "matchset.localization.localizer.Localizer",
    "markers": "matchset.localization.markers.marker_tracker.MarkerTracker",
    "neighbors": "matchset.localization.neighbors.neighbors.Neighbors",
    "pose filter": "matchset.localization.pose_filter.PoseFilter",
    "follower": "matchset.control.follower.Follower",
    "simulator": "matchset.links.simulated.SimulatedChain",
}
REAL = "circle", "pose filter"  # the other groups are run by `matchset warm` itself: minutes without kept kernels


class MadeError(Exception):
    """Raised in place of a constructor."""


def test_every_group_is_known() -> None:
    assert set(warm.groups()) == {*warm.FAMILIES, *OTHERS}
    assert all(callable(function) for function in warm.groups().values())


@pytest.mark.parametrize(
    ("name", "family", "parameters"),
    [
        ("circle", Circle, 3),
        ("ellipse", Ellipse, 5),
        ("rectangle", Rectangle, 5),
        ("quadrilateral", Quadrilateral, 8),
        ("polygon", None, 4),
        ("polygon, affine", None, 6),
    ],
)
def test_trackers_of_a_family_are_compiled_in_color_and_gray(
    name: str, family: type[Any] | None, parameters: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    trackers, frames, searches = [], [], []

    class FakeTracker:
        def __init__(self, family: type[Any], color: ColorModel, points: int = 64) -> None:
            trackers.append((family, color.channels, points))

        def update(self, frame: Frame) -> None:
            frames.append(frame.image.ndim)

    def fake_detect(frame: Frame, family: type[Any], color: ColorModel) -> None:
        searches.append((family, color.channels))

    monkeypatch.setattr("matchset.tracking.tracker.Tracker", FakeTracker)
    monkeypatch.setattr("matchset.tracking.detection.detect", fake_detect)
    warm.groups()[name]()
    assert [(channels, points) for _, channels, points in trackers] == [(3, 64), (3, 4096), (1, 64), (1, 4096)]
    assert all(family in (None, each) and len(each.parameters) == parameters for each, _, _ in trackers)
    assert searches == [each[:2] for each in trackers[::2]]
    assert set(frames) == {3, 2}


@pytest.mark.parametrize("name", OTHERS)
def test_every_other_group_makes_what_compiles_it(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def made(*arguments: Any, **options: Any) -> None:
        raise MadeError

    monkeypatch.setattr(OTHERS[name], made)
    with pytest.raises(MadeError):
        warm.groups()[name]()


@pytest.mark.parametrize("name", REAL)
def test_a_group_can_be_compiled(name: str) -> None:
    warm.groups()[name]()


def test_the_command_says_what_it_compiled_and_where_it_is_kept(
    matchset: Matchset, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    compiled: list[str] = []
    fakes = {name: functools.partial(compiled.append, name) for name in warm.groups()}
    monkeypatch.setattr(warm, "groups", lambda: fakes)
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    assert matchset("warm") == 0
    lines = capsys.readouterr().out.splitlines()
    assert compiled == [*warm.FAMILIES, *OTHERS]
    assert [line[:16].rstrip() for line in lines[:-1]] == compiled
    assert lines[-1].endswith(f"kept in {tmp_path}")


def test_a_light_target_is_white_in_the_picture() -> None:
    scores = warm._light().scores(np.array([[[40, 40, 40], [220, 220, 220]]], np.uint8)).ravel()
    assert scores[0] < 0 < scores[1]
