"""Numbers and pictures of a recording are those that were flown, to the last bit."""

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from chain_flight import Flown
from matchset.flight.recording.encoding import decode, encode, frame_of, to_png
from matchset.flight.recording.messages import Picture, StepMessage


@given(st.lists(st.floats(), max_size=8))
def test_numbers_are_written_to_the_last_bit(numbers: list[float]) -> None:
    back = msgspec.msgpack.decode(encode(np.array(numbers)))
    np.testing.assert_array_equal(np.array(numbers).view(np.uint64), np.array(back, np.float64).view(np.uint64))


@given(st.binary(max_size=60))
def test_bytes_that_are_no_message_are_refused(data: bytes) -> None:
    with pytest.raises(ValueError, match="is no"):
        decode(data, StepMessage)


def test_pictures_are_kept_without_loss(flown: Flown) -> None:
    frame = flown.chain_steps[0].steps[0].frame
    assert frame is not None
    for image in (frame.image, frame.image[..., 1].copy()):
        back = frame_of(Picture(7, 0.25, to_png(image)))
        np.testing.assert_array_equal(back.image, image)
        assert (back.index, back.time) == (7, 0.25)
    for png in (b"", b"no picture"):
        with pytest.raises(ValueError, match="frame 7 does not decode"):
            frame_of(Picture(7, 0.25, png))
