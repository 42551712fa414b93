"""Files on a disk that may be full: `WholeFile` keeps what was written before, `UnfinishedFileError` says how much.

`FreeSpace` stops films and recordings while there is room for the rest of the run. What exists is overwritten only when
the new file is finished: until then that one has a name beside it (`name_beside`).
"""

import contextlib
import errno
import itertools
import os
import shutil
from pathlib import Path

import msgspec

from matchset.media.closing import Closing
from matchset.numeric.arguments import require_at_least, require_share


class SpaceParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How much of a disk films and recordings leave free.

    Parameters
    ----------
    keep_free : float
        MB. More leaves more to the tables and the report of the same run and to other programs; less lets films and
        recordings go on for longer. Chosen by: one second of the recording of two followers (40 MB), the most that
        waits in memory when the disk is looked at, and the report (below 2 MB).
    keep_share : float
        The same as a share of the whole disk; the smaller of the two counts, so that small disks can be used, too.
        Chosen by: 2 % of 2.5 GB are the 50 MB above; smaller disks are test benches and memory cards of cameras.
    """

    keep_free: float = 50.0
    keep_share: float = 0.02

    def __post_init__(self) -> None:
        require_at_least(self, 0, "keep_free")
        require_share(self, ("keep_share",))


SPACE = SpaceParameters()
MB = 1_000_000  # format: bytes


def size_text(size: float) -> str:
    """Write a number of bytes as people do: ``2.4 GB``, ``230 MB``."""
    return f"{size / MB:.0f} MB" if size < 1000 * MB else f"{size / (1000 * MB):.3g} GB"


class FreeSpace:
    """How much may still be written beside a file.

    Parameters
    ----------
    path : Path
        The file; its folder exists.
    parameters : SpaceParameters
    """

    def __init__(self, path: Path, parameters: SpaceParameters = SPACE) -> None:
        self._folder = path.absolute().parent
        total = shutil.disk_usage(self._folder).total
        self._kept = min(parameters.keep_free * MB, parameters.keep_share * total)

    @property
    def left(self) -> float:
        """Bytes that may still be written; below 0 if less is free than shall be kept."""
        return shutil.disk_usage(self._folder).free - self._kept

    @property
    def free(self) -> float:
        """What is free on the disk, MB."""
        return shutil.disk_usage(self._folder).free / MB

    @property
    def error(self) -> OSError:
        """What to raise when nothing is left."""
        return OSError(errno.ENOSPC, f"stopped, since only {self.free:.3g} MB are free on its disk")


def name_beside(path: Path) -> Path:
    """Return the name under which a file is written until it is finished.

    Parameters
    ----------
    path : Path
        The name that it gets.

    Returns
    -------
    Path
        The same, if there is nothing to lose; ``name.part.ending``, or one that is free, if there is a file.
    """
    if not path.is_file():
        return path
    names = (f"{path.stem}.part{number or ''}{path.suffix}" for number in itertools.count())
    return next(free for name in names if not os.path.lexists(free := path.with_name(name)))


class UnfinishedFileError(OSError):
    """A file that could not be written to its end; what it holds is whole.

    Parameters
    ----------
    error : OSError
        Why.
    path : Path
        Which file.
    content : str
        What it holds, in words: "36 of 403 pictures".
    """

    def __init__(self, error: OSError, path: Path, content: str) -> None:
        reason = error.strerror or str(error) or type(error).__name__
        super().__init__(error.errno or 0, f"{reason}; it holds {content}", str(path))


class WholeFile(Closing):
    """A file that is written piece by piece: each is with the operating system when `write` returns.

    If a piece does not fit, the file is cut back to the last `mark`; what comes later is dropped. A file that exists
    is overwritten by `close`: until then what is written lies beside it, see `name_beside`.

    Parameters
    ----------
    path : Path
    beside : bool
        False: overwrite at once.

    Attributes
    ----------
    error : OSError or None
        What went wrong first.
    size : int
        Bytes up to the last `mark`.

    Raises
    ------
    OSError
        If the file cannot be opened; with its name.
    """

    def __init__(self, path: Path, beside: bool = True) -> None:
        self.path, self.size = path, 0
        self.error: OSError | None = None
        self._beside = name_beside(path) if beside else path
        self._file = self._beside.open("wb", buffering=0)

    def write(self, data: bytes | memoryview) -> int:
        """Write at the present place.

        Raises
        ------
        OSError
            With the file's name, if it does not fit; nothing is written any more.
        """
        if self.error is not None:
            return len(data)
        rest = memoryview(data)
        try:
            while len(rest):
                rest = rest[self._file.write(rest) :]
        except OSError as error:
            self.error = OSError(error.errno, error.strerror, str(self.path))
            with contextlib.suppress(OSError):
                self._file.truncate(self.size)
            raise self.error from None
        return len(data)

    def append(self, data: bytes) -> None:
        """Write a whole piece at the end: `write` and `mark`."""
        self.write(data)
        self.mark()

    def mark(self) -> None:
        """Note that everything up to here is whole."""
        if self.error is None:
            self.size = os.fstat(self._file.fileno()).st_size

    def seek(self, place: int, whence: int = os.SEEK_SET) -> int:
        """Go to a place, as files do."""
        return self._file.seek(place, whence)

    def tell(self) -> int:
        """Return the present place."""
        return self._file.tell()

    def flush(self) -> None:
        """Do nothing: nothing is kept back."""

    def close(self) -> None:
        """Close the file, and give it its name."""
        if self._file.closed:
            return
        self._file.close()
        if self._beside != self.path:
            self._beside.replace(self.path)

    def discard(self) -> None:
        """Close the file and delete what was written; what was there before stays."""
        self._file.close()
        if self._beside.is_file():
            self._beside.unlink()
