"""Whether a camera delivered a picture before: `note_picture`, a pure function of the picture and its last state.

A picture of an analog camera never comes twice, for its noise never does; neither does that of a vehicle in flight,
which never stands still. So a picture that equals an earlier one, bit for bit along some of its lines, is one that the
grabber sends again, whatever its time stamp says. Nothing here looks at the ball.
"""

import zlib
from typing import NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.numeric.arguments import require_at_least


class RepeatedPictureParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """When pictures count as sent again.

    Parameters
    ----------
    lines : int
        How many rows of a picture are compared, in both fields of an interlaced one; 0: none, no picture ever counts as
        sent again. That is for a camera without noise that looks at a still scene before the start; in flight its
        pictures differ. More rows cost time, 0.5 us each at 640 px; fewer may all lie in parts that are black or
        saturated. Chosen by hand: 3.5 us in all.
    memory : int
        With how many of the last different pictures each is compared. More finds a grabber that goes farther back: 64
        are 2 s. It costs next to nothing.
    max_repeats : int
        After so many pictures in a row that came before, the vehicle descends. Fewer does so sooner, and also where a
        grabber sends the pictures of a slower camera twice: 1 of 6 where it makes 30 of 25 a second. Chosen by: the
        project's safety rules.
    final_repeats : int
        After so many in a row the descent is final, until somebody arms: a grabber that stood still so long may have
        queued what it delivers next, and nothing but the motion would tell that it is old. Fewer ends flights that a
        grabber only disturbed; more lets queues grow. Chosen by: `python -m benchmarks.flight.faults --only late`.
    """

    lines: int = 4
    memory: int = 64
    max_repeats: int = 3
    final_repeats: int = 9

    def __post_init__(self) -> None:
        require_at_least(self, 0, "lines")
        require_at_least(self, 1, "memory", "max_repeats", "final_repeats")


class PicturesSeen(NamedTuple):
    """What the next call needs; the first one gets `PicturesSeen()`.

    Attributes
    ----------
    checksums : tuple of int
        Of the last different pictures, the newest last.
    repeats : int
        How many pictures in a row came before; 0: the last one was new.
    went_back : bool
        Whether one of these was not the newest, but an older one.
    """

    checksums: tuple[int, ...] = ()
    repeats: int = 0
    went_back: bool = False


def note_picture(
    image: npt.NDArray[np.uint8], seen: PicturesSeen, parameters: RepeatedPictureParameters
) -> PicturesSeen:
    """Compare a picture with those that came before.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3) or (h, w), uint8
    seen : PicturesSeen
        From the last call.
    parameters : RepeatedPictureParameters

    Returns
    -------
    PicturesSeen
        For the next call; its `repeats` is 0 if the picture is new.
    """
    if not parameters.lines:
        return seen
    step = max(len(image) // parameters.lines, 1) | 1  # odd: rows of both fields
    checksum = zlib.crc32(image[(len(image) % step) // 2 :: step].tobytes())
    if checksum not in seen.checksums:
        return PicturesSeen((*seen.checksums, checksum)[-parameters.memory :])
    went_back = seen.went_back or checksum != seen.checksums[-1]
    return seen._replace(repeats=seen.repeats + 1, went_back=went_back)
