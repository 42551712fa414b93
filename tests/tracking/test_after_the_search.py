"""A fit that ends outside the gate with little evidence is taken where a search found nothing better."""

from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
import pytest

import matchset as ms
from matchset.fitting.evidence import EvidenceParameters
from matchset.fitting.fitter import Fitter
from matchset.tracking.outlines.network_outlines import NetworkParameters
from matchset.tracking.parameters import TrackerParameters
from matchset.tracking.search.color_disc import ColorDiscParameters
from matchset.tracking.search.template import TemplateParameters
from matchset.tracking.tracker import Tracker

Picture = npt.NDArray[np.uint8]
EVIDENCE = EvidenceParameters()
BY_LOOKS_NEVER = TemplateParameters(largest_px=0.0)
STILL, JUMP = 5, 12.0  # frames at rest, px in the frame after


def picture(x: float) -> Picture:
    rows, columns = np.indices((240, 320))
    image = np.random.default_rng(3).normal(130.0, 3.0, (240, 320, 3))
    image[np.hypot(columns - x, rows - 120.0) < 14.0] = (60.0, 180.0, 70.0)
    return cv2.GaussianBlur(np.clip(image, 0, 255).astype(np.uint8), (0, 0), 0.8).astype(np.uint8)


def rested() -> Tracker[ms.Circle]:
    """Tracker of a ball that has been at rest, and that is known by its outline alone."""
    image = picture(150.0)
    outline_alone = TrackerParameters(
        color_disc=ColorDiscParameters(least=9.0), template=BY_LOOKS_NEVER, network=NetworkParameters(used=False)
    )
    color = ms.ColorModel.pick(image, 150.0, 120.0)
    tracker = ms.Tracker(ms.Circle, color, start=(150.0, 120.0), parameters=outline_alone)
    for index in range(STILL):
        assert tracker.update(ms.Frame(image, index / 30.0, index))
    return tracker


def weak(monkeypatch: pytest.MonkeyPatch, evidence: float) -> None:
    """Let all fits have the same evidence."""
    weigh = Fitter.weigh

    def weighed(self: Fitter[Any], *arguments: Any) -> Any:
        estimate = weigh(self, *arguments)
        return estimate if estimate.evidence is None else estimate._replace(evidence=evidence)

    monkeypatch.setattr(Fitter, "weigh", weighed)


@pytest.mark.parametrize(
    ("evidence", "found"),
    [(EVIDENCE.followed + 0.1, True), (EVIDENCE.followed - 0.1, False)],
)
def test_a_search_comes_first(monkeypatch: pytest.MonkeyPatch, evidence: float, found: bool) -> None:
    tracker, searches = rested(), []
    choose = Tracker._choose

    def noted(self: Tracker[Any], *arguments: Any) -> Any:
        searches.append(choose(self, *arguments))
        return searches[-1]

    monkeypatch.setattr(Tracker, "_choose", noted)
    weak(monkeypatch, evidence)
    answer = tracker.update(ms.Frame(picture(150.0 + JUMP), STILL / 30.0, STILL))
    assert searches == [None]
    assert bool(answer) is found
    if isinstance(answer, ms.Track):
        assert answer.shape.state[:3] == pytest.approx((150.0 + JUMP, 120.0, 14.0), abs=0.5)
        assert len(answer.match_set) > 32


def test_what_was_refused_is_not_taken_in_a_later_frame(monkeypatch: pytest.MonkeyPatch) -> None:
    tracker = rested()
    with monkeypatch.context() as patch:
        weak(patch, EVIDENCE.followed + 0.1)
        assert tracker.update(ms.Frame(picture(150.0 + JUMP), STILL / 30.0, STILL))
    empty = picture(-100.0)
    for index in range(STILL + 1, STILL + 4):
        assert not tracker.update(ms.Frame(empty, index / 30.0, index))


def test_a_fit_in_the_gate_needs_no_search(monkeypatch: pytest.MonkeyPatch) -> None:
    tracker = rested()
    monkeypatch.setattr(Tracker, "_choose", None)  # so that a search would fail
    assert tracker.update(ms.Frame(picture(152.0), STILL / 30.0, STILL))
