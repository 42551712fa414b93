"""Figures that are kept in the repository, and what is worse than they are: `Kept`, `read`, `write`, `worse`."""

import math
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import msgspec

from benchmarks.machine import Machine
from benchmarks.regression.figures import EXCEPTIONS, Figure

KEPT = Path(__file__).resolve().parent / "kept.toml"


class Origin(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """When, of which code and where a section was measured, and how long that took, s."""

    date: str
    commit: str
    machine: str
    seconds: float

    @classmethod
    def here(cls, seconds: float) -> "Origin":
        """Describe what is measured here and now."""
        machine = Machine.here()
        return cls(machine.date, machine.commit, f"{machine.processor}, {machine.cores} cores", round(seconds))


class Kept(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What `kept.toml` holds.

    Parameters
    ----------
    sections : dict of str to Origin
    figure : list of Figure
    """

    sections: dict[str, Origin]
    figure: list[Figure]

    def without(self, section: str, keys: Iterable[str]) -> "Kept":
        """Return it without the figures of a section, which has the figures of some keys and its exceptions."""
        gone = set(keys)
        left = [f for f in self.figure if f.section not in gone and f.key[:2] != (EXCEPTIONS, section)]
        return Kept(self.sections, left)

    def replaced(self, sections: Mapping[str, Origin], figures: Sequence[Figure]) -> "Kept":
        """Return it with what was measured anew."""
        new = {figure.key: figure for figure in figures}
        known = {figure.key: figure for figure in self.figure}
        every = {**known, **new}
        return Kept({**self.sections, **sections}, list(every.values()))


def read(path: Path = KEPT) -> Kept:
    """Read what is kept; nothing where there is no file.

    Raises
    ------
    ValueError
        If the file is no TOML, or holds anything else.
    """
    if not path.exists():
        return Kept({}, [])
    return msgspec.convert(tomllib.loads(path.read_text(encoding="utf-8")), Kept)


def write(kept: Kept, path: Path = KEPT) -> None:
    """Write what is kept, one table for each figure."""
    lines = [
        "# What `make bench-real` compares with. Written by `python -m benchmarks.regression --store`.",
        "# `noise` and `factor`: how much worse a figure may be, see `figures.py`.",
    ]
    for name, origin in kept.sections.items():
        lines += ["", f'[sections."{name}"]', *_fields(msgspec.structs.asdict(origin))]
    for figure in kept.figure:
        lines += ["", "[[figure]]", *_fields(msgspec.structs.asdict(figure))]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _fields(values: Mapping[str, str | float]) -> list[str]:
    return [f"{name} = {_written(value)}" for name, value in values.items()]


def _written(value: str | float) -> str:
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    return "nan" if math.isnan(value) else f"{float(value):.6g}" if value % 1.0 else f"{value:.1f}"


def worse(measured: Iterable[Figure], kept: Kept, slack: float = 1.0) -> list[str]:
    """Say which figures are worse than the kept ones beyond noise, and which are not kept beside others of a section.

    Parameters
    ----------
    measured : iterable of Figure
    kept : Kept
    slack : float
        Factor on the limits of times.

    Returns
    -------
    list of str
    """
    known = {figure.key: figure for figure in kept.figure}
    begun, words = {figure.section for figure in kept.figure}, []
    for figure in (figure for figure in measured if figure.section in begun):
        before = known.get(figure.key)
        if before is None:
            words.append(f"{figure.words}: is not kept (python -m benchmarks.regression --store)")
        elif not before.passes(figure.value, slack):
            limit = before.limit(slack)
            words.append(f"{figure.words}: {figure.value:.3f}, kept {before.value:.3f}, passes to {limit:.3f}")
    return words


def unknown(measured: Iterable[Figure], kept: Kept) -> list[str]:
    """Name the sections of which nothing is kept yet: they are shown, and neither better nor worse."""
    begun = {figure.section for figure in kept.figure}
    new = dict.fromkeys(figure.section for figure in measured if figure.section not in begun)
    return [f"{section}: nothing is kept of it yet (python -m benchmarks.regression --store)" for section in new]


def missing(measured: Iterable[Figure], kept: Kept, sections: Iterable[str]) -> list[str]:
    """Say which kept figures of some sections were not measured."""
    found, chosen = {figure.key for figure in measured}, set(sections)
    return [
        f"{figure.words}: is kept but was not measured"
        for figure in kept.figure
        if figure.section in chosen and figure.key not in found
    ]
