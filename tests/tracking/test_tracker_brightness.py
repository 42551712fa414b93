"""How a level between dark and light is found and used can be said to a tracker."""

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import matchset as ms
from matchset.fitting.validation import Prior, Rejection, Validator
from matchset.image.brightness import BrightnessParameters, level_across, level_in
from matchset.tracking.constants import TrackerConstants
from matchset.tracking.parameters import TrackerParameters

ROWS, COLUMNS = np.indices((120, 160))
RADIUS = np.hypot(COLUMNS - 80, ROWS - 60)
IMAGE = np.where(RADIUS < 30, 60, 180).astype(np.uint8)
CIRCLE = ms.Circle(80.0, 60.0, 30.0)


def color_in(color: ms.ColorModel, brightness: BrightnessParameters, start: bool = False) -> npt.NDArray[np.float32]:
    """Log-odds with which a tracker finds the disc."""
    tracker = ms.Tracker(
        ms.Circle, color, parameters=TrackerParameters(constants=TrackerConstants(brightness=brightness))
    )
    if start:
        tracker.start(CIRCLE)
    assert isinstance(tracker.update(ms.Frame(IMAGE, 0.0, 0)), ms.Track)
    return tracker.color.log_odds


@pytest.mark.parametrize("start", [False, True])
def test_levels_per_unit_are_the_slope_of_the_table(start: bool) -> None:
    for levels in (12.0, 24.0):
        log_odds = color_in(ms.ColorModel.dark(), BrightnessParameters(levels_per_unit=levels), start)
        assert np.diff(log_odds).min() == pytest.approx(-1.0 / levels, rel=1e-4)


def test_edges_have_the_log_odds_that_are_said() -> None:
    for little in (1e-2, 2e-2):
        log_odds = color_in(ms.ColorModel.edges(), BrightnessParameters(edges_log_odds=little), start=True)
        assert log_odds == pytest.approx(little)


def test_a_search_by_edges_uses_them_too() -> None:
    dark, light = ms.ColorModel.edges().search_models(IMAGE, BrightnessParameters(levels_per_unit=48.0))
    assert np.diff(dark.log_odds).min() == pytest.approx(-1.0 / 48.0, rel=1e-4)
    assert np.diff(light.log_odds).max() == pytest.approx(1.0 / 48.0, rel=1e-4)


def test_both_sides_of_an_outline_are_read_where_it_is_said() -> None:
    image = np.rint(2.0 * RADIUS).astype(np.uint8)
    turns = np.linspace(0.0, 2.0 * np.pi, 64, endpoint=False)
    points = np.stack((80 + 20 * np.cos(turns), 60 + 20 * np.sin(turns)), axis=1)
    for inner, outer in ((0.8, 1.25), (0.5, 1.1)):
        level = level_across(image, points, 80.0, 60.0, BrightnessParameters(inner=inner, outer=outer))
        assert level == pytest.approx(20.0 * (inner + outer), abs=1.0)


def test_a_level_is_computed_from_so_many_rows_and_columns() -> None:
    image = np.full((120, 160), 200, np.uint8)
    image[1::2] = 40  # seen only by those who look at every row
    image[:, :80] -= 20
    assert 40.0 < level_in(image) < 180.0 < level_in(image, BrightnessParameters(samples=60)) < 200.0


@pytest.mark.parametrize(("dark", "expected"), [(True, {Prior.NONE}), (False, {Prior.NONE, Prior.PRESENT})])
def test_after_a_loss_brightness_alone_is_no_reason_to_expect_the_shape(
    monkeypatch: pytest.MonkeyPatch, dark: bool, expected: set[Prior]
) -> None:
    asked, validate = [], Validator.validate_detection

    def noted(self: Validator, fit: Any, prior: Prior = Prior.PRESENT, evidence: float | None = None) -> Rejection:
        asked.append(prior)
        return validate(self, fit, prior, evidence)

    image = np.repeat(IMAGE[:, :, np.newaxis], 3, axis=2) + np.array([60, 0, 0], np.uint8)
    color = ms.ColorModel.dark() if dark else ms.ColorModel.pick(image, 80, 60)
    by_outlines = TrackerParameters(asks_network=False)
    tracker = ms.Tracker(ms.Circle, color, parameters=by_outlines)
    assert isinstance(tracker.update(ms.Frame(image, 0.0, 0)), ms.Track)
    assert isinstance(tracker.update(ms.Frame(np.full_like(image, 180), 5.0, 1)), ms.Lost)
    monkeypatch.setattr(Validator, "validate_detection", noted)
    assert isinstance(tracker.update(ms.Frame(image, 10.0, 2)), ms.Track)
    assert set(asked) == expected
