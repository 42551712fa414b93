"""What a page may say; everything else is a ValueError."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from matchset.live.known_messages import READER
from matchset.live.targets.messages import Drop, FindAll, Pick, Rename
from matchset.live.wire.messages import Ack


def test_messages_are_read() -> None:
    assert READER.read('{"type": "ack", "sequence": 3}') == Ack(3)
    assert READER.read('{"type": "pick", "sequence": 3, "x": 4.5, "y": 6}') == Pick(3, 4.5, 6.0)
    assert READER.read('{"type": "drop", "target": 2}') == Drop(2)
    assert READER.read('{"type": "rename", "target": 2, "name": "left"}') == Rename(2, "left")
    assert READER.read('{"type": "find_all", "target": 2}') == FindAll(2, True)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        "{}",
        '{"type": "ack"}',
        '{"type": "fly"}',
        '{"type": "ack", "sequence": -1}',
        '{"type": "pick", "sequence": 1, "x": 1e99, "y": 0}',
        '{"type": "diameter", "target": 1, "meters": 0}',
        '{"type": "diameter", "target": 1, "meters": 1e9}',
        '{"type": "diameter", "target": 1, "meters": "abc"}',
        '{"type": "drop", "target": 1, "more": 1}',
        '{"type": "rename", "target": 1, "name": ""}',
        '{"type": "rename", "target": 1, "name": "' + "x" * 61 + '"}',
        '{"type": "find_all", "target": -1}',
        '{"type": "find_all", "target": 1, "on": "yes"}',
        "[" * 3000,
        '{"type": "ack", "sequence": 1, "pad": "' + "x" * 5000 + '"}',
    ],
)
def test_nonsense_is_a_value_error(text: str) -> None:
    with pytest.raises(ValueError, match=r"message"):
        READER.read(text)


@given(st.text(max_size=200))
def test_any_text_is_a_message_or_a_value_error(text: str) -> None:
    try:
        READER.read(text)
    except ValueError as error:
        said = str(error)
    else:
        said = "a message"
    assert said
