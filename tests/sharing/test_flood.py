"""Somebody sends without end, under many names or a partner's: what is decoded is counted, and partners are heard."""

import functools
import itertools
import secrets
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import pytest

import matchset as ms
import matchset.sharing.share as sharing
from matchset.sharing.clock import Clock
from matchset.sharing.connection import Connection, zenoh_settings
from matchset.sharing.inbox import InboxParameters
from matchset.sharing.lines import LineParameters
from matchset.sharing.messages import ENCODING, FORMAT, MOST_BYTES, MOST_TARGETS, TargetsMessage, read_targets, written
from matchset.sharing.partner import Partner
from sharing_poses import LEVEL, target_messages
from sharing_processes import Heard, told, until

pytest.importorskip("zenoh", reason="eclipse-zenoh, the extra `net`, is not installed")

LIMITS = InboxParameters()
Send = Callable[[bytes, bytes | None], None]


@pytest.fixture
def left(share: ms.Share, key: str) -> Iterator[ms.Share]:
    """A partner, which is heard."""
    with ms.Share("left", key=key) as made:
        until(lambda: told(made) and any(share.others()))
        yield made


@pytest.fixture
def stranger() -> Iterator[Connection]:
    with Connection(zenoh_settings("loopback", (), ())) as made:
        yield made


def message(name: str, number: int, count: int = MOST_TARGETS) -> bytes:
    targets = target_messages({f"ball {each}": LEVEL for each in range(count)}, 0.0)
    return written(
        TargetsMessage(format=FORMAT, name=name, run=1, number=number, sent=0.0, offsets=[], targets=targets)
    )


class Decoded:
    """Counts what is decoded, by whom."""

    def __init__(self, patch: pytest.MonkeyPatch) -> None:
        self.sizes, self.threads = list[int](), set[str]()
        read = read_targets

        def counted(data: bytes | None) -> Any:
            self.threads.add(threading.current_thread().name)
            if threading.current_thread() is threading.main_thread():
                self.sizes.append(len(data or b""))
            return read(data)

        patch.setattr(sharing, "read_targets", counted)


def waiting(share: ms.Share) -> int:
    return len(share._inbox._partners) + len(share._inbox._strangers)


@pytest.mark.usefixtures("left")
def test_what_comes_waits_although_somebody_holds_the_targets(share: ms.Share, key: str, stranger: Connection) -> None:
    send = stranger.publisher(f"{key}/targets/printer", ENCODING)
    with share._lock:
        until(lambda: [send(b"paper jam", None), share._inbox._strangers][1])


def test_who_comes_and_goes_waits_too_and_holds_up_nobody(share: ms.Share, key: str, stranger: Connection) -> None:
    send = stranger.publisher(f"{key}/targets/printer", ENCODING)
    with share._lock:
        stranger.appear(f"{key}/alive/new")
        until(lambda: share._inbox.is_present("new"))
        until(lambda: [send(b"paper jam", None), share._inbox._strangers][1])
    until(lambda: any(each.name == "new" and each.here for each in share.partners()))


def test_who_came_while_there_was_no_room_is_there_when_there_is(key: str, stranger: Connection) -> None:
    one = sharing.ShareParameters(inbox=InboxParameters(partners=1))
    with ms.Share("me", key=key, parameters=one) as share:
        heard = Heard(share)
        stranger.appear(f"{key}/alive/first")
        until(lambda: share.partners())
        stranger.appear(f"{key}/alive/second")
        until(lambda: heard.has("second: left out"))
        stranger.withdraw(f"{key}/alive/first")
        until(lambda: heard.has("first: gone"))
        send = stranger.publisher(f"{key}/targets/second", ENCODING)

        def come() -> bool:
            send(message("second", 1), None)
            return [(each.name, each.here) for each in share.partners()] == [("second", True)]

        until(come)


def test_many_that_do_not_answer_do_not_keep_others_from_being_read(
    key: str, stranger: Connection, monkeypatch: pytest.MonkeyPatch
) -> None:
    passed, right, done, read = [0.0], Clock(), list[str](), ms.Share._read

    def ask(_: ms.Share, partner: Partner) -> None:
        done.append(partner.name)
        passed[0] += 10.0  # as long as many of them take

    def reading(share: ms.Share) -> float:
        done.append("read")
        return read(share)

    monkeypatch.setattr(ms.Share, "_compare", ask)
    monkeypatch.setattr(ms.Share, "_read", reading)
    names = {"first", "second", "third"}
    for name in names:
        stranger.appear(f"{key}/alive/{name}")
    clock = Clock(lambda: right.now() + passed[0], lambda: right.awake() + passed[0])
    with ms.Share("me", key=key, clock=clock, parameters=sharing.ShareParameters(look=0.01)):
        until(lambda: names <= set(done) and len(done) > 30)
    assert all("read" in pair for pair in itertools.pairwise(done))


