"""What a page says of targets."""

from typing import Annotated

import msgspec

from matchset.live.wire.messages import Kernels, Name, Number, PageMessage, Positive, Px

Length = Annotated[float, msgspec.Meta(gt=0.0, le=20.0)]
Sigma = Annotated[float, msgspec.Meta(ge=0.0, le=20.0)]


class Pick(PageMessage, frozen=True, tag="pick"):
    """Follow what is at a point of a picture, px: the likeliest `reading` of it; `shape` is a family of shapes.

    `click` is a number that the page gives: the answer carries it.
    """

    sequence: Number
    x: Px
    y: Px
    shape: Name = "circle"
    stream: Number = 0
    reading: Annotated[int, msgspec.Meta(ge=1, le=100)] = 1
    click: Number = 0

    @property
    def needs(self) -> Kernels:
        """Code for this shape."""
        return Kernels.CIRCLE if self.shape == "circle" else Kernels.ALL


class Outline(PageMessage, frozen=True, tag="outline"):
    """Follow the shape whose rim was drawn in a picture: x and y of points along it, px, one after the other.

    `click` is a number that the page gives: the answer carries it.
    """

    sequence: Number
    points: Annotated[list[Px], msgspec.Meta(min_length=6, max_length=400)]
    shape: Name = "circle"
    stream: Number = 0
    click: Number = 0

    @property
    def needs(self) -> Kernels:
        """Code for this shape."""
        return Kernels.CIRCLE if self.shape == "circle" else Kernels.ALL


class Hold(PageMessage, frozen=True, tag="hold"):
    """Somebody draws in this picture: it is kept until the line is done, however long that takes."""

    sequence: Number
    stream: Number = 0


class Drop(PageMessage, frozen=True, tag="drop"):
    """Do not follow a target any more."""

    target: Number


class Reread(PageMessage, frozen=True, tag="reread"):
    """A target's click means another one of its readings: 1 is the likeliest."""

    target: Number
    reading: Annotated[int, msgspec.Meta(ge=1, le=100)]


class Rename(PageMessage, frozen=True, tag="rename"):
    """Call a target by another name, which no other one has."""

    target: Number
    name: Name


class FindAll(PageMessage, frozen=True, tag="find_all"):
    """Follow all that looks like a target, too; `on` false: look for no more of them."""

    target: Number
    on: bool = True

    @property
    def needs(self) -> Kernels:
        """Code that follows several."""
        return Kernels.ALL


class Diameter(PageMessage, frozen=True, tag="diameter"):
    """A target's diameter, m; None: not known. `sigma` is its standard deviation, m; 0: taken as exact."""

    target: Number
    meters: Length | None
    sigma: Sigma = 0.0


class Marker(PageMessage, frozen=True, tag="marker"):
    """A ball has a marker at a point of a picture, px, that is `meters` wide."""

    target: Number
    sequence: Number
    x: Px
    y: Px
    meters: Positive = 0.06

    @property
    def needs(self) -> Kernels:
        """Code that looks for markers."""
        return Kernels.ALL


class FieldOfView(PageMessage, frozen=True, tag="field_of_view"):
    """The camera's horizontal field of view, rad. `sigma` is its standard deviation, rad; 0: taken as exact."""

    angle: Annotated[float, msgspec.Meta(gt=0.0, lt=3.1)]
    sigma: Annotated[float, msgspec.Meta(ge=0.0, lt=3.1)] = 0.0


Begin = Pick | Outline
Wish = Pick | Outline | Hold | Drop | Reread | Rename | FindAll | Diameter | Marker | FieldOfView
MESSAGES: tuple[type[PageMessage], ...] = (
    Pick,
    Outline,
    Hold,
    Drop,
    Reread,
    Rename,
    FindAll,
    Diameter,
    Marker,
    FieldOfView,
)
