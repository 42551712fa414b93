"""How well a follower keeps the names of a crowd, kept in a file as soon as it is known: `Row`, `Kept`, `follow`."""

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import msgspec
import numpy as np

from benchmarks.crowds.cases import PAIR, Case, Watched, color_of, noted, watched
from benchmarks.crowds.followers import SMOOTH, Field, smoothed, version
from benchmarks.crowds.peers.finders.finder import found_by
from benchmarks.crowds.peers.peer import PEERS
from benchmarks.crowds.score import Answer, Score, names_kept, score


class Row(msgspec.Struct, frozen=True, kw_only=True):
    """One follower and one crowd.

    Parameters
    ----------
    case : Case
    follower : str
    version : str
        What decided its answers.
    score : Score
    right : bool or None
        Of a pair: whether both have their names at the end; None of other scenes.
    median_ms, most_ms : float
        What a frame took, detection included, and 99 % of the frames.
    machine : str
    """

    case: Case
    follower: str
    version: str
    score: Score
    right: bool | None
    median_ms: float
    most_ms: float
    machine: str


class Kept:
    """Rows in a file, a line of JSON each; one that is torn, or of another version of its follower, does not count."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self._rows: dict[tuple[Case, str], Row] = {}
        self._versions: dict[tuple[str, str], str] = {}
        for line in path.read_bytes().splitlines() if path.exists() else ():
            try:
                row = msgspec.json.decode(line, type=Row)
            except msgspec.DecodeError:
                continue
            if row.version == self._version(row.follower, row.case.scene):
                self._rows[row.case, row.follower] = row

    def _version(self, follower: str, scene: str) -> str:
        if (follower, scene) not in self._versions:
            self._versions[follower, scene] = version(follower, scene)
        return self._versions[follower, scene]

    def get(self, case: Case, follower: str) -> Row | None:
        """Return a row; None if it is not known."""
        return self._rows.get((case, follower))

    def add(self, row: Row) -> None:
        """Keep a row."""
        self._rows[row.case, row.follower] = row
        self.path.parent.mkdir(parents=True, exist_ok=True)
        with self.path.open("ab") as file:
            file.write(msgspec.json.encode(row) + b"\n")


def follow(case: Case, keys: Sequence[str], field: Field, machine: str, add: Callable[[Row], None]) -> None:
    """Let followers follow a crowd, and hand out the row of each."""
    for key in keys:
        if key in PEERS:
            known = fed_with(key, case)
            answers, seconds = follow_fed(field, key, known)
        elif key == SMOOTH:
            known, answers, seconds = _follow_both_ways(case)
        else:
            known, answers, seconds = _follow_pictures(field, case)
        add(_row(case, key, known, answers, seconds, machine))


def fed_with(key: str, case: Case) -> Watched:
    """Return what a peer is fed with in a crowd."""
    finder = PEERS[key].finder
    return found_by(finder, case) if finder else watched(case)


def follow_fed(
    field: Field, key: str, known: Watched, parameters: dict[str, object] | None = None
) -> tuple[list[list[Answer]], list[float]]:
    """Let a peer follow what was detected; return its answers, and what each frame took, s."""
    peer = field.fed(key, known, parameters)
    answers, seconds = [], []
    for number in range(len(known.found)):
        answers.append(peer.answers(number))
        seconds.append(peer.seconds)
    return answers, seconds


def _follow_pictures(field: Field, case: Case) -> tuple[Watched, list[list[Answer]], list[float]]:
    """Let one of matchset's follow the pictures; nothing is detected in them beside that."""
    crowd = case.crowd()
    follower = field.own(color_of(crowd))
    known, answers, seconds = Watched([], [], []), [], []
    for frame, seen in crowd:
        answers.append(follower.update(frame))
        seconds.append(follower.seconds)
        known.truth.append(noted(seen))
    return known, answers, seconds


def _follow_both_ways(case: Case) -> tuple[Watched, list[list[Answer]], list[float]]:
    """Let matchset's explain all pictures together; they are kept meanwhile."""
    crowd = case.crowd()
    pairs = [(frame, noted(seen)) for frame, seen in crowd]
    answers, seconds = smoothed([frame for frame, _ in pairs], color_of(crowd))
    return Watched([truth for _, truth in pairs], [], []), answers, [seconds] * len(pairs)


def _row(
    case: Case, key: str, known: Watched, answers: list[list[Answer]], seconds: Iterable[float], machine: str
) -> Row:
    took = 1e3 * np.array(list(seconds))
    seen, said = known.judged(answers)
    return Row(
        case=case,
        follower=key,
        version=version(key, case.scene),
        score=score(seen, said),
        right=names_kept(seen, said) if case.scene == PAIR else None,
        median_ms=float(np.median(took)),
        most_ms=float(np.percentile(took, 99)),
        machine=machine,
    )
