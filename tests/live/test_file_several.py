"""Several targets of a recorded video that look alike: each keeps its name, forward and backward."""

import csv
import itertools
import math
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import matchset as ms
from crossing_balls import FRAMES, LATE, RADIUS, places, written
from live_videos import go, opened, wait
from matchset.app.track.rows import read_tracks
from matchset.live.files.alike_run import AlikeRun
from matchset.live.files.file_feed import FileFeed
from matchset.live.files.file_target import FileTarget
from matchset.live.files.messages import Correct, Export
from matchset.live.targets.alike import ALIKE
from matchset.live.targets.messages import Drop, FindAll, Pick, Rename

NEAR, TOUCH = 4.0, 2.2 * RADIUS  # px


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return written(tmp_path_factory.mktemp("video"))


@pytest.fixture
def notes() -> list[str]:
    return []


@pytest.fixture
def feed(path: Path, notes: list[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[FileFeed]:
    monkeypatch.chdir(tmp_path)
    with opened(path, notes) as feed:
        wait(lambda: feed.frames.complete and feed.seen.frame is not None)
        yield feed


def click(feed: FileFeed, index: int, ball: int) -> None:
    """Click a ball in a frame, and wait until all is tracked."""
    before = len(feed.tracking.clicks.state.answered)
    feed.ask(Pick(go(feed, index), *places(index)[ball], click=ball + 1))
    wait(lambda: len(feed.tracking.clicks.state.answered) > before)
    wait(lambda: not feed.tracking.busy)


def place(answer: Any) -> tuple[float, float] | None:
    return (answer.shape.x, answer.shape.y) if isinstance(answer, ms.Track) else None


def check_names(feed: FileFeed, balls: dict[int, int], begin: int = 0) -> int:
    """Check that each target is on its ball wherever balls do not touch, and never two on one; count where all are."""
    complete = 0
    for index in range(begin, FRAMES):
        found = {number: place(feed.tracking.targets[number].answer(index)) for number in balls}
        seen = [at for at in found.values() if at is not None]
        complete += len(seen) == len(balls)
        assert all(math.dist(*pair) > NEAR for pair in itertools.combinations(seen, 2)), (index, found)
        if math.dist(*places(index)[:2]) < TOUCH:  # without an edge between them the outline is that of both
            continue
        for number, at in found.items():
            assert at is None or math.dist(at, places(index)[balls[number]]) < NEAR, (index, number, found)
    return complete


def lost_words(feed: FileFeed, number: int) -> set[str]:
    """Why a target is not found, where it is not."""
    answers = [feed.tracking.targets[number].answer(index) for index in range(FRAMES)]
    return {answer.reason for answer in answers if isinstance(answer, ms.Lost)}


@pytest.mark.parametrize(("first", "second"), [(0, 0), (0, 20), (80, 70), (70, 70)])
def test_two_equal_balls_that_cross_keep_their_names(feed: FileFeed, first: int, second: int) -> None:
    click(feed, first, 0)
    click(feed, second, 1)
    assert feed.tracking.clicks.state.answered[-1].words == ""
    assert check_names(feed, {1: 0, 2: 1}) > 0.75 * FRAMES
    hidden = {f"hidden behind circle {number}, which looks the same" for number in (1, 2)}
    assert hidden & (lost_words(feed, 1) | lost_words(feed, 2))
    doubtful = [feed.tracking.targets[1].state(index).alternatives for index in range(FRAMES)]
    assert [2] in doubtful  # while they come out of each other
    assert doubtful[0] == doubtful[-1] == []
    assert feed.panel.state().same == ""  # type: ignore[union-attr]


def test_one_that_has_gone_over_to_the_other_ball_is_corrected_there(feed: FileFeed, notes: list[str]) -> None:
    click(feed, 0, 0)
    feed.panel.take(Correct(1, go(feed, 80), *places(80)[1]), "")  # it goes over by hand: it does not by itself
    wait(lambda: math.dist(place(feed.tracking.targets[1].answer(80)) or (0, 0), places(80)[1]) < NEAR)
    wait(lambda: not feed.tracking.busy)
    click(feed, 80, 1)
    assert notes[-1] == "that is circle 1, which is followed already"
    feed.panel.take(Correct(1, go(feed, 80), *places(80)[0]), "")
    wait(lambda: math.dist(place(feed.tracking.targets[1].answer(80)) or (0, 0), places(80)[0]) < NEAR)
    wait(lambda: not feed.tracking.busy)
    click(feed, 80, 1)
    assert check_names(feed, {1: 0, 3: 1}) > 0.75 * FRAMES


def test_a_correction_exchanges_names_from_its_frame_on(feed: FileFeed) -> None:
    click(feed, 0, 0)
    click(feed, 0, 1)
    before = [feed.tracking.targets[1].answer(index) for index in range(20)]
    feed.panel.take(Correct(1, go(feed, 20), *places(20)[1]), "")
    wait(lambda: math.dist(place(feed.tracking.targets[1].answer(21)) or (0, 0), places(21)[1]) < NEAR)
    wait(lambda: not feed.tracking.busy)
    assert [feed.tracking.targets[1].answer(index) for index in range(20)] == before
    assert check_names(feed, {1: 1, 2: 0}, 20) > 0.7 * (FRAMES - 20)
    feed.panel.take(Correct(2, go(feed, 60), *places(60)[1]), "")  # and back
    wait(lambda: math.dist(place(feed.tracking.targets[2].answer(61)) or (0, 0), places(61)[1]) < NEAR)
    wait(lambda: not feed.tracking.busy)
    assert math.dist(place(feed.tracking.targets[1].answer(FRAMES - 1)) or (0, 0), places(FRAMES - 1)[0]) < NEAR


def test_all_like_one_are_found_with_their_births(feed: FileFeed, notes: list[str]) -> None:
    click(feed, 10, 1)
    feed.ask(FindAll(1))
    wait(lambda: len(feed.tracking.targets) == 3 and not feed.tracking.busy)
    assert check_names(feed, {1: 1, 2: 0}) > 0.7 * FRAMES
    third = feed.tracking.targets[3]
    begun = third.first_found()
    assert begun is not None
    assert LATE <= begun < LATE + 8
    assert all(third.answer(index) is None for index in range(LATE))  # it was not there yet, and is not lost
    assert all(math.dist(place(third.answer(index)) or (0, 0), places(index)[2]) < NEAR for index in range(70, FRAMES))
    assert third.state(FRAMES - 1).since == pytest.approx(begun / 30.0, abs=1e-3)
    assert all(each.state(FRAMES - 1).finds for each in feed.tracking.targets.values())
    feed.ask(FindAll(1, on=False))
    feed.ask(Rename(3, " third "))
    wait(lambda: third.name == "third")
    assert not third.finds
    feed.ask(Drop(1))
    wait(lambda: list(feed.tracking.targets) == [2, 3])
    assert notes == []


def test_one_that_is_dropped_while_all_like_it_are_looked_for_stays_dropped(
    feed: FileFeed, notes: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    click(feed, 0, 0)
    held, step = threading.Event(), AlikeRun.step

    def slow(run: AlikeRun, begin: Any) -> None:
        if run.place > 20:
            held.wait(60.0)
        step(run, begin)

    monkeypatch.setattr(AlikeRun, "step", slow)
    feed.ask(FindAll(1))
    wait(lambda: len(feed.tracking.targets) == 2)
    feed.ask(Drop(2))
    held.set()
    wait(lambda: list(feed.tracking.targets) == [1] and not feed.tracking.busy)
    assert notes == ["no more like circle 2 are looked for, or it would be found again"]
    assert not feed.tracking.targets[1].finds


def test_of_several_on_one_outline_the_eldest_stays_and_each_is_named_once(feed: FileFeed, notes: list[str]) -> None:
    step, targets = 0.8 * ALIKE.tracker.merge.distance * RADIUS, dict[int, FileTarget]()
    for number, x in enumerate((0.0, 1.0, 2.0, 8.0, 8.1, 8.2), start=1):
        targets[number] = FileTarget(number, Pick(1, 0.0, 0.0), 0)
        answer = ms.Track(ms.Circle(100.0 + step * x, 80.0, RADIUS), np.eye(3), 1.0, np.empty((0, 2)), 0.0)
        targets[number].put(0, answer)
        group = feed.tracking._groups.begin(targets[1])
        group.add(targets[number])
    feed.tracking.targets = targets
    feed.tracking._begin_together(AlikeRun(group, 0, False, feed.tracking._reader))
    assert list(feed.tracking.targets) == list(group.members) == [1, 3, 4]  # the third is on the second's alone
    words = "circle {} is circle {}, which is followed already"
    assert notes == [words.format(2, 1), words.format(5, 4), words.format(6, 4)]


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("  ", "empty"),
        ("a\nb", "in one line"),
        ("\u202eabc", "can be seen"),
        ("CIRCLE 2", "there is a target"),
    ],
)
def test_a_name_that_is_none_is_refused(feed: FileFeed, notes: list[str], name: str, words: str) -> None:
    click(feed, 0, 0)
    click(feed, 0, 1)
    feed.ask(Rename(1, name))
    wait(lambda: notes)
    assert words in notes[-1]
    feed.ask(Rename(7, "gone"))
    wait(lambda: notes[-1] == "there is no target 7 any more")
    assert [each.name for each in feed.tracking.targets.values()] == ["circle 1", "circle 2"]


def test_tables_of_several_say_whose_each_row_is(feed: FileFeed) -> None:
    click(feed, 0, 0)
    click(feed, 0, 1)
    feed.ask(Rename(2, "left hand"))
    wait(lambda: feed.tracking.targets[2].name == "left hand")
    feed.panel.take(Export(2, "tables"), "")
    wait(lambda: feed.exports.written and feed.exports.working is None)
    with feed.panel.downloads()["tracks-2.csv"].open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [(row["identity"], row["label"]) for row in rows] == [("2", "left hand")] * FRAMES
    assert "1" in {row["alternatives"] for row in rows}  # while they came out of each other
    assert [row.frame for row in read_tracks(feed.panel.downloads()["tracks-2.csv"])] == list(range(FRAMES))
