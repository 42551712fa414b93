"""Clicks in a recorded video: the outline first, playback as far as it is tracked, and wrong clicks."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from live_videos import CLICK, FRAMES, NOTHING, Gate, center, go, opened, wait, written
from matchset.app.track.rows import read_tracks
from matchset.image.frame import Frame
from matchset.live.files.exports import KnownPart
from matchset.live.files.file_feed import FileFeed
from matchset.live.files.file_target import FileTarget
from matchset.live.files.messages import Correct, Export, Pause, Play, Step
from matchset.live.files.trials import TrialParameters, Trials
from matchset.live.targets.messages import Drop, Pick, Rename, Reread
from matchset.live.targets.target import BesideParameters
from matchset.live.wire.state import State
from matchset.media.exact_reader import InterruptedReadingError


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return written(tmp_path_factory.mktemp("video"))


@pytest.fixture
def notes() -> list[str]:
    return []


@pytest.fixture
def shown() -> list[State]:
    """The states of all pictures that were shown."""
    return []


@pytest.fixture
def feed(
    path: Path, notes: list[str], shown: list[State], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[FileFeed]:
    monkeypatch.chdir(tmp_path)
    made: list[FileFeed] = []
    with opened(path, notes, lambda _: shown.append(made[0].seen.state) if made else None) as feed:
        made.append(feed)
        wait(lambda: feed.frames.complete and feed.seen.frame is not None)
        yield feed


def answers(feed: FileFeed) -> dict[tuple[float, float], str]:
    """What became of clicks, by their places."""
    return {(each.x, each.y): each.words for each in feed.tracking.clicks.state.answered}


def test_the_outline_is_in_the_clicked_picture_first_then_it_plays_as_far_as_it_is_tracked(
    feed: FileFeed, shown: list[State]
) -> None:
    feed.ask(Pick(feed.seen.state.sequence, *center(0)))
    wait(lambda: not feed.player.playing and feed.seen.state.index == FRAMES - 1)
    assert answers(feed) == {center(0): ""}
    followed = [state for state in shown if state.targets and not state.targets[0].pending]
    assert followed[0].index == 0
    assert followed[0].targets[0].found
    first = shown.index(followed[0])
    assert all(state.index == 0 for state in shown[:first])
    assert all(state.targets[0].found for state in shown[first:])  # never a picture of which nothing was known yet
    indices = [state.index for state in shown]
    assert indices == sorted(indices)


def test_it_waits_for_a_slow_tracking_and_says_so(feed: FileFeed, monkeypatch: pytest.MonkeyPatch) -> None:
    gate = Gate(monkeypatch, 10)
    feed.ask(Pick(feed.seen.state.sequence, *center(0)))
    wait(lambda: feed.seen.state.index == 9)
    wait(lambda: (state := feed.panel.state()) is not None and state.playing and state.waiting)
    assert feed.seen.state.targets[0].found
    go(feed, 40)  # a person may look further on
    (target,) = feed.seen.state.targets
    assert (target.found, target.pending, target.reason) == (False, True, "not tracked here yet")
    feed.panel.take(Pause(), "")
    gate.open()
    wait(lambda: not feed.tracking.busy)
    wait(lambda: feed.seen.state.targets[0].found)


def test_a_click_while_it_plays_stops_it_until_that_is_found(feed: FileFeed, monkeypatch: pytest.MonkeyPatch) -> None:
    go(feed, 5)
    feed.panel.take(Play(), "")
    wait(lambda: feed.seen.state.index > 8)
    gate = Gate(monkeypatch, 0)
    state = feed.seen.state
    index = state.index
    feed.ask(Pick(state.sequence, *center(index)))
    wait(lambda: not feed.player.playing and feed.seen.state.index == index)
    gate.open()
    wait(lambda: feed.seen.state.targets and feed.seen.state.targets[0].found)
    wait(lambda: feed.seen.state.index > index)


def test_a_wrong_click_is_refused_and_does_not_play_the_video(feed: FileFeed, notes: list[str]) -> None:
    feed.ask(Pick(feed.seen.state.sequence, *NOTHING))
    wait(lambda: NOTHING in answers(feed))
    words = answers(feed)[NOTHING]
    assert words
    assert words in notes
    assert not feed.tracking.targets
    assert (feed.player.playing, feed.player.touched) == (False, False)
    feed.ask(Pick(feed.seen.state.sequence, *center(0)))
    wait(lambda: answers(feed).get(center(0)) == "")
    assert len(feed.tracking.targets) == 1


def test_a_wrong_click_blocks_no_other(feed: FileFeed, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Trials, "verdict", lambda _, run, _others: "" if run.target.number == 2 else None)
    sequence = go(feed, CLICK)
    feed.ask(Pick(sequence, center(CLICK)[0] + 20.0, center(CLICK)[1]))  # it would be tried for ever
    wait(lambda: feed.tracking.targets and feed.tracking.targets[1].known)
    feed.ask(Pick(sequence, *center(CLICK)))
    wait(lambda: answers(feed).get(center(CLICK)) == "")
    assert list(feed.tracking.targets) == [2]
    assert "next click" in answers(feed)[center(CLICK)[0] + 20.0, center(CLICK)[1]]


def test_a_trial_ends_after_a_time_and_a_click_far_from_what_is_found_is_none(feed: FileFeed) -> None:
    impatient = Trials(TrialParameters(patience=0.0))
    feed.tracking._trials = impatient
    feed.ask(Pick(go(feed, CLICK), *NOTHING))
    wait(lambda: NOTHING in answers(feed))
    beside = Trials(TrialParameters(beside=BesideParameters(rim=0.05)))
    feed.tracking._trials = beside
    near = center(CLICK)[0] + 6.0, center(CLICK)[1]
    feed.ask(Pick(go(feed, CLICK), *near))
    wait(lambda: near in answers(feed))
    assert "not where you clicked" in answers(feed)[near]


def test_a_video_that_was_gone_to_another_frame_begins_a_stretch(feed: FileFeed) -> None:
    go(feed, 10)
    stretch = feed.seen.state.stretch
    feed.panel.take(Step(1), "")
    wait(lambda: feed.seen.state.index == 11)
    assert feed.seen.state.stretch == stretch
    for index, changes in ((12, 0), (30, 1), (29, 1)):
        go(feed, index)
        stretch += changes
        assert feed.seen.state.stretch == stretch
    feed.panel.take(Play(), "")
    wait(lambda: feed.seen.state.index > 35)
    assert feed.seen.state.stretch == stretch


def test_the_mask_of_a_picture_that_was_shown_just_before_is_there(feed: FileFeed) -> None:
    feed.ask(Pick(go(feed, CLICK + 1), *center(CLICK + 1)))
    wait(lambda: feed.tracking.targets and not feed.tracking.busy)
    before = go(feed, CLICK)
    feed.panel.take(Step(1), "")
    wait(lambda: feed.seen.state.index == CLICK + 1)
    x, y = (round(each) for each in center(CLICK))
    mask = feed.mask(1, before)
    assert (mask[y, x], mask[10, 300]) == (255, 0)
    with pytest.raises(ValueError, match="not shown any more"):
        feed.mask(1, 10**6)


def test_tables_of_a_part_say_which_part(feed: FileFeed, monkeypatch: pytest.MonkeyPatch) -> None:
    gate = Gate(monkeypatch, 12)
    feed.ask(Pick(go(feed, CLICK), *center(CLICK)))
    wait(lambda: feed.tracking.targets and feed.tracking.targets[1].known == 12)
    (line,) = feed.panel.state().targets  # type: ignore[union-attr]
    assert line.part == "frames 25 to 36"
    feed.panel.take(Export(1, "tables"), "")
    wait(lambda: feed.exports.written)
    gate.open()
    (name,) = feed.panel.downloads()
    assert name == "tracks-1-frames-25-36.csv"
    assert [row.frame for row in read_tracks(feed.panel.downloads()[name])] == list(range(25, 37))
    wait(lambda: not feed.tracking.busy)
    assert feed.panel.state().targets[0].part == ""  # type: ignore[union-attr]
    feed.panel.take(Export(1, "tables"), "")
    wait(lambda: "tracks-1.csv" in feed.panel.downloads())


def test_a_click_on_a_ball_that_is_followed_is_refused_by_its_name(feed: FileFeed, notes: list[str]) -> None:
    feed.ask(Pick(go(feed, CLICK), *center(CLICK)))
    wait(lambda: feed.tracking.targets and not feed.tracking.busy)
    feed.ask(Rename(1, "left hand"))
    x, y = center(CLICK)
    feed.ask(Pick(go(feed, CLICK), x + 2.0, y))
    wait(lambda: (x + 2.0, y) in answers(feed))
    assert answers(feed)[x + 2.0, y] == "that is left hand, which is followed already"
    assert notes[-1] == "that is left hand, which is followed already"
    assert [each.name for each in feed.tracking.targets.values()] == ["left hand"]


def test_two_targets_on_one_outline_are_told_with_the_first_frame(feed: FileFeed) -> None:
    feed.ask(Pick(go(feed, CLICK), *center(CLICK)))
    wait(lambda: feed.tracking.targets and not feed.tracking.busy)
    assert feed.panel.state().same == ""  # type: ignore[union-attr]
    target = feed.tracking.targets[1]
    twin = FileTarget(2, Pick(1, *center(CLICK)), CLICK)  # such as one of another color
    for place in range(7, 12):
        twin.put(place, target.answer(place))  # type: ignore[arg-type]
    feed.tracking.targets = {1: target, 2: twin}
    words = "circle 1 and circle 2 are on one ball in 5 frames, first in frame 7: correct one of them there"
    assert feed.panel.state().same == words  # type: ignore[union-attr]


def test_a_part_with_gaps_says_so() -> None:
    assert KnownPart(np.array([3, 4, 9]), 3, 9, False).words == "frames 3 to 9, with gaps"


def test_the_next_click_waits_for_no_long_reading(feed: FileFeed, monkeypatch: pytest.MonkeyPatch) -> None:
    sequence = go(feed, CLICK)
    feed.ask(Pick(sequence, *center(CLICK)))
    wait(lambda: feed.tracking.targets and not feed.tracking.busy)
    assert feed.tracking._reader.interrupted() is False
    gate = Gate(monkeypatch, 0)
    feed.ask(Pick(sequence, *center(CLICK)))
    wait(lambda: 2 in feed.tracking.targets)
    feed.ask(Drop(2))
    assert feed.tracking._reader.interrupted() is True  # what reads now ends before its next frame
    gate.open()
    wait(lambda: list(feed.tracking.targets) == [1])
    assert feed.tracking._reader.interrupted() is False


def test_a_click_is_not_given_up_for_what_is_no_click(
    feed: FileFeed, notes: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    sequence = go(feed, CLICK)
    feed.ask(Pick(sequence, *center(CLICK)))
    wait(lambda: feed.tracking.targets and not feed.tracking.busy)
    read, interrupted = feed.tracking._frame, list[int]()

    def reading(click: Any, place: int) -> Frame:
        if not interrupted:
            interrupted.append(place)
            feed.ask(Drop(1))
            raise InterruptedReadingError
        return read(click, place)

    monkeypatch.setattr(feed.tracking, "_frame", reading)
    feed.ask(Pick(sequence, *center(CLICK)))
    wait(lambda: list(feed.tracking.targets) == [2] and not feed.tracking.busy)
    assert interrupted == [CLICK]
    assert notes == []


def test_what_is_no_click_is_done_after_what_was_more_urgent(
    feed: FileFeed, notes: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    feed.ask(Pick(go(feed, CLICK), *center(CLICK)))
    wait(lambda: feed.tracking.targets and not feed.tracking.busy)
    before, read, interrupted = feed.tracking.targets[1], feed.tracking._frame, list[int]()

    def reading(click: Any, place: int) -> Frame:
        if place not in interrupted:
            interrupted.append(place)
            raise InterruptedReadingError
        return read(click, place)

    monkeypatch.setattr(feed.tracking, "_frame", reading)
    feed.panel.take(Correct(1, go(feed, 40), *center(40)), "")
    wait(lambda: list(before.clicks) == [CLICK, 40])
    feed.ask(Reread(1, 1))
    wait(lambda: feed.tracking.targets[1] is not before and not feed.tracking.busy)
    assert interrupted == [40, CLICK]
    assert notes == []
