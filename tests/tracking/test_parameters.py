"""What a user sets in `TrackerParameters` is what every stage of the tracker goes by."""

import numpy as np
import pytest
from scenes import blue, run, scene

import matchset as ms
from matchset.fitting.evidence import EvidenceParameters
from matchset.fitting.fit_quality import QualityParameters
from matchset.fitting.match_set import MatchParameters
from matchset.fitting.validation import ValidationParameters
from matchset.tracking.parameters import TrackerParameters
from matchset.tracking.search.voting import SearchParameters

BALL = 150.0, 110.0, 30.0


def follow(parameters: TrackerParameters) -> list[ms.Track[ms.Circle] | ms.Lost[ms.Circle]]:
    return run(ms.Tracker(ms.Circle, blue(), parameters=parameters), [scene(BALL, seed=k) for k in range(3)])


@pytest.mark.parametrize(
    "parameters",
    [
        TrackerParameters(
            evidence=EvidenceParameters(unknown=99.0, present=99.0, here=99.0),
            validation=ValidationParameters(color_score=2.0),
        ),
        TrackerParameters(validation=ValidationParameters(detection_interior=1.1)),
        TrackerParameters(search=SearchParameters(whole_frame=False)),
        TrackerParameters(search=SearchParameters(share=9.0)),
        TrackerParameters(match=MatchParameters(threshold=2.0)),
    ],
)
def test_limits_that_nothing_meets_find_nothing(parameters: TrackerParameters) -> None:
    assert not any(follow(parameters))
    assert all(follow(TrackerParameters()))


def test_limits_of_a_track_and_of_a_detection_are_set_apart() -> None:
    answers = follow(TrackerParameters(validation=ValidationParameters(min_support=1.1), coast=0.0))
    assert bool(answers[0])  # a detection is not asked for its support
    twice = follow(TrackerParameters(quality=QualityParameters(covariance_inflation=2.3, field_share=0.0)))[0]
    once = follow(TrackerParameters(quality=QualityParameters(field_share=0.0)))[0]
    assert isinstance(once, ms.Track)
    assert isinstance(twice, ms.Track)
    floor = np.diag([0.01**2, 0.01**2, 0.05**2])
    np.testing.assert_allclose(twice.covariance - floor, 2.0 * (once.covariance - floor), rtol=1e-9, atol=1e-15)
