"""What was measured so far, section by section: `Section`, `Kept`."""

from pathlib import Path
from typing import TypeVar

import msgspec

from benchmarks.batch.killed import Killed
from benchmarks.batch.overhead import Overhead
from benchmarks.batch.speed import Speed
from benchmarks.batch.split import Split
from benchmarks.batch.tasks import Costs
from matchset.image.files.whole_file import write_whole

Measured = TypeVar("Measured", Speed, Overhead, Costs, Split, Killed)


class Kept(msgspec.Struct, kw_only=True):
    """The figures of all sections; None: not measured yet.

    Parameters
    ----------
    speed : Speed or None
    overhead : Overhead or None
    tasks : Costs or None
    split : Split or None
    killed : Killed or None
    where : dict of str to str
        Time, commit and machine of each section.
    """

    speed: Speed | None = None
    overhead: Overhead | None = None
    tasks: Costs | None = None
    split: Split | None = None
    killed: Killed | None = None
    where: dict[str, str] = {}

    @classmethod
    def load(cls, path: Path) -> "Kept":
        """Read what was kept; nothing if there is no such file."""
        return msgspec.json.decode(path.read_bytes(), type=cls) if path.is_file() else cls()

    def save(self, path: Path) -> None:
        """Keep it."""
        write_whole(path, msgspec.json.encode(self))
