"""In the picture that was clicked, the circle around the click needs less evidence than anything else, anywhere."""

from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
import pytest

import matchset as ms
from matchset.fitting.evidence import EvidenceParameters
from matchset.fitting.fitter import Fitter
from matchset.fitting.validation import Prior, Rejection, Validator
from matchset.sim.clips.balloon import Balloon
from matchset.sim.clips.clip import Clip
from matchset.tracking.parameters import TrackerParameters
from matchset.tracking.tracker import Tracker

Picture = npt.NDArray[np.uint8]
EVIDENCE = EvidenceParameters()
BY_OUTLINE = TrackerParameters(asks_network=False)


def picture(*balls: tuple[float, float], radius: float = 14.0) -> Picture:
    rows, columns = np.indices((240, 320))
    image = np.random.default_rng(3).normal(130.0, 3.0, (240, 320, 3))
    for x, y in balls:
        image[np.hypot(columns - x, rows - y) < radius] = (60.0, 180.0, 70.0)
    return cv2.GaussianBlur(np.clip(image, 0, 255).astype(np.uint8), (0, 0), 0.8).astype(np.uint8)


def weak(monkeypatch: pytest.MonkeyPatch, evidence: float) -> None:
    """Let all fits have the same evidence."""
    weigh = Fitter.weigh

    def weighed(self: Fitter[Any], *arguments: Any) -> Any:
        estimate = weigh(self, *arguments)
        return estimate if estimate.evidence is None else estimate._replace(evidence=evidence)

    monkeypatch.setattr(Fitter, "weigh", weighed)


def tracker_at(x: float, y: float, image: Picture) -> Tracker[ms.Circle]:
    return ms.Tracker(ms.Circle, ms.ColorModel.pick(image, x, y), start=(x, y), parameters=BY_OUTLINE)


@pytest.mark.parametrize(("evidence", "found"), [(-0.9, True), (EVIDENCE.clicked - 0.1, False)])
def test_the_circle_around_a_click_needs_less_evidence(
    monkeypatch: pytest.MonkeyPatch, evidence: float, found: bool
) -> None:
    image = picture((150.0, 110.0))
    tracker = tracker_at(146.0, 112.0, image)
    weak(monkeypatch, evidence)
    track = tracker.update(ms.Frame(image, 0.0, 0))
    assert bool(track) is found
    if isinstance(track, ms.Track):
        assert track.shape.state[:3] == pytest.approx((150.0, 110.0, 14.0), abs=1.0)


def test_only_in_the_picture_that_was_clicked(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[Prior] = []
    validate = Validator.validate_detection

    def noted(self: Validator, fit: Any, prior: Prior = Prior.PRESENT, evidence: float | None = None) -> Rejection:
        asked.append(prior)
        return validate(self, fit, prior, evidence)

    image = picture((150.0, 110.0))
    tracker = tracker_at(146.0, 112.0, image)
    weak(monkeypatch, EVIDENCE.clicked - 0.1)
    monkeypatch.setattr(Validator, "validate_detection", noted)
    for index, clicked in enumerate((True, False)):
        asked.clear()
        assert not tracker.update(ms.Frame(image, index / 30.0, index))
        assert (Prior.CLICKED in asked) is clicked


def test_a_ball_elsewhere_is_not_what_was_clicked(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where nothing is found at the click, a ball far from it needs the evidence of one of which nothing is known."""
    clicked, shown = picture((60.0, 110.0)), picture((250.0, 110.0))
    for evidence, found in ((EVIDENCE.present + 0.5, False), (EVIDENCE.unknown + 0.5, True)):
        tracker = tracker_at(60.0, 110.0, clicked)
        with monkeypatch.context() as patch:
            weak(patch, evidence)
            patch.setattr(Validator, "_least_color_score", lambda *_: 2.0)  # so that evidence alone decides
            assert bool(tracker.update(ms.Frame(shown, 0.0, 0))) is found


def test_a_white_ball_before_a_gray_floor_is_learned_against_what_is_next_to_it() -> None:
    ball = Balloon(color=(225.0, 228.0, 230.0), marker_radius=0.0)
    frame, seen = next(iter(Clip(preset="clean", seed=2, frames=1, radii=(6.0, 16.0), balloon=ball)))
    assert seen.circle is not None
    click = seen.circle.x, seen.circle.y - 0.5 * seen.circle.radius
    color = ms.ColorModel.pick(frame.image, *click)
    answer = ms.Tracker(ms.Circle, color, start=click).update(frame)
    assert isinstance(answer, ms.Track)
    assert answer.shape.radius == pytest.approx(seen.circle.radius, rel=0.25)
    assert "next to it" in color.note
