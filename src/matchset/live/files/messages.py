"""What a page says of a recorded video."""

from typing import Annotated, Literal

import msgspec

from matchset.live.wire.messages import Number, PageMessage, Px

Factor = Annotated[float, msgspec.Meta(ge=0.05, le=16.0)]
Frames = Annotated[int, msgspec.Meta(ge=-1_000_000, le=1_000_000)]


class Play(PageMessage, frozen=True, tag="play"):
    """Play on from here; at the end, from the beginning."""


class Pause(PageMessage, frozen=True, tag="pause"):
    """Stop at the picture that is shown."""


class Step(PageMessage, frozen=True, tag="step"):
    """Stop, and go on by a number of frames; back if it is negative."""

    frames: Frames = 1


class Seek(PageMessage, frozen=True, tag="seek"):
    """Show the frame of this index, or the next one that decodes."""

    index: Number


class Speed(PageMessage, frozen=True, tag="speed"):
    """How fast to play, as a multiple of the real rate."""

    factor: Factor


class Correct(PageMessage, frozen=True, tag="correct"):
    """A target is at this point of a picture, px: follow it anew from there on."""

    target: Number
    sequence: Number
    x: Px
    y: Px


class Export(PageMessage, frozen=True, tag="export"):
    """Write what was found of a target: its tables, or the annotated video."""

    target: Number
    what: Literal["tables", "film"]


class StopExport(PageMessage, frozen=True, tag="stop_export"):
    """Stop writing; what is not finished is deleted."""


MESSAGES: tuple[type[PageMessage], ...] = (Play, Pause, Step, Seek, Speed, Correct, Export, StopExport)
