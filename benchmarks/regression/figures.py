"""What is measured: `Figure`, which of two values is better, and how much worse is noise: `Kind`."""

import math
from typing import Literal

import msgspec

EXCEPTIONS = "exceptions"
"""Section of the figures that count exceptions; the subject is what was measured then."""
Better = Literal["larger", "smaller"]


class Kind(msgspec.Struct, frozen=True):
    """Which values are better, and how much worse counts as noise.

    Parameters
    ----------
    better : str
        "larger" or "smaller".
    noise : float
        How much worse may be, in the unit of the figure.
    factor : float
        By how much a time may be multiplied.
    why : str
        The reason for noise and factor.
    """

    better: Better
    noise: float
    factor: float
    why: str


ROW = Kind("larger", 0.0, 1.0, "one row of the clip: where an answer is 5 px off, a rounding decides")
MEAN_SHARE = Kind("larger", 0.5, 1.0, "half a point of a mean over clips or videos: one row of one of them, or a few")
QUANTILE = Kind("larger", 2.0, 1.0, "two points: a quantile rests on one or two videos")
LEAST = Kind("larger", 2.5, 1.0, "one row of a clip with forty")
ERROR = Kind("smaller", 0.05, 1.1, "a tenth and 0.05 px: a tenth of what a label is good for")
NOTHING = Kind("smaller", 0.5, 1.0, "less than one click of a hundred")
COUNT = Kind("smaller", 1.0, 1.0, "one answer: where a rule is passed by a hair, a rounding decides")
SOME = Kind("smaller", 2.0, 1.05, "two answers, and a twentieth of many: a drift that once is far stays so some frames")
STILLS = Kind("larger", 2.0, 1.0, "two balls of a hundred, or one of a folder: a rounding decides over a faint one")
FLIGHT = Kind("smaller", 0.5, 1.1, "half a centimeter and a tenth: a picture that is answered otherwise moves a flight")
NEVER = Kind("smaller", 0.0, 1.0, "none: it must be 0, or what it was")
BEGUN = Kind("larger", 2.0, 1.0, "one click of fifty")
MEDIAN = Kind("smaller", 0.1, 1.3, "a median of minima varies by a tenth on a quiet machine")
TAIL = Kind("smaller", 0.1, 1.5, "90 and 99 % rest on twenty and two frames of two hundred")
WORST = Kind("smaller", 0.1, 2.0, "one frame, which the machine may have disturbed in each run")
THREADS = Kind("smaller", 0.1, 1.0, "a tenth: what interrupts a process is counted to it")
INFORMATION = Kind("smaller", math.inf, 1.0, "any: it is shown for information")

KINDS = (
    ROW,
    MEAN_SHARE,
    QUANTILE,
    LEAST,
    ERROR,
    NOTHING,
    COUNT,
    SOME,
    STILLS,
    FLIGHT,
    NEVER,
    BEGUN,
    MEDIAN,
    TAIL,
    WORST,
    THREADS,
    INFORMATION,
)


class Figure(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A value, and how much worse than it is noise.

    Parameters
    ----------
    section : str
        What is measured: the key of one of the sections.
    subject : str
        On what: a clip, or "all" of them.
    name : str
        Of the figure, with its unit.
    value : float
        Not a number where nothing could be measured.
    better : str
        "larger" or "smaller".
    noise, factor : float
        How much worse it may be, and by how much it may be multiplied.
    """

    section: str
    subject: str
    name: str
    value: float
    better: Better
    noise: float = 0.0
    factor: float = 1.0

    @classmethod
    def of(
        cls, where: tuple[str, str], name: str, value: float | None, kind: Kind, noise: float | None = None
    ) -> "Figure":
        """Make a figure of a kind.

        Parameters
        ----------
        where : tuple of two str
            Section and subject.
        name : str
        value : float or None
            None where nothing could be measured.
        kind : Kind
        noise : float, optional
            In place of the kind's.

        Returns
        -------
        Figure
        """
        section, subject = where
        return cls(
            section=section,
            subject=subject,
            name=name,
            value=math.nan if value is None else float(value),
            better=kind.better,
            noise=kind.noise if noise is None else noise,
            factor=kind.factor,
        )

    @property
    def key(self) -> tuple[str, str, str]:
        """What it is, unique."""
        return self.section, self.subject, self.name

    @property
    def words(self) -> str:
        """What it is, for people."""
        return ": ".join(self.key)

    def limit(self, slack: float = 1.0) -> float:
        """Return the worst value that passes.

        Parameters
        ----------
        slack : float
            Factor on the limits of times.

        Returns
        -------
        float
        """
        if self.better == "larger":
            return self.value / self.factor - self.noise
        return self.value * self.factor * (slack if self.is_time else 1.0) + self.noise

    @property
    def is_time(self) -> bool:
        """Whether it hangs on the machine."""
        return self.name.endswith(", ms")

    def passes(self, measured: float, slack: float = 1.0) -> bool:
        """Say whether a value is no worse than this one, beyond noise; one that is missing is worse than any."""
        if math.isnan(self.value):
            return True
        tiny = 1e-9 * max(abs(self.value), 1.0)
        if self.better == "larger":
            return measured >= self.limit(slack) - tiny
        return measured <= self.limit(slack) + tiny
