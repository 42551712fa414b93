"""What a user turns of a tracker: `TrackerParameters`; everything else is in `TrackerConstants`."""

import math
from typing import Any

import msgspec

from matchset.fitting.prior import FieldParameters
from matchset.numeric.arguments import check_number, checked_count, require
from matchset.tracking.constants import TrackerConstants

MOST_LOOKS = 1000  # format: of the network at a picture
NUMBERS = "coast", "size_sigma", "agility", "prior_sigmas", "faint_score", "color_rate"  # format: dials, real numbers


class TrackerParameters(msgspec.Struct, frozen=True, kw_only=True, repr_omit_defaults=True):
    """The dials of a tracker. One that is None leaves what the constants say.

    Parameters
    ----------
    coast : float, optional
        How long a target that is not seen is expected near its prediction, s; default 0.35. More: one that is hidden
        for longer is still found first where it should come out. Less: one that jumps is found elsewhere sooner.
    whole_frame : bool, optional
        Whether a lost target is looked for in the whole picture; default true. False: only where it may have got to,
        at less cost, and it is not found again where it enters elsewhere.
    asks_network : bool, optional
        Whether the network of discs is asked about balls of a color; default true. False: several times as fast where
        the ball is lost or ambiguous, with more losses and more locks on things like it.
    looks : int, optional
        Times that the network looks at a picture, at most; default 6. Each costs about half a millisecond. More: balls
        that are far from where they were expected are found sooner.
    moves : bool, optional
        Whether a ball is looked for where something has moved; default true. False: saves a millisecond where the
        camera itself flies; small fast balls are lost before a camera that stands.
    size_sigma : float, optional
        Standard deviation of ln(radius) from one picture to the next where the network is asked; default 0.12. Less:
        outlines do not swell beside things of the same color. More: a ball that comes near fast is followed.
    agility : float, optional
        Share of the latest innovation that the velocity follows, 0 ... 1; default 0.7. More: sudden turns are followed.
        Less: steadier where noise is large.
    prior_sigmas : float, optional
        How far a fit may be from its prediction, in innovations; default 0.5. Less: steadier where few edges are seen.
    faint_score : float, optional
        Color score of the outline below which it is seen faintly, 0 ... 1; default 0.4. Less: dim targets are held
        for longer. More: doubtful ones are given up sooner.
    color_rate : float, optional
        How fast the color follows slow changes of the light, log-odds per look; default 0.8. 0: the color stays as it
        was clicked.
    follows_light : bool, optional
        Whether sudden changes of the light of the whole picture are followed; default true.
    constants : TrackerConstants, optional
        All other numbers, those of this version of matchset if None; `matchset params` prints them as a file.

    Raises
    ------
    ValueError
        If a dial is out of its range.

    Examples
    --------
    >>> import matchset as ms
    >>> ms.TrackerParameters(coast=0.1, looks=3)
    TrackerParameters(coast=0.1, looks=3)
    """

    coast: float | None = None
    whole_frame: bool | None = None
    asks_network: bool | None = None
    looks: int | None = None
    moves: bool | None = None
    size_sigma: float | None = None
    agility: float | None = None
    prior_sigmas: float | None = None
    faint_score: float | None = None
    color_rate: float | None = None
    follows_light: bool | None = None
    constants: TrackerConstants | None = None

    def __post_init__(self) -> None:
        """Refuse dials that are out of their range (ValueError)."""
        if self.looks is not None:
            checked_count("looks", self.looks, 1, MOST_LOOKS)
        given = [name for name in NUMBERS if getattr(self, name) is not None]
        for name in given:
            check_number(name, getattr(self, name))
        require(self, given, math.isfinite, "a finite number")
        require(self, given, lambda value: value >= 0.0, "0 or more")
        require(self, set(given) & {"agility", "faint_score"}, lambda value: value <= 1.0, "1 or less")
        require(self, set(given) & {"size_sigma"}, lambda value: value > 0.0, "more than 0")

    def resolved(self) -> TrackerConstants:
        """Lay the dials into the constants.

        Returns
        -------
        TrackerConstants
            With which a tracker works.
        """
        constants = self.constants or TrackerConstants()
        for dial, path in DIALS.items():
            value = getattr(self, dial)
            if value is not None:
                constants = _replaced(constants, path, value)
        return constants


DIALS = {
    "coast": ("coast",),
    "whole_frame": ("search", "whole_frame"),
    "asks_network": ("network", "used"),
    "looks": ("network", "looks"),
    "moves": ("ball", "moves"),
    "size_sigma": ("network", "size_sigma"),
    "agility": ("motion", "gain"),
    "prior_sigmas": ("motion", "prior_sigmas"),
    "faint_score": ("confidence", "faint_score"),
    "color_rate": ("adaptation", "rate"),
    "follows_light": ("relighting", "used"),
}
"""Format: where in the constants each dial is."""

IN_FLIGHT = TrackerParameters(looks=4, size_sigma=0.03, constants=TrackerConstants(fields=FieldParameters(memory=0.98)))
"""How a vehicle follows its neighbor's ball.

Few looks, since a command waits for them; no ball grows by more than 3 % from one picture to the next; and the fields
of one camera lie as far apart as they are. Chosen on a rendered flight, seed 1107.
"""


def value_at(constants: msgspec.Struct, path: tuple[str, ...]) -> Any:
    """Value of a dial in the constants.

    Parameters
    ----------
    constants : TrackerConstants
    path : tuple of str
        See `DIALS`.
    """
    for name in path:
        constants = getattr(constants, name)
    return constants


def _replaced(struct: Any, path: tuple[str, ...], value: object) -> Any:
    """Copy a struct with another value at a path."""
    name, *rest = path
    inner = _replaced(getattr(struct, name), tuple(rest), value) if rest else value
    return msgspec.structs.replace(struct, **{name: inner})