def test_of_a_flood_of_strangers_a_look_decodes_few_messages(
    share: ms.Share, left: ms.Share, key: str, stranger: Connection, monkeypatch: pytest.MonkeyPatch
) -> None:
    heard, decoded = Heard(share), Decoded(monkeypatch)
    senders = [stranger.publisher(f"{key}/targets/stranger{each}", ENCODING) for each in range(50)]
    data = [message(f"stranger{each}", 0) for each in range(50)]

    def flooded(dropped: int) -> bool:
        for send, each in zip(senders, data, strict=True):
            send(each, None)
        return share._inbox.dropped > dropped

    for look in range(20):
        until(functools.partial(flooded, share._inbox.dropped))
        decoded.sizes.clear()
        left.publish(LEVEL, time.monotonic())
        share.others()
        assert len(decoded.sizes) <= LIMITS.partners + LIMITS.strangers, look
        assert sum(decoded.sizes[:-1]) < LIMITS.decoded
    until(lambda: told(left) and any(share.others()))
    assert decoded.threads <= {"MainThread", "matchset share"}
    assert 1 <= heard.count("messages of too many senders were left out so far") <= 5


def test_of_a_flood_of_partners_a_look_decodes_few_bytes_and_all_are_heard(
    key: str, stranger: Connection, monkeypatch: pytest.MonkeyPatch
) -> None:
    limits = InboxParameters(decoded=2 * MOST_BYTES, targets=100 * MOST_TARGETS)
    names = [f"partner{each}" for each in range(20)]
    with ms.Share("me", key=key, parameters=sharing.ShareParameters(inbox=limits, look=1e3)) as share:
        for name in names:
            stranger.appear(f"{key}/alive/{name}")
        senders = {name: stranger.publisher(f"{key}/targets/{name}", ENCODING) for name in names}
        until(lambda: sum(each.here for each in share.partners()) == len(names))
        decoded, number = Decoded(monkeypatch), 0

        def flooded() -> bool:
            nonlocal number
            number += 1
            for name, send in senders.items():
                send(message(name, number), None)
            decoded.sizes.clear()
            states = share.partners()
            assert sum(decoded.sizes[:-1]) < limits.decoded
            return all(each.received for each in states)

        until(flooded)
        assert number > len(names) * len(message("partner0", 0)) / limits.decoded / 2.0


def test_of_one_that_floods_only_the_newest_message_is_decoded(
    share: ms.Share, key: str, stranger: Connection, monkeypatch: pytest.MonkeyPatch
) -> None:
    stranger.appear(f"{key}/alive/fast")
    until(lambda: share.partners())
    send, decoded, numbers = (
        stranger.publisher(f"{key}/targets/fast", ENCODING),
        Decoded(monkeypatch),
        iter(range(10**9)),
    )
    with share._lock:  # nobody looks

        def flooded() -> bool:
            for _ in range(10):
                send(message("fast", next(numbers), 1), None)
            return bool(share._inbox._partners) and share._inbox._partners["fast"].messages > 500

        until(flooded)
    (state,) = share.partners()
    assert len(decoded.sizes) <= 1
    assert 500 < state.received + state.missed <= next(numbers)


def test_of_too_many_targets_the_rest_is_left_out_and_told_once(
    share: ms.Share, left: ms.Share, key: str, stranger: Connection
) -> None:
    heard, names = Heard(share), [f"partner{each}" for each in range(8)]
    for name in names:
        stranger.appear(f"{key}/alive/{name}")
    senders = {name: stranger.publisher(f"{key}/targets/{name}", ENCODING) for name in names}
    until(lambda: len(share.partners()) == 1 + len(names))

    def flooded() -> bool:
        for name, send in senders.items():
            send(message(name, secrets.randbits(50)), None)
        assert len(share.others()) <= LIMITS.targets
        return heard.has("left out, 256 targets of partners are kept at most")

    until(flooded)
    until(lambda: told(left) and any(share.others()))
    stranger.withdraw(*(f"{key}/alive/{name}" for name in names))
    until(lambda: sum(each.here for each in share.partners()) == 1)
    assert heard.count("targets of partners are kept") == 1
    with ms.Share("late", key=key) as late:  # those that are gone make room
        until(lambda: told(late) and share.others()[0].partner == "late")


@pytest.mark.usefixtures("left")
def test_a_message_that_is_too_long_is_never_read(share: ms.Share, key: str, stranger: Connection) -> None:
    heard = Heard(share)
    send = stranger.publisher(f"{key}/targets/printer", ENCODING)
    words = f"printer: sends more than {MOST_BYTES} bytes at once; left out"
    until(lambda: [send(bytes(1_000_000), None), heard.has(words)][1])
    for size in (20_000_000, MOST_BYTES + 1):
        send(bytes(size), None)
    until(lambda: [share.news(), not waiting(share)][1])
    assert heard.count("printer") == 1


def test_one_that_comes_and_goes_does_not_fill_the_log(key: str, stranger: Connection) -> None:
    few = sharing.ShareParameters(lines=LineParameters(period=1e6))
    with ms.Share("me", key=key, parameters=few) as share:
        heard = Heard(share)
        for number in range(60):
            stranger.appear(f"{key}/alive/flapping")
            stranger.appear(f"{key}/alive/new{number % 20}")
            until(lambda: sum(each.here for each in share.partners()) == 2)
            stranger.withdraw(f"{key}/alive/flapping", f"{key}/alive/new{number % 20}")
            until(lambda: not any(each.here for each in share.partners()))
        assert heard.count("") <= LineParameters().together
        assert heard.count("flapping") == LineParameters().partner
