"""Which pictures are wrong because of an error in the video, in them or in one that they were made from: `Damage`."""

import msgspec


class DamageParameters(msgspec.Struct, frozen=True):
    """How long an error lasts.

    Parameters
    ----------
    longest : int
        Pictures without an error of their own after which they are believed although no key picture came: streams that
        are refreshed piece by piece have none. Chosen by: the usual distance of key pictures (x264's 250) and a fifth.
    """

    longest: int = 300


DEFAULT = DamageParameters()


class Damage:
    """Follows the errors of a decoder from one picture to the next.

    A picture in which the decoder reports an error is wrong, and so are those that are made from it: all until the next
    key picture. What comes before the first key picture was joined in the middle.
    """

    def __init__(self) -> None:
        self._last, self._since = True, 0

    def note_loss(self) -> None:
        """Note that a packet did not decode."""
        self._last, self._since = True, 0

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
        kept = self._last and not key and self._since < DEFAULT.longest
        self._last = error or kept
        return self._last
