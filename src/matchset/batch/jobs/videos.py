"""Which videos a batch has, one after the other: `VideoList`, from folders, lists and names with wildcards."""

import hashlib
import os
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import unquote_to_bytes

# format: endings of video files, which alone are taken from a folder
SUFFIXES = {".3gp", ".asf", ".avi", ".bag", ".db3", ".flv", ".m2ts", ".m4v", ".mcap", ".mjpeg", ".mjpg"}
SUFFIXES |= {".mkv", ".mov", ".mp4", ".mpeg", ".mpg", ".mts", ".ogv", ".ts", ".webm", ".wmv", ".y4m"}
FORBIDDEN = '%:*?"<>|\\'  # format: in names of files, on one system or another; and what marks them here
LONGEST = 200  # format: bytes of a part of a name in the results; file systems take 255
LISTS = frozenset((".txt", ".lst", ".list"))  # format: endings of lists, a video in each line


class VideoList:
    """The videos of a batch, in an order that is always the same; none is opened.

    Only check sums of their names are kept, so that there may be hundreds of thousands.

    Parameters
    ----------
    sources : list of str
        Folders, which are searched with all that is in them; lists; names of files, with wildcards or without.
    out : str
        Folder of the results, which is not searched.

    Raises
    ------
    ValueError
        If one is not there, or is a camera or a stream, which does not end.

    Attributes
    ----------
    count, twice : int
        Videos, and those that are listed once more.
    unread : list of str
        Folders that cannot be read.
    common : Path
        The folder that they have in common.
    """

    def __init__(self, sources: list[str], out: str = "") -> None:
        self._sources, self._out = sources, os.path.realpath(out) if out else ""
        self.count = self.twice = 0
        self.unread = list[str]()
        common: str | None = None
        for path in self:
            self.count += 1
            parent = os.fspath(Path(path).parent)
            common = parent if common is None else os.path.commonpath([common, parent])
        if common is None:
            raise ValueError(f"there is no video in {', '.join(sources)}")
        self.common = Path(common)

    def __iter__(self) -> Iterator[str]:
        """Yield the videos, each by its whole name, once."""
        seen = set[int]()
        self.twice, self.unread = 0, []
        for source in self._sources:
            for path in self._expanded(source):
                key = hash(os.path.realpath(path))
                if key in seen:
                    self.twice += 1
                    continue
                seen.add(key)
                yield path

    def _expanded(self, source: str) -> Iterator[str]:
        """Yield the whole names of the videos that one word of the command line means."""
        check_ends(source)
        path = Path(source)
        if path.is_dir():
            yield from self._in_folder(path)
        elif path.suffix.lower() in LISTS:
            yield from _in_list(path)
        elif os.path.lexists(path):
            yield os.fspath(path.absolute())
        else:
            found = sorted(Path(path.anchor).glob(os.fspath(path.relative_to(path.anchor))))
            if not found:
                raise ValueError(f"no such file: {source}")
            for each in found:
                yield from self._in_folder(each) if each.is_dir() else (os.fspath(each.absolute()),)

    def _in_folder(self, folder: Path) -> Iterator[str]:
        out = self._out
        for place, folders, files in os.walk(folder.absolute(), onerror=self._note):
            folders[:] = sorted(name for name in folders if not out or os.path.realpath(Path(place, name)) != out)
            for name in sorted(files):
                path = Path(place, name)
                if path.suffix.lower() in SUFFIXES:
                    yield os.fspath(path)

    def _note(self, error: OSError) -> None:
        self.unread.append(f"{error.filename}: {error.strerror}")


def _in_list(path: Path) -> Iterator[str]:
    try:
        with path.open(encoding="utf-8-sig", errors="surrogateescape") as lines:
            for number, line in enumerate(lines, 1):
                name = line.rstrip("\r\n")
                if "\0" in name:
                    raise ValueError(f"{path}, line {number}: a list is text in UTF-8, this has a zero byte")
                if not name.strip() or name.startswith("#"):
                    continue
                check_ends(name, f"{path}, line {number}: ")
                yield os.path.normpath(path.parent.absolute() / name)
    except FileNotFoundError:
        raise ValueError(f"no such file: {path}") from None
    except OSError as error:
        raise ValueError(f"cannot read {path}: {error.strerror}") from None


def check_ends(source: str, where: str = "") -> None:
    """Refuse what is no file: a camera or a stream (ValueError)."""
    if "://" in source or (source.isdigit() and not os.path.lexists(source)):
        raise ValueError(f"{where}{source!r} is a camera or a stream, which does not end: a batch is of files")


def folder_of(video: str, root: Path) -> str:
    """Return the folder of a video's results, from that of all results on.

    Parameters
    ----------
    video : str
        Its whole name.
    root : Path
        What most videos have in common; what lies elsewhere gets its whole name behind ``elsewhere``.

    Returns
    -------
    str
        With slashes; what is not printable, or not allowed in names everywhere, is written %0A, as in a URL.
    """
    path = Path(video)
    inside = path.is_relative_to(root)
    parts = path.relative_to(root).parts if inside else ("elsewhere", *path.parts[1:])
    return "/".join(_short(_plain(part, FORBIDDEN)) for part in parts)


def _short(part: str) -> str:
    """Shorten what no file system takes; a check sum keeps it apart from others."""
    data = part.encode()
    if len(data) <= LONGEST:
        return part
    return data[: LONGEST - 20].decode(errors="ignore") + "-" + hashlib.sha256(data).hexdigest()[:16]


def plain_words(text: str) -> str:
    """Write words that may quote names that are no text."""
    return text.encode(errors="replace").decode()


def plain_name(video: str) -> str:
    """Write the name of a video so that it fits into a line of text; `real_name` undoes it."""
    return _plain(video, "%")


def real_name(text: str) -> str:
    """Return the name of a video that `plain_name` wrote."""
    return os.fsdecode(unquote_to_bytes(os.fsencode(text)))


def _plain(text: str, forbidden: str) -> str:
    return "".join(_quoted(each) if not each.isprintable() or each in forbidden else each for each in text)


def _quoted(character: str) -> str:
    return "".join(f"%{byte:02X}" for byte in os.fsencode(character))
