"""What has come waits in few bytes, and a look reads few of them, whatever is sent."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from matchset.sharing.inbox import Inbox, InboxParameters, Waiting

SMALL = InboxParameters(partners=3, strangers=2, decoded=100)


def test_of_each_sender_the_newest_message_waits() -> None:
    inbox = Inbox(SMALL)
    for number in range(5):
        assert inbox.put("left", b"%d" % number, float(number), known=True)
    inbox.put("right", b"x", 9.0, known=True)
    assert inbox.take() == [Waiting("left", b"4", 4.0, 5), Waiting("right", b"x", 9.0, 1)]
    assert inbox.take() == []


def test_strangers_do_not_take_the_place_of_partners() -> None:
    inbox = Inbox(SMALL)
    for number in range(50):
        assert inbox.put(f"stranger {number}", b"", 0.0, known=False) == (number < 2)
    assert inbox.put("left", b"", 0.0, known=True)
    assert [each.name for each in inbox.take()] == ["left", "stranger 0", "stranger 1"]
    assert inbox.dropped == 48


@given(st.lists(st.tuples(st.sampled_from("abcdefgh"), st.integers(0, 60), st.booleans()), max_size=60))
def test_a_look_reads_few_bytes_and_nothing_waits_for_ever(sent: list[tuple[str, int, bool]]) -> None:
    inbox, newest = Inbox(SMALL), dict[tuple[str, bool], int]()
    for name, size, known in sent:
        if inbox.put(name, bytes(size), 0.0, known):
            newest[name, known] = size
            if known:
                newest.pop((name, False), None)
    read = list[int]()
    for _ in range(5 + 1):
        taken = inbox.take()
        sizes = [len(each.data or b"") for each in taken]
        assert sum(sizes[:-1]) < SMALL.decoded
        assert len(taken) <= SMALL.partners + SMALL.strangers
        read += sizes
    assert sorted(read) == sorted(newest.values())
    assert inbox.take() == []


def test_a_stranger_that_becomes_a_partner_has_sent_all_of_it() -> None:
    inbox = Inbox(SMALL)
    inbox.put("left", b"0", 1.0, known=False)
    inbox.put("left", b"1", 2.0, known=True)
    assert inbox.take() == [Waiting("left", b"1", 2.0, 2)]


def test_what_is_too_long_waits_without_its_bytes() -> None:
    inbox = Inbox(SMALL)
    inbox.put("left", None, 1.0, known=True)
    assert inbox.take() == [Waiting("left", None, 1.0, 1)]


def test_of_one_that_has_ended_nothing_waits() -> None:
    inbox = Inbox(SMALL)
    inbox.put("left", b"x", 1.0, known=True)
    inbox.put("left", b"y", 1.0, known=False)
    inbox.see("left", False, known=True)
    inbox.see("right", False, known=False)
    assert inbox.take() == []
    assert inbox.changes() == (["left", "right"], [])


def test_who_came_and_went_is_kept_for_few() -> None:
    inbox = Inbox(InboxParameters(present=2))
    for name in ("a", "b", "c", "d"):
        inbox.see(name, True, known=name == "d")
    assert [inbox.is_present(name) for name in "abcd"] == [True, True, False, True]
    inbox.see("a", False, known=True)
    inbox.see("b", False, known=True)
    inbox.see("b", True, known=True)
    for name in ("e", "f", "g"):
        inbox.see(name, False, known=False)
    assert inbox.changes() == (["a", "b"], ["d", "b"])
    assert inbox.changes() == ([], [])
    assert [inbox.is_present(name) for name in "abcd"] == [False, True, False, True]


@pytest.mark.parametrize("name", InboxParameters.__struct_fields__)
def test_no_limit_is_nothing(name: str) -> None:
    with pytest.raises(ValueError, match=f"{name} must be positive"):
        InboxParameters(**{name: 0})
