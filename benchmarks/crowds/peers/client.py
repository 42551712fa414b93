"""A peer as a `Follower`: its process is fed with the detections of a file."""

import json
import select
import subprocess
from typing import Any

import matchset as ms
from benchmarks.crowds.peers.peer import PEERS, ROOT
from benchmarks.crowds.score import Answer

PATIENCE = 120.0  # s, for an answer: some compile before their first
CLOSING = 10.0  # s, for a process to end by itself


class PeerProcess:
    """The process of a peer, which may follow one crowd after the other.

    Parameters
    ----------
    key : str
        In `PEERS`.
    patience : float, optional
        How long an answer may take, s.

    Raises
    ------
    FileNotFoundError
        If its environment is not there: `make bench-crowds` makes it.
    """

    def __init__(self, key: str, patience: float = PATIENCE) -> None:
        peer = PEERS[key]
        self._name = peer.name
        self._patience = patience
        if not peer.python.exists():
            raise FileNotFoundError(f"{peer.name} is not installed: no {peer.python.relative_to(ROOT)}")
        command = [str(peer.python), "-m", "benchmarks.crowds.peers.process", key]
        pipe = subprocess.PIPE
        self._process = subprocess.Popen(
            command, cwd=ROOT, stdin=pipe, stdout=pipe, stderr=subprocess.DEVNULL, text=True
        )

    def ask(self, message: Any) -> str:
        """Send a line, and return the answer.

        Raises
        ------
        RuntimeError
            If the process has ended.
        TimeoutError
            If it does not answer in time; it is killed.
        """
        streams = self._process.stdin, self._process.stdout
        if streams[0] is None or streams[1] is None:
            raise RuntimeError("the process of a peer has no pipes")
        streams[0].write(json.dumps(message) + "\n")
        streams[0].flush()
        if not select.select([streams[1]], [], [], self._patience)[0]:
            self._process.kill()
            raise TimeoutError(f"{self._name} has not answered for {self._patience:g} s")
        line = streams[1].readline()
        if not line:
            raise RuntimeError(f"the process of a peer has ended with {self._process.wait()}")
        return line

    def close(self) -> None:
        """End it; kill it if it goes on."""
        if self._process.stdin is not None:
            self._process.stdin.close()
        try:
            self._process.wait(CLOSING)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        if self._process.stdout is not None:
            self._process.stdout.close()


class FedPeer:
    """A peer that follows one crowd.

    Parameters
    ----------
    process : PeerProcess
    parameters : dict
    found : list of list of (float, float, float, float)
        Detections of every frame, as in `Watched`.
    detecting : list of float
        What they took, s.

    Attributes
    ----------
    seconds : float
        What the last frame took, detection included.
    """

    def __init__(
        self,
        process: PeerProcess,
        parameters: dict[str, Any],
        found: list[list[tuple[float, float, float, float]]],
        detecting: list[float],
    ) -> None:
        self._process, self._found, self._detecting = process, found, detecting
        self.seconds = 0.0
        process.ask(parameters)

    def answers(self, number: int) -> list[Answer]:
        """Feed it with what was detected in a frame of that number, in order."""
        spent, named = json.loads(self._process.ask(self._found[number]))
        self.seconds = spent + self._detecting[number]
        return [Answer(name, ms.Circle(x, y, r)) for name, x, y, r in named]

    def update(self, frame: ms.Frame) -> list[Answer]:
        """As `answers`; the picture was looked at before."""
        return self.answers(frame.index)
