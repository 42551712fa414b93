"""Where output is written: a new numbered folder in `runs/`, or what was asked for; nothing is overwritten.

`check_run` and `check_outputs` compare all that a command writes with all that it reads before it opens anything; they
are called first and import nothing heavy, so that a wrong name is said at once. `output_folder` and `output_file` make
the folders, and look once more.
"""

import contextlib
import errno
import os
import re
from collections.abc import Iterable, Iterator
from itertools import combinations
from pathlib import Path

RUNS = Path("runs")


def check_run(
    folder: Path | None,
    names: Iterable[str],
    files: Iterable[Path | None],
    inputs: Iterable[str | Path | None],
    force: bool = False,
) -> None:
    """Check the folder of a run and its other files before anything is opened; nothing is made.

    Parameters
    ----------
    folder : Path or None
        The folder asked for; None for a new one in `runs/`.
    names : iterable of str
        Files that are written there.
    files, inputs, force
        See `check_outputs`.

    Raises
    ------
    ValueError
        See `output_folder` and `check_outputs`.
    """
    if folder is None:
        _check_folder(RUNS, True)
        check_outputs(files, inputs, force)
        return
    _check_folder(folder, force)
    check_outputs([*(folder / name for name in names), *files], inputs, force)


def check_outputs(files: Iterable[Path | None], inputs: Iterable[str | Path | None], force: bool = False) -> None:
    """Check the files that a command writes against all that it reads, and each other, before anything is opened.

    Parameters
    ----------
    files : iterable of Path or None
        What is written; None is skipped.
    inputs : iterable of str, Path or None
        What is read: files, folders of pictures, names of cameras and shapes; None is skipped. These are never
        overwritten, not even through a link.
    force : bool
        Whether what exists may be overwritten.

    Raises
    ------
    ValueError
        If one is an input, another output or a folder, exists and `force` is not given, or cannot be made.
    """
    outputs = [path for path in files if path is not None]
    sources = [Path(each) for each in inputs if each is not None]
    for path in outputs:
        _check_file(path, sources, force)
    for one, other in combinations(outputs, 2):
        if one.resolve() == other.resolve() or (one.exists() and other.exists() and one.samefile(other)):
            raise ValueError(f"{one} and {other} are one file: give each output a name of its own")


@contextlib.contextmanager
def writing(what: str) -> Iterator[None]:
    """Name what could not be written, and why, where the system refuses it (ValueError)."""
    try:
        yield
    except OSError as error:
        raise ValueError(f"cannot write {what}: {error.strerror}") from error


def output_folder(wanted: Path | None, command: str, force: bool = False) -> Path:
    """Make the folder for a command's output.

    Parameters
    ----------
    wanted : Path or None
        The folder asked for; None for a new one, ``runs/0001-track`` and so on.
    command : str
        The command's name, part of a new folder's.
    force : bool
        Whether files in the folder asked for may be overwritten.

    Returns
    -------
    Path
        A folder that exists.

    Raises
    ------
    ValueError
        If the folder holds files and `force` is not given, or it cannot be made or written.
    """
    if wanted is None:
        return _numbered_folder(command)
    _check_folder(wanted, force)
    with writing(f"to the folder {wanted}"):
        wanted.mkdir(parents=True, exist_ok=True)
        _check_writable(wanted)
    return wanted


def output_file(wanted: Path, force: bool = False, source: str | Path | None = None) -> Path:
    """Check that a file may be written.

    Parameters
    ----------
    wanted : Path
        The file; folders above it are made.
    force : bool
        Whether it may be overwritten.
    source : str or Path, optional
        What is read meanwhile, a file or a folder of pictures: that is never overwritten, not even through a link.

    Returns
    -------
    Path
        The same.

    Raises
    ------
    ValueError
        If it exists and `force` is not given, if it is what is read, or its folder cannot be made or written.
    """
    _check_file(wanted, [] if source is None else [Path(source)], force)
    with writing(f"{wanted}"):
        wanted.parent.mkdir(parents=True, exist_ok=True)
        if not wanted.exists():
            _check_writable(wanted.parent)
    return wanted


def _numbered_folder(command: str) -> Path:
    with writing(f"to the folder {RUNS}"):
        RUNS.mkdir(exist_ok=True)
        numbers = [int(found[0]) for entry in RUNS.iterdir() if (found := re.match(r"\d+", entry.name))]
        number = max(numbers, default=0) + 1
        while True:
            folder = RUNS / f"{number:04d}-{command}"
            try:
                folder.mkdir()
            except FileExistsError:  # another process took the number in the meantime
                number += 1
            else:
                return folder


def _check_folder(wanted: Path, force: bool) -> None:
    """Refuse a folder that holds files, if `force` is not given, is a file, or cannot be made."""
    with writing(f"to the folder {wanted}"):
        if wanted.exists() and not wanted.is_dir():
            raise ValueError(f"cannot write to the folder {wanted}: {wanted} is a file, not a folder")
        if not force and wanted.is_dir() and any(wanted.iterdir()):
            raise ValueError(f"the folder {wanted} is not empty: choose another, or overwrite with --force")
        _check_ancestor(wanted)


def _check_file(wanted: Path, sources: Iterable[Path], force: bool) -> None:
    """Refuse a file that is one of the sources, is a folder, exists, if `force` is not given, or cannot be made."""
    with writing(f"{wanted}"):
        for source in sources:
            if _is_read(wanted, source):
                raise ValueError(f"{wanted} is what is read, {source}: give the output another name")
        if wanted.is_dir():
            raise ValueError(f"{wanted} is a folder, not a file")
        if wanted.exists() and not force:
            raise ValueError(f"{wanted} exists: choose another name, or overwrite with --force")
        _check_ancestor(wanted)


def _check_ancestor(wanted: Path) -> None:
    """Raise OSError if what exists of a path is no folder, or may not be written; nothing is made."""
    place = wanted
    while not place.exists() and place.parent != place:
        place = place.parent
    if place != wanted and not place.is_dir():
        raise NotADirectoryError(errno.ENOTDIR, f"{place} is a file, not a folder")
    if not os.access(place, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))


def _is_read(wanted: Path, source: Path) -> bool:
    """Whether a file is the source, or one of the pictures in a source's folder (``folder``, ``folder/%04d.png``)."""
    source = source.parent if "%" in source.name else source
    if not wanted.exists() or not source.exists():
        return False
    return wanted.samefile(source) or (source.is_dir() and wanted.resolve().parent.samefile(source))


def _check_writable(folder: Path) -> None:
    test_file = folder / ".matchset-probe"
    test_file.touch()
    test_file.unlink()
