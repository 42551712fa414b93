"""The circle that is chosen, against looking for each one in all frames."""

import pytest

from matchset.app.guidance import choice
from matchset.app.guidance.choice import PARAMETERS
from matchset.image.candidates import Candidate
from matchset.sim.clips.clip import Clip

Ranked = tuple[float, int, Candidate]


def looked_for_everywhere(samples: list[choice._Sample], index: int | None) -> Ranked:
    """Rank, frame and circle of the ball, each circle that is tried being looked for in all frames."""
    chosen = [each for each in samples if index is None or each.frame.index == index]
    things = choice._things([(each, circle) for each in chosen for circle in each.circles])
    tried = [(*sample.separated(circle), sample) for sample, circle in things[: PARAMETERS.looked_at]]
    tried.sort(key=lambda each: -each[0])
    frames = [each.frame for each in samples]
    last = max(each.index for each in frames)
    ranked: list[Ranked] = []
    for clear, circle, sample in tried[: PARAMETERS.tried]:
        share = choice._found_again(sample.frame, circle, frames, lambda _: True)
        assert share is not None
        late = 1.0 - PARAMETERS.late * sample.frame.index / last
        ranked.append((clear * share * late, sample.frame.index, circle))
    return max(ranked, key=lambda each: each[0])


@pytest.mark.parametrize("index", [None, 0, 8])
def test_circles_that_are_left_out_would_not_have_been_chosen(index: int | None) -> None:
    frames = [frame for frame, _ in Clip(preset="typical", seed=11, frames=13)]
    samples = [choice._Sample(frame) for frame in frames[::4]]
    found = choice._likeliest(samples, index)
    assert found is not None
    rank, sample, circle = found
    assert (rank, sample.frame.index, circle) == looked_for_everywhere(samples, index)


def test_a_circle_that_cannot_be_good_enough_is_looked_for_nowhere(monkeypatch: pytest.MonkeyPatch) -> None:
    frame, _ = next(iter(Clip(preset="clean", seed=2, frames=1)))
    circle = choice._Sample(frame).circles[0]
    monkeypatch.setattr(choice, "detect", None)  # calling it would be a TypeError
    assert choice._found_again(frame, circle, [frame], lambda _: False) is None
