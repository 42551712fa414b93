"""What has come and is not read yet: `Inbox`. Its cost, and that of who reads it, is the same whatever others send."""

import threading
from typing import NamedTuple

import msgspec

from matchset.numeric.arguments import require_positive


class InboxParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How much is taken of what comes; the length of a message is limited by `messages.MOST_BYTES`.

    Parameters
    ----------
    partners : int
        Partners that are known at a time, and whose newest messages wait to be read. More hears larger groups and costs
        time. Chosen by hand.
    strangers : int
        Messages that wait of those who have not told that they are there. More tells of more programs that are none of
        matchset. Chosen by hand.
    present : int
        Programs of which it is known that they are there, whether they are partners or not. More knows it of more when
        there is room for them. Chosen by hand: four times the partners.
    decoded : int
        Bytes after which a look stops to decode; the rest waits for the next one. More reads more partners at once,
        less takes less time. Chosen by: 1 ms.
    targets : int
        Targets that are kept of all partners together. Chosen by: 6 ms to hand them out.
    """

    partners: int = 64
    strangers: int = 4
    present: int = 256
    decoded: int = 262_144
    targets: int = 256

    def __post_init__(self) -> None:
        require_positive(self, self.__struct_fields__)


class Waiting(NamedTuple):
    """The newest message of one sender.

    Attributes
    ----------
    name : str
        Under whose name it came.
    data : bytes or None
        None if it was too long.
    time : float
        When it came, s.
    messages : int
        How many came since the last look, this one included.
    """

    name: str
    data: bytes | None
    time: float
    messages: int


class Changes(NamedTuple):
    """Who came and went since the last look.

    Attributes
    ----------
    vanished, appeared : list of str
        Who has vanished at least once; then who has appeared and is there now.
    """

    vanished: list[str]
    appeared: list[str]


class Inbox:
    """Keeps the newest message of each sender, as bytes, and who is there.

    Parameters
    ----------
    parameters : InboxParameters

    Attributes
    ----------
    dropped : int
        Messages that were left out because too many others sent some.
    """

    def __init__(self, parameters: InboxParameters) -> None:
        self._parameters, self.dropped = parameters, 0
        self._lock = threading.Lock()
        self._partners, self._strangers = dict[str, Waiting](), dict[str, Waiting]()
        self._present, self._appeared, self._vanished = set[str](), dict[str, None](), dict[str, None]()

    def put(self, name: str, data: bytes | None, now: float, known: bool) -> bool:
        """Keep a message in place of what the same sender sent before; returns whether there was room for it."""
        limits = self._parameters
        waiting, most = (self._partners, limits.partners) if known else (self._strangers, limits.strangers)
        with self._lock:
            if name not in waiting and len(waiting) >= most:
                self.dropped += 1
                return False
            stranger = self._strangers.pop(name, None) if known else None  # it has become a partner meanwhile
            before = [each.messages for each in (waiting.get(name), stranger) if each is not None]
            waiting[name] = Waiting(name, data, now, sum(before, 1))
            return True

    def take(self) -> list[Waiting]:
        """Return what is to be read now: partners before strangers, and who has waited longest first."""
        taken, size = list[Waiting](), 0
        with self._lock:
            for waiting in (self._partners, self._strangers):
                while waiting and size < self._parameters.decoded:
                    taken.append(waiting.pop(next(iter(waiting))))
                    size += len(taken[-1].data or b"")
        return taken

    def see(self, name: str, there: bool, known: bool) -> None:
        """Note that a program appeared or vanished; of one that has ended no message waits any more."""
        with self._lock:
            if not there:
                self._partners.pop(name, None)
                self._strangers.pop(name, None)
                self._present.discard(name)
                self._appeared.pop(name, None)
                if known or len(self._vanished) < self._parameters.present:
                    self._vanished[name] = None
            elif known or len(self._present) < self._parameters.present:
                self._present.add(name)
                self._appeared[name] = None

    def changes(self) -> Changes:
        """Return who came and went since the last call."""
        with self._lock:
            changes = Changes(list(self._vanished), list(self._appeared))
            self._vanished.clear()
            self._appeared.clear()
        return changes

    def is_present(self, name: str) -> bool:
        """Whether a program is known to be there."""
        return name in self._present
