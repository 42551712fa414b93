"""A file that a library writes itself, by a name, and that ends where the disk is full: `PipedFile`."""

import os
import threading
from pathlib import Path

from matchset.app.disk import WholeFile, name_beside
from matchset.media.closing import Closing

OPEN_FILES = Path("/dev/fd")  # format: open files by their numbers, on Linux and macOS
PIECE = 65536  # format: bytes that are read from a pipe at once


class PipedFile(Closing):
    """Lets a library write into a pipe, and writes to the file what comes out.

    Rerun's writer, for which this is made, can hang for good where it cannot write; into a pipe it always can. Where
    the system has no names of open files, as Windows, it writes to the file itself.

    Parameters
    ----------
    path : Path
        Overwritten by `close`.

    Attributes
    ----------
    name : Path
        What the library has to open.

    Raises
    ------
    OSError
        If the file cannot be opened, with its name; by `close`, if it could not be written to its end.
    """

    def __init__(self, path: Path) -> None:
        self._path, self.name = path, name_beside(path)
        self._file: WholeFile | None = None
        self._is_opened = False
        if not OPEN_FILES.exists():
            return
        self._file = WholeFile(path)
        self._out, self._into = os.pipe()
        self.name = OPEN_FILES / str(self._into)
        self._thread = threading.Thread(target=self._copy, args=(self._file,), name="matchset pipe", daemon=True)
        self._thread.start()

    def opened(self) -> None:
        """Note that the library has opened it: the file ends when that closes it."""
        if self._file is not None and not self._is_opened:
            os.close(self._into)
        self._is_opened = True

    def discard(self) -> None:
        """Delete what the library has written, which has closed it; what was there before stays."""
        self.opened()
        if self._file is None:
            self.name.unlink(missing_ok=True)
        else:
            self._thread.join()
            self._file.discard()

    def close(self) -> None:
        """Finish the file, which the library has closed, and give it its name, unless nothing could be written."""
        if self._file is None:
            if self.name != self._path:
                self.name.replace(self._path)
            return
        self._thread.join()
        if self._file.error is not None and not self._file.size:
            self._file.discard()
        else:
            self._file.close()
        self.check()

    def check(self) -> None:
        """Raise the OSError of what could not be written so far, if there is one."""
        if self._file is not None and self._file.error is not None:
            raise self._file.error

    def _copy(self, file: WholeFile) -> None:
        """Write what comes out of the pipe; after an error, which the file keeps, it goes nowhere."""
        with os.fdopen(self._out, "rb", buffering=0) as out:
            while data := out.read(PIECE):
                try:
                    file.append(data)
                except OSError:
                    continue
