"""How a benchmark is to be run: `Options`."""

from pathlib import Path

import msgspec

UNSEEN = (100, 101, 102, 103, 104, 105, 106, 107)
"""Seeds of the sequences that are reported. Seeds 0-9 served to tune the tracker and are not."""


class Options(msgspec.Struct, frozen=True, kw_only=True):
    """How a benchmark is to be run.

    Parameters
    ----------
    seeds : tuple of int
        Seeds of the rendered sequences.
    quick : bool
        Fewer and shorter sequences: for a first impression.
    data : Path or None
        Folder with real clips and their truth.
    jobs : int
        Processes for what is not timed.
    pictures : Path or None
        Folder for pictures.
    false_frames : Path or None
        Folder for the first few frames with a false lock.
    """

    seeds: tuple[int, ...] = UNSEEN
    quick: bool = False
    data: Path | None = None
    jobs: int = 2
    pictures: Path | None = None
    false_frames: Path | None = None


def parse_seeds(text: str) -> tuple[int, ...]:
    """Read "100-103,200" as 100, 101, 102, 103, 200.

    Parameters
    ----------
    text : str
        Numbers and ranges, joined by commas.

    Returns
    -------
    tuple of int

    Raises
    ------
    ValueError
        If it is anything else.
    """
    seeds: list[int] = []
    for part in text.split(","):
        first, dash, last = part.strip().partition("-")
        if not first.isdecimal() or (dash and not last.isdecimal()):
            raise ValueError(f'seeds are numbers and ranges such as "100-103,200", got {text!r}')
        seeds += range(int(first), int(last if dash else first) + 1)
    if not seeds:
        raise ValueError(f"{text!r} holds no seeds")
    return tuple(seeds)
