"""Videos that a page sends: written to a folder of this program alone, which is removed when it ends (`Uploads`)."""

import shutil
import tempfile
from pathlib import Path

import msgspec

from matchset.live.sources.found_sources import ENDINGS, Source, shown_name
from matchset.media.closing import Closing

MB = 1_000_000  # format: bytes


class UploadParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How much a page may send.

    Parameters
    ----------
    most_mb : float
        All files together, MB; more is refused until the program is started anew. More: longer videos, and a fuller
        disk. Chosen by hand: ten minutes of a phone's 1080p.
    spare_mb : float
        Room that stays on the disk, MB. Chosen by hand: what a system needs to go on.
    """

    most_mb: float = 2000.0
    spare_mb: float = 500.0


class Upload:
    """A file that is being sent; one call after the other, in any thread.

    Parameters
    ----------
    path : Path
        Where it is written.
    name : str
        What its owner calls it.
    length : int
        Bytes that were announced; more is refused.
    """

    def __init__(self, path: Path, name: str, length: int) -> None:
        self.path, self.name, self.length, self.size = path, name, length, 0
        self._file = path.open("xb")

    def write(self, data: bytes) -> None:
        """Write the next part.

        Raises
        ------
        ValueError
            If more comes than was announced.
        """
        self.size += len(data)
        if self.size > self.length:
            raise ValueError(f"{self.name} is longer than was said: {self.length} bytes")
        self._file.write(data)

    def finish(self) -> Source:
        """Return it as a source; ValueError if it is not whole."""
        self._file.close()
        if self.size != self.length:
            raise ValueError(f"{self.name} did not come whole: {self.size} of {self.length} bytes")
        return Source("upload", str(self.path), self.name, f"{self.size / MB:.1f} MB, kept until matchset ends")

    def drop(self) -> None:
        """Delete it."""
        self._file.close()
        self.path.unlink(missing_ok=True)


class Uploads(Closing):
    """The videos that were sent.

    Parameters
    ----------
    parameters : UploadParameters, optional
    folder : Path, optional
        In which the program's own folder is made; the system's for temporary files.
    """

    def __init__(self, parameters: UploadParameters | None = None, folder: Path | None = None) -> None:
        self._parameters, self._where = parameters or UploadParameters(), folder
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        self._sent: list[Upload] = []
        self._count = 0

    @property
    def room(self) -> int:
        """How many bytes may still be sent."""
        kept = sum(each.length for each in self._sent if each.path.exists())
        coming = sum(each.length - each.size for each in self._sent if each.path.exists())
        free = shutil.disk_usage(self._where or tempfile.gettempdir()).free
        return max(int(min(self._parameters.most_mb * MB - kept, free - self._parameters.spare_mb * MB - coming)), 0)

    def begin(self, name: str, length: int) -> Upload:
        """Begin to take a file.

        Raises
        ------
        ValueError
            If its name is not that of a video, or it is too large.
        """
        shown = shown_name(Path(name.replace("\\", "/")).name)[-60:]
        ending = Path(shown).suffix.lower()
        if ending not in ENDINGS:
            raise ValueError(f"{shown or 'this'} is no video by its name: {', '.join(sorted(ENDINGS))} are")
        room = self.room
        if not 0 < length <= room:
            raise ValueError(
                f"{shown} has {length / MB:.1f} MB, and there is room for {room / MB:.0f} MB: what was sent is removed "
                "when matchset ends"
            )
        if self._folder is None:
            self._folder = tempfile.TemporaryDirectory(prefix="matchset-live-", dir=self._where)
        self._count += 1
        made = Upload(Path(self._folder.name) / f"{self._count}{ending}", shown, length)
        self._sent.append(made)
        return made

    def close(self) -> None:
        """Remove all of them."""
        if self._folder is not None:
            self._folder.cleanup()
