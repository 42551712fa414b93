"""At most two pictures on their way, the newest wins, and slow links get smaller ones."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from matchset.live.wire.flow import SIZES, Flow, FlowParameters, Ladder
from matchset.live.wire.packet import Packet, pack, unpack


def test_two_are_on_their_way_and_the_newest_is_next() -> None:
    flow = Flow()
    for sequence in (1, 2, 3, 4):
        flow.offer(sequence)
        if sequence < 3:
            assert flow.take(0.0) == sequence
    assert flow.take(0.0) is None
    assert flow.acknowledge(1, 0.02) == pytest.approx(0.02)
    assert flow.take(0.03) == 4
    assert flow.skipped == 1


@given(st.lists(st.sampled_from(["offer", "take", "acknowledge"]), max_size=60))
def test_never_more_than_allowed(steps: list[str]) -> None:
    flow, sequence, sent = Flow(), 0, list[int]()
    for number, what in enumerate(steps):
        if what == "offer":
            sequence += 1
            flow.offer(sequence)
        elif what == "take":
            taken = flow.take(number / 30.0)
            if taken is not None:
                assert taken == sequence
                sent.append(taken)
        elif sent:
            assert flow.acknowledge(sent.pop(0), number / 30.0) is not None
        assert len(sent) <= FlowParameters().in_flight


def test_the_last_picture_before_a_video_stands_is_shown_on_a_slow_link_too() -> None:
    flow = Flow()
    flow.ladder.step = len(SIZES) - 1
    for sequence in (1, 2, 3, 4):
        flow.offer(sequence)
    assert flow.take(0.0) == 3
    assert flow.settle()
    assert flow.take(0.1) == 4
    assert not flow.settle()


def test_an_acknowledgment_of_something_else_is_none() -> None:
    assert Flow().acknowledge(7, 0.0) is None


def test_slow_acknowledgments_make_pictures_smaller_and_fast_ones_larger() -> None:
    ladder = Ladder()
    for _ in range(200):
        ladder.note(0.5)
    assert ladder.step == len(SIZES) - 1
    for _ in range(200):
        ladder.note(0.01)
    assert ladder.step == 0


@given(st.integers(0, 2**32 - 1), st.floats(0.0, 1e9), st.binary(max_size=50), st.binary(max_size=50))
def test_packets_come_back(sequence: int, time: float, state: bytes, picture: bytes) -> None:
    packet = Packet(sequence, time, -1.0, state, picture)
    assert unpack(pack(packet)) == packet


@given(st.binary(max_size=60))
def test_bytes_are_a_packet_or_a_value_error(data: bytes) -> None:
    try:
        packet = unpack(data)
    except ValueError:
        return
    assert len(packet.state) <= len(data)
