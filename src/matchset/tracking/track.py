"""What a tracker answers: `Track` where this frame's pixels confirm the shape, `Lost` where they do not."""

import enum
import html
import math
from typing import Any, Generic, TypeVar

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.numeric.words import measured, one_line, short, table_of
from matchset.shapes.described import drawing_of, unit_of

S = TypeVar("S")
A = TypeVar("A", bound="Track[Any] | Lost[Any]")


class Mode(enum.Enum):
    """What a tracker is doing.

    Attributes
    ----------
    SEARCHING
        It looks for the shape in the whole frame.
    TRACKING
        It expects the shape near its prediction.
    COASTING
        The same, but the shape was not seen in the last frame.
    """

    SEARCHING, TRACKING, COASTING = range(3)


class Acquisition(msgspec.Struct, frozen=True):
    """When a shape was found that was not seen in the frame before, and how sure that was.

    Parameters
    ----------
    time : float
        Of that frame, s.
    log_odds : float or None
        That what was found there is the target, of all that was known then: outline, network, color, size and place.
        None where nothing is weighed, as for gray edges.
    """

    time: float
    log_odds: float | None = None

    @property
    def probability(self) -> float | None:
        """The same as a probability."""
        return None if self.log_odds is None else 0.5 + 0.5 * math.tanh(0.5 * self.log_odds)


class Track(msgspec.Struct, Generic[S], frozen=True):
    """A shape that this frame's own pixels confirm.

    Parameters
    ----------
    shape : S
        The shape, px and rad.
    covariance : ndarray of shape (p, p), float64
        Covariance of the shape's parameters, in their order.
    support : float
        Share of the outline (as far as it lies in the picture) that edge points confirm, 0 ... 1.
    match_set : ndarray of shape (m, 2), float64
        The edge points that decided the fit, px (Epstein & Feldman, Eq. 4); gross outliers are left out.
    time : float
        The frame's time, s.
    acquired : Acquisition or None
        When it was found, or found again after it was lost: since then it is followed from frame to frame. Of this
        frame if `acquired.time` is its time. None where `Tracker.start` said where it is.
    field_offset : tuple of float
        In a picture of two interlaced fields, from where the odd rows show the shape to where the even rows do, px; the
        shape is midway. Near 0 in other pictures, and of a shape at rest.
    pixel_aspect : float
        Width of a pixel of the frame in its heights, `Frame.pixel_aspect`: only where it is 1 can a ball be located.
    """

    shape: S
    covariance: npt.NDArray[np.float64]
    support: float
    match_set: npt.NDArray[np.float64]
    time: float
    acquired: Acquisition | None = None
    field_offset: tuple[float, float] = (0.0, 0.0)
    pixel_aspect: float = 1.0

    def measured(self) -> dict[str, tuple[float, float | None]]:
        """Return the shape's parameters by name, px and rad, with their standard deviations; None if not finite."""
        names, variances = self.shape.parameters, np.diagonal(self.covariance).tolist()  # type: ignore[attr-defined]
        return {
            name: (float(getattr(self.shape, name)), _root(variance))
            for name, variance in zip(names, variances, strict=True)
        }

    def to_dict(self) -> dict[str, Any]:
        """Return it for JSON, under the names of `tracks.csv`: px, rad and s; the match-set is left out."""
        found = self.measured()
        return {
            "shape": type(self.shape).__name__,
            "time": float(self.time),
            "found": True,
            **{name: value for name, (value, _) in found.items()},
            **{f"{name}_std": sigma for name, (_, sigma) in found.items() if sigma is not None},
            "support": float(self.support),
            "points": len(self.match_set),
        }

    @one_line
    def __repr__(self) -> str:
        numbers = ", ".join(f"{name} {words}" for name, words in self._in_words())
        rest = f"support {100.0 * self.support:.0f} %, {len(self.match_set)} points, {short(self.time)} s"
        return f"Track({type(self.shape).__name__} {numbers}, {rest})"

    def _repr_html_(self) -> str:
        """Show numbers, outline and match-set in a notebook."""
        rest = ("support", f"{100.0 * self.support:.0f} %"), ("match-set", f"{len(self.match_set)} points")
        rows = [*self._in_words(), *rest, ("time", f"{short(self.time)} s")]
        table = table_of(f"Track: {type(self.shape).__name__}", rows)
        return f"<div style='display:flex;gap:1em'>{table}{drawing_of(self.shape, self.match_set)}</div>"

    def _in_words(self) -> list[tuple[str, str]]:
        return [
            (name, f"{measured(value, sigma)} {unit_of(name)}".rstrip())
            for name, (value, sigma) in self.measured().items()
        ]


class Lost(msgspec.Struct, Generic[S], frozen=True):
    """No shape in this frame, and why; false in a condition.

    Parameters
    ----------
    reason : str
        In words a user understands.
    time : float
        The frame's time, s.
    predicted : S or None
        Where the motion says the shape is, while the tracker coasts.
    """

    reason: str
    time: float
    predicted: S | None = None

    def __bool__(self) -> bool:
        return False

    def to_dict(self) -> dict[str, Any]:
        """Return it for JSON, under the names of `tracks.csv`; `predicted` as the shape's parameters, or None."""
        shape: Any = self.predicted
        named = None if shape is None else {name: float(getattr(shape, name)) for name in shape.parameters}
        return {"time": float(self.time), "found": False, "reason": self.reason, "predicted": named}

    @one_line
    def __repr__(self) -> str:
        expected = "" if self.predicted is None else f", expected at {self.predicted!r}"
        return f"Lost({self.reason!r}, {short(self.time)} s{expected})"

    def _repr_html_(self) -> str:
        """Show the reason in a notebook."""
        return f"<b style='color:#c06000'>Lost</b> at {html.escape(short(self.time))} s: {html.escape(self.reason)}"


def mirrored(answer: A, time: float, twice: float) -> A:
    """Return what a tracker answered that was shown a frame at another time, mirrored, in the frame's own time.

    Parameters
    ----------
    answer : Track or Lost
    time : float
        Of the frame, s.
    twice : float
        Twice the time at which times were mirrored, s.
    """
    if isinstance(answer, Lost) or answer.acquired is None:
        return msgspec.structs.replace(answer, time=time)
    acquired = time if answer.acquired.time == answer.time else twice - answer.acquired.time  # to the last bit
    return msgspec.structs.replace(answer, time=time, acquired=msgspec.structs.replace(answer.acquired, time=acquired))


def _root(variance: float) -> float | None:
    """Return the root of a variance; None where there is none."""
    return math.sqrt(variance) if 0.0 <= variance < math.inf else None
