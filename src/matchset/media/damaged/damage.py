"""Which pictures are wrong because of an error in the video, in them or in one that they were made from: `Damage`."""

import msgspec

from matchset.media.damaged.frame_numbers import FrameNumbers


class DamageParameters(msgspec.Struct, frozen=True):
    """How long an error lasts.

    Parameters
    ----------
    longest : int
        Pictures without an error of their own after which they are believed although no key picture came: of streams
        that are made anew piece by piece only H.264 says when all is. Chosen by: the usual distance of key pictures
        (x264's 250) and a fifth.
    """

    longest: int = 300


DEFAULT = DamageParameters()


class Damage:
    """Follows the errors of a decoder from one picture to the next.

    A picture in which the decoder reports an error is wrong, and so are those that are made from it: all until the next
    key picture. What comes before the first key picture was joined in the middle. A picture of which every part has
    been made anew, piece by piece in the pictures before it, counts as a key picture.

    Parameters
    ----------
    numbers : FrameNumbers, optional
        Of an H.264 video: what its headers say.
    """

    def __init__(self, numbers: FrameNumbers | None = None) -> None:
        self._last, self._since, self._numbers = True, 0, numbers
        self._is_refreshed = self._refreshing = False

    def note_packet(self, data: bytes) -> None:
        """Note what a packet says of pictures that are missing, or made anew; before it is decoded."""
        if self._numbers is None:
            return
        if self._numbers.is_gap(data):
            self.note_loss()
        if self._numbers.refresh_ends:
            self._is_refreshed, self._refreshing = self._refreshing, False
        self._refreshing |= self._numbers.refresh_begins

    def note_loss(self) -> None:
        """Note that a packet did not decode."""
        self._last, self._since = True, 0
        self._is_refreshed = self._refreshing = False

    def of(self, error: bool, key: bool) -> bool:
        """Whether the next picture is damaged.

        Parameters
        ----------
        error : bool
            Whether the decoder reports an error in it.
        key : bool
            Whether it is made from no other picture.
        """
        self._since = 0 if error else self._since + 1
        self._refreshing &= not error
        kept = self._last and not key and not self._is_refreshed and self._since < DEFAULT.longest
        self._is_refreshed = False
        self._last = error or kept
        return self._last
