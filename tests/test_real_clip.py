"""The bar of the real clip, where it is at hand; it is never copied into the repository."""

from pathlib import Path

import pytest
from benchmarks.tracking.real import CLICKS, first_good, follow_video

from matchset.app.track.score import read_truth, score

CLIP = Path(__file__).resolve().parents[2] / "shared" / "data" / "green_ball_hand"


@pytest.mark.skipif(not (CLIP / "truth.csv").exists(), reason=f"the real clip is not here: {CLIP}")
def test_a_ball_in_a_hand_is_followed_from_one_click() -> None:
    truths = read_truth(CLIP / "truth.csv")
    answers = follow_video(CLIP / "video.mp4", truths, CLICKS[0])
    result = score(answers, truths, start=first_good(truths).frame)
    assert result.mean_error_px is not None
    assert result.valid_percent is not None
    assert result.mean_error_px <= 1.5
    assert result.valid_percent >= 95.0
    absent = [truth.frame for truth in truths if truth.circle is None]
    assert absent
    assert [answers[frame] for frame in absent] == [None] * len(absent)
