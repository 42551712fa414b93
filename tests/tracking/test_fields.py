"""Fast balls over an interlaced link: its two fields show them at two places."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from benchmarks.contest.field import OURS, peer
from benchmarks.contest.run import follow_with_all
from benchmarks.tracking.trial import sequence

import matchset as ms
from matchset.app.track.score import error_px
from matchset.image.disc_network.network import Disc
from matchset.sim.clips.clip import Clip
from matchset.tracking.outlines.outline_choice import of_both_fields

SEED = 260


def errors(clip: Clip, wanted: Callable[[int], bool] = lambda _: True) -> list[float]:
    """Error (Eq. 10) in the frames that the tracker is given, px; infinite where it loses a ball well visible."""
    frames = (pair for pair in clip if wanted(pair[0].index))
    trial = follow_with_all(frames, None, [peer(OURS)], clip.seed)[OURS]
    return [
        error_px(answer, truth.circle) if answer else math.inf
        for truth, answer in zip(trial.truths, trial.answers, strict=True)
        if truth.tight and truth.circle
    ]


def test_twenty_pixels_a_frame_are_followed_to_a_pixel() -> None:
    found = errors(sequence("fast", SEED, 90))
    assert max(found) < 5.0
    assert np.mean(found) < 1.0


@pytest.mark.parametrize("wanted", [lambda k: k % 2 == 0, lambda k: k % 3 != 1], ids=["every second", "two of three"])
def test_frames_that_are_left_out_do_not_part_the_fields(wanted: Callable[[int], bool]) -> None:
    found = errors(sequence("typical", SEED, 90), wanted)
    assert max(found) < 5.0
    assert np.mean(found) < 0.6


def test_a_fast_ball_in_whole_frames_has_no_fields() -> None:
    found = errors(sequence("clean", SEED, 90, speed=2.0))
    assert max(found) < 1.0
    assert np.mean(found) < 0.25


@pytest.mark.parametrize(("name", "share"), [("fast", 0.5), ("clean", 0.0)])
def test_a_track_tells_how_far_its_fields_lie_apart(name: str, share: float) -> None:
    changes = {} if share else {"speed": 2.0}
    clip = sequence(name, SEED, 60, **changes)
    tracker, errors, before = None, [], None
    for frame, truth in clip:
        assert truth.circle is not None
        if tracker is None:
            color = ms.ColorModel.pick(frame.image, truth.circle.x, truth.circle.y)
            tracker = ms.Tracker(ms.Circle, color, start=(truth.circle.x, truth.circle.y))
        track = tracker.update(frame)
        if isinstance(track, ms.Track) and before is not None and frame.index > 20:
            way = truth.circle.state[:2] - before
            errors.append(math.hypot(*(np.abs(track.field_offset) - share * np.abs(way)).tolist()))
        before = truth.circle.state[:2]
    assert np.median(errors) < 1.0


def test_of_a_disc_of_one_field_the_fit_is_believed_along_the_offset_and_not_across() -> None:
    disc = Disc((100.0, 80.0, 30.0), np.eye(3), 4.0)
    offset = np.array((0.0, 12.0))
    both = of_both_fields(disc, np.array((103.0, 86.0, 31.0)), offset)
    assert both.circle == (100.0, 86.0, 30.0)
    np.testing.assert_allclose(np.linalg.inv(both.precision), np.diag((1.0, 1.0 + 36.0, 1.0)))
    far = of_both_fields(disc, np.array((103.0, 95.0, 31.0)), offset)
    assert far.circle == (100.0, 86.0, 30.0)  # by half of it, no more
    assert of_both_fields(disc, np.array((103.0, 95.0, 31.0)), np.zeros(2)) is disc
