"""Tracks for supervision: against a stand-in for the package, and the package itself where it is installed."""

import importlib.util
import sys
import types
from typing import Any

import msgspec
import numpy as np
import pytest

import matchset as ms

TRACK = ms.Track(ms.Circle(10.0, 20.0, 5.0), np.eye(3), 0.75, np.empty((0, 2)), 0.0)
OTHER = ms.Track(ms.Rectangle(30.0, 40.0, 8.0, 6.0, 0.0), np.eye(5), 1.0, np.empty((0, 2)), 0.0)
LOST: ms.Lost[Any] = ms.Lost("gone", 0.0)


class Detections:
    def __init__(self, **fields: Any) -> None:
        vars(self).update(fields)


@pytest.fixture(params=["stand-in", "installed"])
def package(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    if request.param == "stand-in":
        stand_in: Any = types.ModuleType("supervision")
        stand_in.Detections = Detections
        monkeypatch.setitem(sys.modules, "supervision", stand_in)
    elif importlib.util.find_spec("supervision") is None:
        pytest.skip("the package supervision is not installed")


@pytest.mark.usefixtures("package")
def test_boxes_confidence_and_identities() -> None:
    found = ms.to_supervision([TRACK, LOST, OTHER], tracker_id=[7, 8, 9])
    assert found.xyxy.tolist() == [[5.0, 15.0, 15.0, 25.0], [26.0, 37.0, 34.0, 43.0]]
    assert found.confidence.tolist() == [0.75, 1.0]
    assert found.class_id.tolist() == [0, 0]
    assert found.tracker_id.tolist() == [7, 9]


@pytest.mark.usefixtures("package")
def test_one_track_or_none() -> None:
    assert ms.to_supervision(TRACK).xyxy.shape == (1, 4)
    both: list[Any] = [LOST, []]
    for nothing in both:
        found = ms.to_supervision(nothing)
        assert found.xyxy.shape == (0, 4)
        assert found.tracker_id is None


@pytest.mark.usefixtures("package")
def test_misuse_is_refused_in_words() -> None:
    with pytest.raises(ValueError, match="one number for each of 1 tracks, got 2"):
        ms.to_supervision(TRACK, tracker_id=[1, 2])
    make: Any = ms
    with pytest.raises(TypeError, match="must be a Track or Lost, got Circle"):
        make.to_supervision([TRACK.shape])


@pytest.mark.usefixtures("package")
def test_a_family_without_a_box_has_one() -> None:
    class Own(msgspec.Struct, frozen=True):
        corners: Any

    own: Any = ms.Track(Own(np.array([(1.0, 2.0), (5.0, 3.0), (2.0, 9.0)])), np.eye(3), 1.0, np.empty((0, 2)), 0.0)
    assert ms.to_supervision(own).xyxy.tolist() == [[1.0, 2.0, 5.0, 9.0]]


def test_without_the_package_one_line_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "supervision", None)
    with pytest.raises(ImportError, match=r"pip install supervision$"):
        ms.to_supervision(TRACK)


@pytest.mark.usefixtures("package")
def test_targets_have_their_identities_and_labels() -> None:
    targets: list[ms.Target[Any]] = [
        ms.Target(4, "red", TRACK, 0.0),
        ms.Target(5, "red", LOST, 0.0),
        ms.Target(9, "blue", OTHER, 0.0),
    ]
    found = ms.to_supervision(targets)
    assert found.tracker_id.tolist() == [4, 9]
    assert found.data["class_name"].tolist() == ["red", "blue"]
    assert found.xyxy.tolist() == [[5.0, 15.0, 15.0, 25.0], [26.0, 37.0, 34.0, 43.0]]
    with pytest.raises(ValueError, match="identities of their own"):
        ms.to_supervision(targets, tracker_id=[1, 2, 3])
    with pytest.raises(TypeError, match="a track"):
        ms.to_supervision([TRACK, targets[0]])
    assert len(ms.to_supervision(targets[1:2]).xyxy) == 0
