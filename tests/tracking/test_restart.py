"""A tracker that was restarted answers as a new one, to the last bit."""

from typing import Any

import numpy as np
import pytest

import matchset as ms
from matchset.sim.clips.clip import Clip

Answers = list[tuple[float, ...] | str]


def followed(tracker: ms.Tracker[ms.Circle], clip: Clip) -> Answers:
    answers: Answers = []
    for frame, _ in clip:
        track = tracker.update(frame)
        if isinstance(track, ms.Track):
            numbers = track.shape.x, track.shape.y, track.shape.radius, track.support
            answers.append((*numbers, *track.covariance.ravel().tolist(), *track.match_set.ravel().tolist()))
        else:
            answers.append(track.reason)
    return answers


@pytest.mark.parametrize("hint", ["nothing", "a point", "a shape"])
def test_a_restarted_tracker_answers_as_a_new_one(hint: str) -> None:
    before, after = Clip(preset="bad", seed=3, frames=14), Clip(preset="typical", seed=4, frames=12)
    frame, truth = next(iter(after))
    assert truth.circle is not None
    color = ms.ColorModel.pick(frame.image, *after.first_click)
    hints: dict[str, Any] = {"nothing": None, "a point": after.first_click, "a shape": truth.circle}
    new: ms.Tracker[ms.Circle] = ms.Tracker(ms.Circle, color, start=hints[hint] if hint == "a point" else None)
    if hint == "a shape":
        new.start(truth.circle)
    used = ms.Tracker(ms.Circle, color)
    followed(used, before)
    used.restart(hints[hint])
    assert followed(used, after) == followed(new, after)
    np.testing.assert_array_equal(used.color.table, new.color.table)


def test_a_restart_forgets_the_kind_of_picture_and_the_time() -> None:
    image = np.full((120, 160, 3), 90, np.uint8)
    tracker = ms.Tracker(ms.Circle, ms.ColorModel.hsv((100, 100, 100), (130, 255, 255)))
    tracker.update(ms.Frame(image, 5.0, 0))
    tracker.restart()
    assert not tracker.update(ms.Frame(image[:100], 1.0, 0))


def test_misuse_of_a_restart_is_refused() -> None:
    tracker = ms.Tracker(ms.Circle, ms.ColorModel.dark())
    with pytest.raises(ValueError, match="finite"):
        tracker.restart((float("nan"), 3.0))
    with pytest.raises(ValueError, match="follows Circle"):
        tracker.restart(ms.Rectangle(1.0, 2.0, 3.0, 4.0, 0.0))  # type: ignore[arg-type]
