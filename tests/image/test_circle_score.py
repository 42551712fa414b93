"""Of many circles the best ones, against scores of all of them."""

import numpy as np
import pytest

from matchset.image.candidates import propose_circles, smooth_lab
from matchset.image.circle_score import SCORE, best_circles, score_circle
from matchset.sim.clips.clip import Clip


@pytest.mark.parametrize("preset", ["clean", "typical", "bad"])
def test_the_best_circles_are_those_of_all_scores(preset: str) -> None:
    frame, _ = next(iter(Clip(preset=preset, seed=5, frames=1)))
    lab = smooth_lab(frame.image)
    circles = propose_circles(lab)
    scores = sorted(((score_circle(lab, each).whole, each) for each in circles), reverse=True)
    least = max(SCORE.min_score, SCORE.min_share * scores[0][0])
    expected = [each for each in scores if each[0] >= least]
    assert expected
    assert best_circles(lab, circles) == expected


def test_circles_outside_of_the_picture_and_none_at_all_are_no_candidates() -> None:
    lab = smooth_lab(np.zeros((60, 80, 3), np.uint8))
    assert best_circles(lab, []) == []
    assert best_circles(lab, [(-500.0, 20.0, 10.0), (40.0, 30.0, 900.0)]) == []
