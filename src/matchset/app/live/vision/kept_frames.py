"""The last pictures that went out, so that a click means the picture that was seen: `KeptFrames`."""

from collections import deque

import msgspec

from matchset.image.frame import Frame


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
    """

    frames: int = 60
    memory: int = 180_000_000

    def __post_init__(self) -> None:
        if self.frames < 1:
            raise ValueError(f"frames must be 1 or more, got {self.frames}")


class KeptFrames:
    """The last pictures by their sequence numbers.

    Parameters
    ----------
    parameters : KeepingParameters, optional
    """

    def __init__(self, parameters: KeepingParameters | None = None) -> None:
        self._parameters = parameters or KeepingParameters()
        self._frames: deque[tuple[int, Frame]] = deque(maxlen=self._parameters.frames)

    def add(self, sequence: int, frame: Frame) -> None:
        """Keep a picture; the oldest goes."""
        self._frames.append((sequence, frame))
        while len(self._frames) > 2 and len(self._frames) * frame.image.nbytes > self._parameters.memory:
            self._frames.popleft()

    def clear(self) -> None:
        """Forget all pictures."""
        self._frames.clear()

    def since(self, sequence: int) -> list[Frame]:
        """Return the picture of this number and all after it, oldest first.

        Raises
        ------
        ValueError
            If it is not kept any more, or never was.
        """
        kept = [frame for number, frame in self._frames if number >= sequence]
        if not any(number == sequence for number, _ in self._frames):
            raise ValueError(f"picture {sequence} is not kept any more: click again")
        return kept

    def after(self, sequence: int) -> list[Frame]:
        """Return the pictures after this number that are kept, oldest first."""
        return [frame for number, frame in self._frames if number > sequence]

    @property
    def newest(self) -> Frame | None:
        """The newest picture; None if there is none yet."""
        return self._frames[-1][1] if self._frames else None
