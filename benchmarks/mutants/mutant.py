"""Mutants as data: `load` reads them, `Mutant.apply` makes one."""

import functools
import hashlib
import tomllib
from pathlib import Path
from typing import Annotated

import msgspec

ROOT = Path(__file__).resolve().parents[2]
LISTS = Path(__file__).resolve().parent


class Mutant(msgspec.Struct, frozen=True):
    """One line that is broken.

    Attributes
    ----------
    group : str
        Name of its list.
    path : str
        The file, from the root of the repository.
    before, after : str
        A fragment that occurs once in the file, and what replaces it.
    tests : tuple of str
        Arguments of pytest: what is to notice it, the fastest first.
    quick : bool
        Whether it is of the subset that CI runs.
    """

    group: str
    path: str
    before: str
    after: str
    tests: tuple[str, ...]
    quick: bool = False

    def apply(self, source: str) -> str:
        """Return the source with the fragment replaced.

        Raises
        ------
        ValueError
            If the fragment does not occur exactly once, or nothing would change.
        """
        count = source.count(self.before)
        if count != 1 or self.before == self.after:
            raise ValueError(f"{self.path}: {self.before!r} must occur once and change, it occurs {count} times")
        return source.replace(self.before, self.after)

    def key(self, root: Path = ROOT) -> str:
        """Hash of the mutant and its file: while it stays, a mutant that was noticed is not run again."""
        return _hash(self.path, self.before, self.after, (root / self.path).read_text(encoding="utf-8"))

    def tests_key(self, root: Path = ROOT) -> str:
        """Hash of its tests: while it stays, a mutant that lived is not run again."""
        return _hash(*self.tests, *_texts(tuple(test.split("::")[0] for test in self.tests), root))


@functools.cache
def _texts(paths: tuple[str, ...], root: Path) -> list[str]:
    """Contents of files, and of the modules in folders; what is no path has none."""
    found = []
    for path in map(root.joinpath, paths):
        files = sorted(path.rglob("*.py")) if path.is_dir() else [path] if path.is_file() else []
        found += [file.read_text(encoding="utf-8") for file in files]
    return found


def _hash(*texts: str) -> str:
    return hashlib.sha256(repr(texts).encode()).hexdigest()[:24]


class _File(msgspec.Struct, forbid_unknown_fields=True):
    path: str
    tests: list[str]
    mutants: list[Annotated[list[str], msgspec.Meta(min_length=2, max_length=3)]]


def load(groups: tuple[str, ...] = ()) -> list[Mutant]:
    """Read the lists.

    Parameters
    ----------
    groups : tuple of str
        Names of lists; none for all.

    Raises
    ------
    ValueError
        If there is no list of a name, or a mutant is no pair of texts, with ``"quick"`` behind it or not.
    """
    known = {path.stem: path for path in sorted(LISTS.glob("*.toml"))}
    if unknown := set(groups) - set(known):
        raise ValueError(f"lists are {', '.join(known)}, got {', '.join(sorted(unknown))}")
    found = []
    for group in groups or known:
        content = tomllib.loads(known[group].read_text(encoding="utf-8"))
        for file in msgspec.convert(content["file"], list[_File]):
            for before, after, *mark in file.mutants:
                if mark not in ([], ["quick"]):
                    raise ValueError(f"{group}: a mutant is marked quick or not at all, got {mark}")
                found.append(Mutant(group, file.path, before, after, tuple(file.tests), bool(mark)))
    return found
