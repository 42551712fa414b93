"""What a benchmark found: figures, and the goals they are held against."""

import math
from typing import Literal

import msgspec

Verdict = Literal["prize", "bar", "missed", "-"]


class Figure(msgspec.Struct, frozen=True):
    """One measured number.

    Parameters
    ----------
    name : str
        What it is, unique within its finding.
    value : float or None
        None where nothing could be measured.
    unit : str
        "px", "%", "us", or empty.
    digits : int
        Decimals to show.
    aside : bool
        Not shown in the table of results: only in the details and for programs.
    """

    name: str
    value: float | None
    unit: str = ""
    digits: int = 2
    aside: bool = False

    @property
    def text(self) -> str:
        """The number with its unit."""
        return quantity(self.value, self.unit, self.digits)

    def __str__(self) -> str:
        return f"{self.name} {self.text}"


class Goal(msgspec.Struct, frozen=True):
    """The range in which a figure must lie.

    Parameters
    ----------
    figure : str
        Name of the figure.
    low, high : float
        Least and largest value that hold.
    """

    figure: str
    low: float = -math.inf
    high: float = math.inf

    def holds(self, figure: Figure) -> bool:
        """Say whether a figure lies in the range; one that could not be measured does not."""
        return figure.value is not None and self.low <= figure.value <= self.high

    def words(self, unit: str) -> str:
        """Write the goal for people."""
        if math.isinf(self.low):
            return f"{self.figure} ≤ {quantity(self.high, unit)}"
        if math.isinf(self.high):
            return f"{self.figure} ≥ {quantity(self.low, unit)}"
        return f"{self.figure} {self.low:g} … {quantity(self.high, unit)}"


class Finding(msgspec.Struct, frozen=True, kw_only=True):
    """One row of the results.

    Parameters
    ----------
    name : str
        Unique and short, for programs.
    what : str
        What was measured, for people.
    figures : tuple of Figure
        The numbers.
    bar, prize : tuple of Goal
        What is asked, and what is hoped for; none: the row is for information.
    """

    name: str
    what: str
    figures: tuple[Figure, ...]
    bar: tuple[Goal, ...] = ()
    prize: tuple[Goal, ...] = ()

    def __post_init__(self) -> None:
        names = [figure.name for figure in self.figures]
        strange = [goal.figure for goal in (*self.bar, *self.prize) if goal.figure not in names]
        if strange:
            raise ValueError(f"{self.name} has goals for {strange}, but its figures are {names}")

    @property
    def verdict(self) -> Verdict:
        """The best of "prize", "bar" and "missed" that is true; "-" without goals."""
        if not self.bar and not self.prize:
            return "-"
        if not self._hold(self.bar):
            return "missed"
        return "prize" if self.prize and self._hold(self.prize) else "bar"

    def figure(self, name: str) -> Figure:
        """Return the figure of this name."""
        return next(figure for figure in self.figures if figure.name == name)

    def goals(self, goals: tuple[Goal, ...]) -> str:
        """Write goals for people."""
        return ", ".join(goal.words(self.figure(goal.figure).unit) for goal in goals) or "-"

    def measured(self) -> str:
        """Write the figures for people."""
        return ", ".join(str(figure) for figure in self.figures if not figure.aside) or "-"

    def _hold(self, goals: tuple[Goal, ...]) -> bool:
        return all(goal.holds(self.figure(goal.figure)) for goal in goals)


class Picture(msgspec.Struct, frozen=True):
    """A picture in the folder of pictures.

    Parameters
    ----------
    file : str
        Name of the file.
    caption : str
        What it shows.
    """

    file: str
    caption: str


class Section(msgspec.Struct, frozen=True):
    """What one benchmark has to say.

    Parameters
    ----------
    title : str
        Its headline.
    findings : list of Finding
        Its rows.
    text : str
        How it was measured, and tables with more of it, in Markdown.
    pictures : tuple of Picture
        Those that were drawn.
    """

    title: str
    findings: list[Finding]
    text: str = ""
    pictures: tuple[Picture, ...] = ()


def quantity(value: float | None, unit: str = "", digits: int | None = None) -> str:
    """Write a number with its unit, or "-" for None."""
    if value is None or math.isnan(value):
        return "-"
    number = f"{value:g}" if digits is None or math.isinf(value) else f"{value:.{digits}f}"
    return f"{number} {unit}" if unit else number


def table(head: list[str], rows: list[list[str]]) -> str:
    """Write a table in Markdown; all columns but the first are aligned to the right."""
    lines = [head, ["---"] + ["---:"] * (len(head) - 1), *rows]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in lines) + "\n"
