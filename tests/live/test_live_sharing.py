"""What the page shows is shared, and what others share is on the page: two sessions in one process."""

import secrets
import sys
import threading
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import msgspec
import pytest

import matchset as ms
from live_feeds import MadeUpFeed, seen_of, shown
from matchset.live.feed import Feed, StreamPicture
from matchset.live.session import Session
from matchset.live.sharing.shared_page import SharedPage, shared_page
from matchset.live.sharing.state import SharingState
from matchset.sharing.sent_targets import SentTarget, Shareable
from sharing_poses import LEVEL
from sharing_processes import until

pytest.importorskip("zenoh", reason="eclipse-zenoh, the extra `net`, is not installed")


@pytest.fixture
def key() -> str:
    return f"test/{secrets.token_hex(8)}"


@pytest.fixture
def page(key: str) -> Iterator[tuple[Session, MadeUpFeed]]:
    session = Session()
    with shared_page(ms.Share("page", key=key), session), session:
        yield session, shown(MadeUpFeed(2), session)


def state_of(session: Session) -> SharingState:
    state = session.state().panels["sharing"]
    assert isinstance(state, SharingState)
    return state


def test_targets_of_the_page_are_shared(page: tuple[Session, MadeUpFeed], key: str) -> None:
    _, feed = page
    numbers = iter(range(100_000))
    with ms.Share("other", key=key) as other:

        def seen() -> bool:
            feed.show(seen_of(next(numbers), targets=2))
            feed.show(seen_of(next(numbers), found=False), stream=1)
            return len(other.others()) == 3 and any(other.others())

        until(seen)
        first, second, lost = other.others()
    assert (first.name, second.name, lost.name) == ("circle 1", "circle 2", "circle 1 2")
    assert (first.shape, set(first.values)) == ("Circle", {"x", "y", "radius"})
    assert isinstance(first.pose, ms.Pose)
    assert first.pose.position.tolist() == [0.1, 0.2, 1.5]
    assert lost.reason == "not seen: too few edge points"


def test_a_picture_that_was_shared_is_not_shared_again(page: tuple[Session, MadeUpFeed], key: str) -> None:
    session, feed = page
    with ms.Share("other", key=key) as other:
        until(lambda: other.partners() and state_of(session).partners)
        for number in (1, 1, 2):
            feed.show(seen_of(number))
        until(lambda: other.partners()[0].received == 2)


def test_partners_are_on_the_page_with_age_and_clock(page: tuple[Session, MadeUpFeed], key: str) -> None:
    session, _ = page
    found: dict[str, Shareable] = {"ball": LEVEL, "gone": ms.Lost("hidden", 0.0)}
    with ms.Share("other", key=key) as other:

        def seen() -> bool:
            other.publish(found, 10.0, 10.1)
            partners = state_of(session).partners
            return bool(partners and partners[0].targets and partners[0].targets[0].position)

        until(seen)
        (partner,) = state_of(session).partners
        assert (partner.name, partner.here) == ("other", True)
        assert partner.age_ms is not None
        assert partner.age_ms >= 100
        assert partner.offset_uncertainty_ms > 0.0
        ball, gone = partner.targets
        assert (ball.position, ball.sigma) == ([0.1, -0.2, 1.9], 0.01)
        assert gone.reason == "not seen: hidden"
    until(lambda: not state_of(session).partners[0].here)
    words = ["shared with other: here", "shared with other: gone"]
    assert session.state().notes == words


def test_another_source_forgets_what_was_shown(page: tuple[Session, MadeUpFeed], key: str) -> None:
    session, feed = page
    with ms.Share("other", key=key) as other:
        feed.show(seen_of(1))
        again = shown(MadeUpFeed(1), session)
        numbers = iter(range(100_000))

        def seen() -> bool:
            again.show(seen_of(next(numbers), targets=3))
            return len(other.others()) == 3

        until(seen)


class CountingShare:
    """Keeps what is published last, and takes part in nothing."""

    def __init__(self) -> None:
        self.published, self.unequal = 0, 0

    def publish(self, found: Sequence[SentTarget], times: Mapping[str, float], _: float) -> None:
        self.published += 1
        self.unequal += {each.name for each in found} != set(times)


class NamingShare(CountingShare):
    """Keeps the names that are published last."""

    names: Sequence[str] = ()

    def publish(self, found: Sequence[SentTarget], times: Mapping[str, float], now: float) -> None:
        super().publish(found, times, now)
        self.names = [each.name for each in found]


class LateThread:
    """A listener that stands for a thread of a feed, which tells a picture while the next feed comes."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def hear(self, stream: int, seen: StreamPicture) -> None:
        pass

    def changed(self, _: Feed | None) -> None:
        self._session.hear(1)


def test_a_picture_that_the_source_before_tells_last_is_not_shared_for_good() -> None:
    share, session, before, after = NamingShare(), Session(), MadeUpFeed(2), MadeUpFeed(1)
    shown(before, session)
    session.listen(SharedPage(share, session.note))  # type: ignore[arg-type]
    session.listen(LateThread(session))
    before.show(seen_of(1), stream=1)
    before.made[1].seen = seen_of(2)
    shown(after, session)
    assert share.names == ["circle 1 2"]
    after.show(seen_of(3))
    assert share.names == ["circle 1"]


def test_a_stream_that_has_stopped_is_not_shared_for_good() -> None:
    share = NamingShare()
    page = SharedPage(share, [].append, lasting=2.0)  # type: ignore[arg-type]
    page.hear(1, seen_of(0))
    page.hear(0, seen_of(59))
    assert share.names == ["circle 1 2", "circle 1"]
    page.hear(0, seen_of(61))
    assert share.names == ["circle 1"]


@pytest.fixture
def restless() -> Iterator[None]:
    """Threads take turns after each few instructions."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    yield
    sys.setswitchinterval(before)


@pytest.mark.usefixtures("restless")
def test_cameras_and_another_source_do_not_disturb_each_other() -> None:
    share, notes, errors = CountingShare(), list[str](), list[Exception]()
    shown: Any = SharedPage(share, notes.append)  # type: ignore[arg-type]
    pictures = [seen_of(number, targets=3) for number in range(8)]
    hearing = threading.Event()

    def hear(stream: int) -> None:
        try:
            for number in range(2000):
                shown.hear(stream, pictures[number % 8])
        except Exception as error:
            errors.append(error)

    def change() -> None:
        while not hearing.is_set():
            shown.changed(None)

    threads = [threading.Thread(target=hear, args=(stream,)) for stream in range(2)]
    changing = threading.Thread(target=change)
    for each in (*threads, changing):
        each.start()
    for each in threads:
        each.join()
    hearing.set()
    changing.join()
    assert (errors, share.unequal, notes) == ([], 0, [])
    assert share.published > 0


def test_the_state_is_short(page: tuple[Session, MadeUpFeed]) -> None:
    session, _ = page
    assert msgspec.json.decode(msgspec.json.encode(state_of(session))).keys() == {"name", "key"}


def test_without_a_name_nothing_is_shared() -> None:
    session = Session()
    made: Any = shared_page(None, session)
    with made:
        assert session.state().panels == {}
