"""The bar of the real clip, where it is at hand; it is never copied into the repository."""

from pathlib import Path

import pytest
from benchmarks.real.clips import find_clips
from benchmarks.real.following import Recorder, follow
from benchmarks.real.scores import answers_on_absent
from benchmarks.real.starts import starts_of

DATA = Path(__file__).resolve().parents[2] / "shared" / "data"
NAME = "green_ball_hand"


@pytest.mark.skipif(not (DATA / NAME / "truth.csv").exists(), reason=f"the real clip is not here: {DATA / NAME}")
def test_a_ball_in_a_hand_is_followed_from_one_click() -> None:
    clip = next(clip for clip in find_clips(DATA)[0] if clip.name == NAME)
    recorder = Recorder(clip, starts_of(clip)[:1])
    for frame, answers in follow(clip, recorder.followers):
        recorder.take(frame.index, answers)
    (run,) = recorder.runs()
    result = run.score(clip)
    assert result.mean_error_px is not None
    assert result.valid_percent is not None
    assert result.mean_error_px <= 1.5
    assert result.valid_percent >= 95.0
    assert result.absent
    assert answers_on_absent(run, clip) == 0
