"""What a page says of targets."""

from typing import Annotated, ClassVar

import msgspec

from matchset.app.live.wire.messages import Name, Number, Positive, Px, Up


class Pick(Up, frozen=True, tag="pick"):
    """Follow what is at a point of a picture, px; `shape` is a family of shapes."""

    tracks: ClassVar[bool] = True

    sequence: Number
    x: Px
    y: Px
    shape: Name = "circle"
    stream: Number = 0


class Outline(Up, frozen=True, tag="outline"):
    """Follow the circle that was drawn along a rim in a picture, px."""

    tracks: ClassVar[bool] = True

    sequence: Number
    x: Px
    y: Px
    radius: Positive
    shape: Name = "circle"
    stream: Number = 0


class Drop(Up, frozen=True, tag="drop"):
    """Do not follow a target any more."""

    target: Number


class Diameter(Up, frozen=True, tag="diameter"):
    """A target's diameter, m; None: not known."""

    target: Number
    meters: Annotated[float, msgspec.Meta(gt=0.0, le=20.0)] | None


class FieldOfView(Up, frozen=True, tag="field_of_view"):
    """The camera's horizontal field of view, rad."""

    angle: Annotated[float, msgspec.Meta(gt=0.0, lt=3.1)]


Wish = Pick | Outline | Drop | Diameter | FieldOfView
MESSAGES: tuple[type[Up], ...] = (Pick, Outline, Drop, Diameter, FieldOfView)
