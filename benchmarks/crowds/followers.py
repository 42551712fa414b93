"""Who follows a crowd: `Follower`, and how each is made, `follower`."""

import hashlib
import time
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Protocol

import cv2

import matchset as ms
from benchmarks.crowds.cases import DETECTING, FOLLOWING, MOST, Watched, checksum, composed_checksum
from benchmarks.crowds.peers.client import FedPeer, PeerProcess
from benchmarks.crowds.peers.finders.finder import finder_checksum, parameters_of
from benchmarks.crowds.peers.peer import PEERS, stored
from benchmarks.crowds.score import Answer

SCORE = Path(__file__).with_name("score.py")
SMOOTH = "smooth"  # the same trackers, but for a whole file
NEEDED = {"trackpy": ("trackpy",)}  # packages that a peer needs here, not only in an environment of its own
OWN = {"matchset": "matchset `MultiTracker`", SMOOTH: "the same, `smooth`"}
NAMES = OWN | {key: peer.name for key, peer in PEERS.items()}


class Follower(Protocol):
    """What gives names to the balls of a crowd.

    Attributes
    ----------
    seconds : float
        What the last update took, s, detection included.
    """

    seconds: float

    def update(self, frame: ms.Frame) -> list[Answer]:
        """Say what is where in the next frame."""


class Many:
    """matchset's `MultiTracker`."""

    def __init__(self, color: ms.ColorModel) -> None:
        from matchset.tracking.many.multi_tracker import MultiTracker

        self._tracker = MultiTracker(ms.Circle, color, most=MOST)
        self.seconds = 0.0

    def update(self, frame: ms.Frame) -> list[Answer]:
        """Answer what is tracked."""
        begin = time.perf_counter()
        targets = self._tracker.update(frame)
        self.seconds = time.perf_counter() - begin
        return _seen(targets)


def smoothed(frames: list[ms.Frame], color: ms.ColorModel) -> tuple[list[list[Answer]], float]:
    """Answer what `MultiTracker.smooth` finds in a whole video, and what each frame took in the mean, s."""
    begin = time.perf_counter()
    found = ms.MultiTracker(ms.Circle, color, most=MOST).smooth(frames)
    seconds = (time.perf_counter() - begin) / len(frames)
    return [_seen(each.targets) for each in found], seconds


def _seen(targets: list[ms.Target[Any]]) -> list[Answer]:
    return [Answer(each.identity, each.track.shape) for each in targets if isinstance(each.track, ms.Track)]


def absent(key: str) -> str:
    """Why a follower cannot be had here; empty if it can."""
    if key in PEERS:
        missing = not PEERS[key].python.exists() or any(find_spec(each) is None for each in NEEDED.get(key, ()))
        missing |= key == "edges" and not hasattr(cv2, "ximgproc")
        return "not installed: `make bench-crowds` does it" if missing else ""
    return ""


class Field:
    """All followers; the processes of peers are kept for several crowds.

    Used as a context manager, it ends them.
    """

    def __init__(self) -> None:
        self._processes: dict[str, PeerProcess] = {}

    def __enter__(self) -> "Field":
        return self

    def __exit__(self, *_: object) -> None:
        for process in self._processes.values():
            process.close()

    def own(self, color: ms.ColorModel) -> Follower:
        """Make matchset's."""
        return Many(color)

    def fed(self, key: str, given: Watched, parameters: dict[str, Any] | None = None) -> FedPeer:
        """Make a peer for one crowd, with its stored parameters or others."""
        if key not in self._processes:
            self._processes[key] = PeerProcess(key)
        return FedPeer(self._processes[key], parameters or stored(key), given.found, given.seconds)


def version(key: str, scene: str = "") -> str:
    """Say what decides the row of a follower and a crowd: where it differs that is found anew."""
    scoring = hashlib.sha256(SCORE.read_bytes()).hexdigest()[:4] + composed_checksum(scene)
    if key in PEERS:
        values = ", ".join(f"{name} {value}" for name, value in sorted(stored(key).items()))
        finder = PEERS[key].finder
        if finder:
            looking = ", ".join(f"{name} {value}" for name, value in sorted(parameters_of(finder).items()))
            return f"{checksum(())}-{finder_checksum()}-{scoring}: {values}; {looking}"
        return f"{checksum(DETECTING)}-{scoring}: {values}"
    return f"{checksum(FOLLOWING)}-{scoring}"
