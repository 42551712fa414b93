"""What can be chosen in the menu: `Source`, `find_sources`."""

import os
import re
import sys
from pathlib import Path
from typing import Literal
from urllib.parse import urlsplit

import msgspec

from matchset.live.sources.cameras import find_cameras

Kind = Literal["camera", "file", "demo", "flight", "given", "address", "upload"]
DEMO, CHAIN = "sim://demo", "sim://chain"  # format: names of sources that are neither file nor device
STREAMS = frozenset(("http", "https", "rtsp", "rtsps", "rtmp", "rtp", "srt", "tcp", "udp"))  # format: URLs of streams
TEXT_HEAD = 512  # format: bytes by which a text is known: every container has a zero byte among them, or no valid UTF-8
ENDINGS = frozenset((".mp4", ".m4v", ".mov", ".avi", ".mkv", ".webm", ".mpg", ".mpeg", ".ts", ".wmv", ".mjpg", ".bag"))


class MenuParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How long the menu is.

    Parameters
    ----------
    files : int
        Videos of the folder at most, the newest ones. Chosen by hand: what one scrolls through on a phone.
    entries : int
        Entries of the folder that are looked at. More finds videos in larger folders, and takes longer: 20,000 took 40
        ms.
    """

    files: int = 40
    entries: int = 20_000


class Source(msgspec.Struct, frozen=True):
    """Something that can be shown.

    Parameters
    ----------
    kind : str
        "camera", "file", "demo", "flight", "given": named on the command line, "address": typed into the page, or
        "upload": sent by it.
    origin : str
        What opens it; never told to a page.
    name : str
        For people.
    words : str
        What else there is to say.
    """

    kind: Kind
    origin: str
    name: str
    words: str = ""


class Sources(msgspec.Struct, frozen=True):
    """What there is.

    Parameters
    ----------
    entries : list of Source
    words : str
        What was not found, or left out.
    """

    entries: list[Source]
    words: str = ""


def find_sources(folder: Path, parameters: MenuParameters | None = None, devices: Path = Path("/dev")) -> Sources:
    """Look for cameras, and for videos in a folder; takes some milliseconds.

    Parameters
    ----------
    folder : Path
    parameters : MenuParameters, optional
    devices : Path
        Where Linux shows its cameras.
    """
    entries = [Source("camera", camera.device, camera.name, camera.words) for camera in find_cameras(devices)]
    missing = [] if entries else ["no camera was found (no /dev/video*)"]
    if not entries and not sys.platform.startswith("linux"):  # these systems name no devices: try the first one
        entries, missing = [Source("camera", "0", "camera 0", "the first camera, if there is one")], []
    files, left_out = _videos(folder, parameters or MenuParameters())
    if not files:
        missing.append(f"no video in {folder.resolve()}")
    elif left_out:
        missing.append(f"{left_out} older videos of this folder are left out")
    entries += files
    entries += [
        Source("demo", DEMO, "demo clip", "a rendered balloon of 28 cm, its camera known; made once, in some seconds"),
        Source("flight", CHAIN, "simulated chain", "followers that fly behind each other, in a simulated room"),
    ]
    return Sources(entries, "; ".join(missing))


def given_source(origin: str) -> Source:
    """Return the source that a command line names; a password in an address is not told to pages."""
    name = f"camera {int(origin)}" if re.fullmatch(r"[0-9]+", origin) else re.sub(r"://[^/]*@", "://", origin)
    return Source("given", origin, shown_name(name))


def address_source(text: str) -> Source:
    """Return the source of an address that was typed into a page.

    Raises
    ------
    ValueError
        If it is no address of a stream: paths, devices and files are none.
    """
    address = text.strip()
    scheme, separator, _ = address.partition("://")
    try:
        host = urlsplit(address).netloc
    except ValueError:
        host = ""
    if not (separator and scheme.lower() in STREAMS and host and re.fullmatch(r"[!-~]+", address)):
        raise ValueError(
            f"{shown_name(address)[:60]!r} is no address of a stream: type one such as rtsp://192.168.1.7/live or "
            "http://192.168.1.7:8080/video"
        )
    return msgspec.structs.replace(given_source(address), kind="address", words="a stream in the network")


def _videos(folder: Path, parameters: MenuParameters) -> tuple[list[Source], int]:
    """Return the newest videos of a folder, and how many were left out."""
    found: list[tuple[float, str, int]] = []
    try:
        with os.scandir(folder) as entries:
            for entry, _ in zip(entries, range(parameters.entries), strict=False):
                if Path(entry.name).suffix.lower() in ENDINGS and entry.is_file() and (about := entry.stat()).st_size:
                    found.append((about.st_mtime, entry.name, about.st_size))
    except OSError:
        return [], 0
    videos: list[Source] = []
    newest = sorted(found, reverse=True)
    while newest and len(videos) < parameters.files:
        _, name, size = newest.pop(0)
        if not is_text(folder / name):
            videos.append(Source("file", str(folder / name), shown_name(name), f"{size / 1e6:.1f} MB"))
    return videos, len(newest)


def is_text(path: Path) -> bool:
    """Whether a file begins like a text, whatever its name says; also one that cannot be read is no video to offer."""
    try:
        with path.open("rb") as file:
            head = file.read(TEXT_HEAD)
    except OSError:
        return True
    try:
        return bool(head) and b"\0" not in head and bool(head.decode("utf-8", "strict"))
    except UnicodeDecodeError as error:
        return error.end == len(head) > 4  # a letter that was cut off


def shown_name(name: str) -> str:
    """Write a name so that it is valid text, whatever bytes it is made of."""
    return name.encode(errors="replace").decode()
