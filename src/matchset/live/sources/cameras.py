"""Cameras of this computer with their names: `find_cameras`. None of them is opened to take pictures."""

import os
import struct
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

VIDIOC_QUERYCAP = 0x80685600  # format: Linux's request that asks a video device what it can do
CAPABILITIES = struct.Struct("<16s32s32sIII12x")  # format: its answer: driver, name, bus, version, all, this node's
CAPTURE, OF_NODE = 0x1 | 0x1000, 0x80000000  # format: bits: takes pictures; the last field counts


class FoundCamera(NamedTuple):
    """A camera.

    Attributes
    ----------
    device : str
        Such as "0": what `matchset.Video` opens.
    name : str
        What its driver calls it.
    words : str
        What else a person should know.
    """

    device: str
    name: str
    words: str


def find_cameras(
    devices: Path = Path("/dev"),
    names: Path = Path("/sys/class/video4linux"),
    ask: Callable[[Path], tuple[str, bool]] | None = None,
) -> list[FoundCamera]:
    """Find the cameras.

    Parameters
    ----------
    devices, names : Path
        Where the system shows them.
    ask : callable, optional
        Asks a device its name and whether it takes pictures.

    Returns
    -------
    list of FoundCamera
        In the order of their numbers. Nodes of the same camera that deliver no pictures are left out.
    """
    found = []
    numbers = sorted(int(path.name[5:]) for path in devices.glob("video*") if path.name[5:].isdecimal())
    for number in numbers:
        path, words = devices / f"video{number}", str(devices / f"video{number}")
        try:
            name, takes_pictures = (ask or capabilities)(path)
        except PermissionError:
            name, takes_pictures, words = "", True, f"{words}: this user may not open it (group video)"
        except OSError as error:
            name, takes_pictures, words = "", True, f"{words}: {error.strerror}"
        if takes_pictures:
            found.append(FoundCamera(str(number), _name(names, number) or name or f"camera {number}", words))
    return found


def capabilities(path: Path) -> tuple[str, bool]:
    """Ask a video device its name, and whether it takes pictures; it goes on with what it does for others.

    Raises
    ------
    OSError
        If it cannot be asked.
    """
    import fcntl

    device = os.open(path, os.O_RDWR | os.O_NONBLOCK)
    try:
        answer = fcntl.ioctl(device, VIDIOC_QUERYCAP, bytes(CAPABILITIES.size))
    finally:
        os.close(device)
    _, name, _, _, everything, own = CAPABILITIES.unpack(answer)
    return name.rstrip(b"\0").decode(errors="replace"), bool((own if everything & OF_NODE else everything) & CAPTURE)


def _name(names: Path, number: int) -> str:
    try:
        return (names / f"video{number}" / "name").read_text(errors="replace").strip()
    except OSError:
        return ""
