"""The last pictures that went out, so that a click means the picture that was seen: `KeptFrames`."""

from collections import deque

import msgspec

from matchset.image.frame import Frame
from matchset.numeric.arguments import require_at_least


class KeepingParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How long pictures are kept.

    Parameters
    ----------
    frames : int
        Number of pictures. More: clicks on older pictures of a slower link still count, and more memory. Chosen by
        hand: 2 s at 30 frames/s, longer than a person needs from seeing to clicking on what moves.
    memory : int
        Bytes that they may have together; two pictures are kept in any case. More: the same for larger pictures.
        Chosen by hand: 60 pictures of 1280 x 720 px, and what a small computer can spare.
    held : int
        Pictures in which somebody draws at most; they are kept until as many newer ones were drawn in. More: more
        people draw at once, and more memory. Chosen by hand: two, of whom one begins again.
    """

    frames: int = 60
    memory: int = 180_000_000
    held: int = 3

    def __post_init__(self) -> None:
        require_at_least(self, 1, "frames")


class KeptFrames:
    """The last pictures by their sequence numbers.

    Parameters
    ----------
    parameters : KeepingParameters, optional
    """

    def __init__(self, parameters: KeepingParameters | None = None) -> None:
        self._parameters = parameters or KeepingParameters()
        self._frames: deque[tuple[int, Frame]] = deque(maxlen=self._parameters.frames)
        self._held: deque[tuple[int, Frame]] = deque(maxlen=self._parameters.held)

    def add(self, sequence: int, frame: Frame) -> None:
        """Keep a picture; the oldest goes."""
        self._frames.append((sequence, frame))
        while len(self._frames) > 2 and len(self._frames) * frame.image.nbytes > self._parameters.memory:
            self._frames.popleft()

    def clear(self) -> None:
        """Forget all pictures."""
        self._frames.clear()
        self._held.clear()

    def hold(self, sequence: int) -> None:
        """Keep a picture for longer: somebody draws in it.

        Raises
        ------
        ValueError
            If it is not kept any more, or never was.
        """
        if all(number != sequence for number, _ in self._held):
            self._held.append((sequence, self.since(sequence)[0]))

    def since(self, sequence: int) -> list[Frame]:
        """Return the picture of this number and all after it that are kept, oldest first.

        Raises
        ------
        ValueError
            If it is not kept any more, or never was.
        """
        kept = {number: frame for number, frame in (*self._held, *self._frames) if number == sequence}
        if not kept:
            raise ValueError(f"picture {sequence} is not kept any more: click again")
        return [kept[sequence], *self.after(sequence)]

    def after(self, sequence: int) -> list[Frame]:
        """Return the pictures after this number that are kept, oldest first."""
        return [frame for number, frame in self._frames if number > sequence]

    @property
    def newest(self) -> Frame | None:
        """The newest picture; None if there is none yet."""
        return self._frames[-1][1] if self._frames else None
