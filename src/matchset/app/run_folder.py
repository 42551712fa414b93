"""Where output is written: a new numbered folder in `runs/`, or what was asked for; nothing is overwritten."""

import re
from pathlib import Path

RUNS = Path("runs")


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
    try:
        if wanted.exists() and not wanted.is_dir():
            raise ValueError(f"{wanted} is a file, not a folder")
        if not force and wanted.is_dir() and any(wanted.iterdir()):
            raise ValueError(f"the folder {wanted} is not empty: choose another, or overwrite with --force")
        wanted.mkdir(parents=True, exist_ok=True)
        _check_writable(wanted)
    except OSError as error:
        raise ValueError(f"cannot write to the folder {wanted}: {error.strerror}") from error
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
    try:
        if source is not None and _is_read(wanted, Path(source)):
            raise ValueError(f"{wanted} is what is read, {source}: give the output another name")
        if wanted.is_dir():
            raise ValueError(f"{wanted} is a folder, not a file")
        if wanted.exists() and not force:
            raise ValueError(f"{wanted} exists: choose another name, or overwrite with --force")
        wanted.parent.mkdir(parents=True, exist_ok=True)
        if not wanted.exists():
            _check_writable(wanted.parent)
    except OSError as error:
        raise ValueError(f"cannot write {wanted}: {error.strerror}") from error
    return wanted


def _numbered_folder(command: str) -> Path:
    try:
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
    except OSError as error:
        raise ValueError(f"cannot write to the folder {RUNS}: {error.strerror}") from error


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
