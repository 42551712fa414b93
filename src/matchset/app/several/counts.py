"""What was found of each target: `TargetCounts`, printed at the end of a run."""

from collections.abc import Iterable
from pathlib import Path
from typing import Any, TextIO

import msgspec

from matchset.app.exit_codes import print_warnings
from matchset.app.several.crowd import CrowdWatch
from matchset.app.several.painter import DrawnTargets
from matchset.app.track.loop import RunStatistics, computing_lines
from matchset.media.video import Video

MOST_LINES = 20  # format: targets that are told one by one


class _Count(msgspec.Struct):
    """Of one target: the name of its color, frames with it, those in which it is seen, its first and last time, s."""

    label: str
    first: float
    last: float = 0.0
    frames: int = 0
    found: int = 0


class TargetCounts(RunStatistics):
    """Counts over a run, of all targets and of each."""

    def __init__(self) -> None:
        super().__init__()
        self._targets: dict[int, _Count] = {}

    def count(self, counted: Any) -> None:
        """Count a frame."""
        super().count(counted)
        row: DrawnTargets = counted.row
        for each in row.targets:
            count = self._targets.setdefault(each.identity, _Count(each.label, row.time))
            count.frames += 1
            count.found += each.found
            count.last = row.time if each.found else count.last

    def lines(self) -> list[str]:
        """Say how many targets there were, and of the first ones when each was seen."""
        count = len(self._targets)
        lines = [f"{count} target{'' if count == 1 else 's'} in {self.frames} frames"]
        for identity, each in sorted(self._targets.items())[:MOST_LINES]:
            share = f"found in {each.found} of {each.frames} frames ({100.0 * each.found / each.frames:.1f} %)"
            lines.append(f"  target {identity} ({each.label}): {share}, {each.first:.2f} to {each.last:.2f} s")
        if count > MOST_LINES:
            lines.append(f"  and {count - MOST_LINES} more")
        return lines


def print_counts(
    video: Video,
    counts: TargetCounts,
    files: Iterable[Path],
    out: TextIO,
    words: str = "tracking",
    watch: CrowdWatch | None = None,
) -> None:
    """Print what a run did, see `matchset.app.track.loop.print_summary`, and again what was in the first picture."""
    print_warnings(video.warnings)
    if not counts.frames:
        return
    for line in (*counts.lines(), *(watch.lines if watch else ()), *computing_lines(counts.durations, words)):
        print(line, file=out)
    for path in files:
        print(f"  {path}", file=out)
