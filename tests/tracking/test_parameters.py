"""What a user sets in `TrackerParameters` is what every stage of the tracker goes by."""

import math
import re
from typing import Any

import numpy as np
import pytest
from scenes import blue, run, scene

import matchset as ms
from matchset.fitting.evidence import EvidenceParameters
from matchset.fitting.fit_quality import QualityParameters
from matchset.fitting.match_set import MatchParameters
from matchset.fitting.validation import ValidationParameters
from matchset.tracking.ball.judge import NetworkParameters
from matchset.tracking.constants import TrackerConstants
from matchset.tracking.parameters import DIALS, TrackerParameters, value_at
from matchset.tracking.search.voting import SearchParameters

BALL = 150.0, 110.0, 30.0


def follow(parameters: TrackerParameters) -> list[ms.Track[ms.Circle] | ms.Lost[ms.Circle]]:
    return run(ms.Tracker(ms.Circle, blue(), parameters=parameters), [scene(BALL, seed=k) for k in range(3)])


def with_constants(**groups: Any) -> TrackerParameters:
    return TrackerParameters(coast=0.0, constants=TrackerConstants(**groups))


@pytest.mark.parametrize("dial", DIALS)
def test_each_dial_is_laid_into_the_constants(dial: str) -> None:
    path = DIALS[dial]
    default = value_at(TrackerConstants(), path)
    value = not default if isinstance(default, bool) else 2 * default if isinstance(default, int) else 0.5 * default
    dials: dict[str, Any] = {dial: value}
    constants = TrackerParameters(**dials).resolved()
    assert value_at(constants, path) == value
    assert TrackerParameters().resolved() == TrackerConstants()
    others = {other: value_at(constants, DIALS[other]) for other in DIALS if other != dial}
    assert others == {other: value_at(TrackerConstants(), DIALS[other]) for other in others}


def test_the_dials_are_twelve_at_most_and_each_says_what_a_user_sees() -> None:
    fields = TrackerParameters.__struct_fields__
    assert len(fields) <= 12
    assert set(fields) == {*DIALS, "constants"}


def test_a_dial_before_constants_of_ones_own_wins() -> None:
    own = TrackerConstants(network=NetworkParameters(looks=9, same=0.25))
    constants = TrackerParameters(looks=2, constants=own).resolved()
    assert (constants.network.looks, constants.network.same) == (2, 0.25)


@pytest.mark.parametrize(
    ("dials", "words"),
    [
        ({"coast": -0.1}, "coast must be 0 or more, got -0.1"),
        ({"coast": math.nan}, "coast must be a finite number, got nan"),
        ({"looks": 2.5}, "looks must be a whole number, 1 to 1000, got 2.5"),
        ({"looks": 0}, "looks must be a whole number, 1 to 1000, got 0"),
        ({"agility": 1.5}, "agility must be 1 or less, got 1.5"),
        ({"faint_score": 2.0}, "faint_score must be 1 or less, got 2.0"),
        ({"size_sigma": 0.0}, "size_sigma must be more than 0, got 0.0"),
    ],
)
def test_a_dial_out_of_its_range_is_refused(dials: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=re.escape(words)):
        TrackerParameters(**dials)


@pytest.mark.parametrize(
    "parameters",
    [
        TrackerParameters(
            constants=TrackerConstants(
                evidence=EvidenceParameters(unknown=99.0, present=99.0, here=99.0),
                validation=ValidationParameters(color_score=2.0),
            )
        ),
        TrackerParameters(constants=TrackerConstants(validation=ValidationParameters(detection_interior=1.1))),
        TrackerParameters(whole_frame=False),
        TrackerParameters(constants=TrackerConstants(search=SearchParameters(share=9.0))),
        TrackerParameters(constants=TrackerConstants(match=MatchParameters(threshold=2.0))),
    ],
)
def test_limits_that_nothing_meets_find_nothing(parameters: TrackerParameters) -> None:
    assert not any(follow(parameters))
    assert all(follow(TrackerParameters()))


def test_limits_of_a_track_and_of_a_detection_are_set_apart() -> None:
    answers = follow(with_constants(validation=ValidationParameters(min_support=1.1)))
    assert bool(answers[0])  # a detection is not asked for its support
    twice = follow(with_constants(quality=QualityParameters(covariance_inflation=2.3, field_share=0.0)))[0]
    once = follow(with_constants(quality=QualityParameters(field_share=0.0)))[0]
    assert isinstance(once, ms.Track)
    assert isinstance(twice, ms.Track)
    floor = np.diag([0.01**2, 0.01**2, 0.05**2])
    np.testing.assert_allclose(twice.covariance - floor, 2.0 * (once.covariance - floor), rtol=1e-9, atol=1e-15)
