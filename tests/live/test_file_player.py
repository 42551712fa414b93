"""The player of a recorded video: any sequence of buttons ends at the right picture."""

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from matchset.live.files.file_feed import FileFeed
from matchset.live.files.messages import Pause, Play, Seek, Speed, Step
from matchset.live.files.panel import FileState
from matchset.media.frame_list import StampedVideo
from strange_clips import number_of, write

FRAMES = 50
STAMPS = [0.02 * index for index in range(FRAMES)]


def wait(condition: Callable[[], object], seconds: float = 20.0) -> None:
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "not in time"
        time.sleep(0.002)


@pytest.fixture(scope="module")
def feed(tmp_path_factory: pytest.TempPathFactory) -> Iterator[FileFeed]:
    path = write(tmp_path_factory.mktemp("video") / "clip.mp4", "libx264", STAMPS, options={"g": "20", "bf": "2"})
    with opened(path) as made:
        wait(lambda: made.frames.complete and made.seen.frame is not None)
        yield made


def opened(path: Path, notes: list[str] | None = None) -> FileFeed:
    said = [] if notes is None else notes
    return FileFeed("clip", lambda: StampedVideo(path), lambda _: None, said.append)


def told(feed: FileFeed) -> FileState:
    state = feed.panel.state()
    assert state is not None
    return state


def take(feed: FileFeed, message: Any) -> None:
    feed.panel.take(message, "")


def shown(feed: FileFeed) -> int:
    seen = feed.seen
    assert seen.frame is not None
    assert number_of(seen.frame.image) == seen.frame.index == seen.state.index
    assert seen.state.time == seen.frame.time
    return seen.state.index


BUTTONS = st.one_of(
    st.builds(Step, st.integers(-70, 70)),
    st.builds(Seek, st.integers(0, 100)),
    st.builds(Speed, st.sampled_from((0.5, 1.0, 4.0))),
    st.just(Pause()),
)


@settings(max_examples=20, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(BUTTONS, max_size=10))
def test_any_sequence_of_buttons_shows_the_picture_of_that_index(feed: FileFeed, buttons: list[Any]) -> None:
    take(feed, Seek(0))
    place = 0
    for button in buttons:
        take(feed, button)
        if isinstance(button, Seek):
            place = min(button.index, FRAMES - 1)
        elif isinstance(button, Step):
            place = min(max(place + button.frames, 0), FRAMES - 1)
    wait(lambda: feed.seen.state.index == place)
    assert shown(feed) == place


def test_it_plays_to_the_end_shows_every_frame_and_begins_again(feed: FileFeed) -> None:
    seen = []
    take(feed, Pause())
    take(feed, Speed(1.0))
    take(feed, Seek(0))
    wait(lambda: feed.seen.state.index == 0)
    sequence = feed.seen.state.sequence
    take(feed, Play())
    begin = time.monotonic()  # real time is the subject: a video is not shown faster than it was taken
    while feed.player.playing:
        if feed.seen.state.sequence != sequence:
            sequence = feed.seen.state.sequence
            seen.append(shown(feed))
        time.sleep(0.001)  # or the player hardly runs
    assert time.monotonic() - begin > 0.9 * STAMPS[-1]
    wait(lambda: feed.seen.state.index == FRAMES - 1)
    assert sorted(set(seen)) == seen
    take(feed, Play())
    wait(lambda: feed.seen.state.index < FRAMES - 1)
    take(feed, Pause())


def test_a_fast_player_leaves_frames_out(feed: FileFeed) -> None:
    take(feed, Pause())
    take(feed, Seek(0))
    take(feed, Speed(8.0))
    wait(lambda: feed.seen.state.index == 0)
    sequence = feed.seen.state.sequence
    take(feed, Play())
    wait(lambda: not feed.player.playing and feed.seen.state.index == FRAMES - 1)
    assert feed.seen.state.sequence - sequence < FRAMES / 4  # of 400 in a second 60 are shown
    take(feed, Speed(1.0))


def test_what_a_page_is_told(feed: FileFeed) -> None:
    take(feed, Step(0))
    take(feed, Seek(7))
    wait(lambda: feed.seen.state.index == 7)
    state = told(feed)
    assert (state.index, state.last, state.end, state.complete, state.playing) == (7, 49, 49, True, False)
    assert (state.time, state.duration) == pytest.approx((0.14, 0.98), abs=1e-3)


@pytest.mark.parametrize("content", [b"", b"this is no video", b"\0\0\0\x18ftypmp42" + bytes(4000)])
def test_what_is_no_video_is_said_in_words(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "clip.mp4"
    path.write_bytes(content)
    with pytest.raises(ValueError, match=r"clip\.mp4"):
        opened(path)


def test_a_file_that_ends_early_is_shown_up_to_there_and_said(tmp_path: Path) -> None:
    path = write(tmp_path / "clip.avi", "mpeg4", STAMPS)
    data = path.read_bytes()
    path.write_bytes(data[: 6 * len(data) // 10])
    notes: list[str] = []
    with opened(path, notes) as feed:
        wait(lambda: feed.frames.complete)
        assert 10 < len(feed.frames) < FRAMES
        take(feed, Seek(FRAMES))
        wait(lambda: feed.seen.state.index == feed.frames[len(feed.frames) - 1].index)
        assert told(feed).end == len(feed.frames) - 1
    assert any("it ends at" in words for words in notes)


def test_one_picture_is_a_video_too(tmp_path: Path) -> None:
    with opened(write(tmp_path / "one.mp4", "libx264", STAMPS[:1])) as feed:
        wait(lambda: feed.frames.complete and feed.seen.frame is not None)
        for button in (Play(), Step(5), Step(-5), Seek(9), Pause()):
            take(feed, button)
        assert shown(feed) == 0


def test_a_file_can_be_closed_at_once(tmp_path: Path) -> None:
    path = write(tmp_path / "clip.mp4", "libx264", STAMPS)
    for _ in range(5):
        opened(path).close()
