"""What a batch writes at its end: a row for each video, all rows in one table, a page (`write_report`)."""

import csv
import heapq
from collections.abc import Iterator

import msgspec

from matchset.app.exit_codes import print_note
from matchset.batch.jobs.counts import noted_table
from matchset.batch.jobs.job import VideoOutcome
from matchset.batch.jobs.videos import folder_of
from matchset.batch.plan import Plan
from matchset.batch.results.all_rows import AllRows
from matchset.batch.results.manifest import Manifest
from matchset.batch.results.page import write_page
from matchset.batch.results.store import Store

COLUMNS = "video", "state", "frames", "found", "share", "seconds", "reason", "click", "worker", "path"
REPORTS = "videos.csv", "all.csv", "all.parquet", "summary.html"  # format: what is written here, in `--out` itself
BINS = 10  # geometry: bars of the histogram


class ReportParameters(msgspec.Struct, frozen=True):
    """What the page shows.

    Parameters
    ----------
    worst : int
        How many videos it shows with pictures, those with the smallest share found.
    """

    worst: int = 10


PARAMETERS = ReportParameters()


class Totals:
    """What became of all videos.

    Attributes
    ----------
    states : dict of str to int
    shares : list of int
        How many videos have a share found of 0 to 10 %, 10 to 20 %, ...
    frames, found : int
        Of all videos.
    worst : list of VideoOutcome
        Those with the smallest share found, the worst first.
    """

    def __init__(self) -> None:
        self.states: dict[str, int] = {}
        self.shares = [0] * BINS
        self.frames = self.found = self.count = self.missing = 0
        self._worst: list[tuple[float, int, VideoOutcome]] = []

    def add(self, outcome: VideoOutcome) -> None:
        """Count a video."""
        self.count += 1
        self.states[outcome.state] = self.states.get(outcome.state, 0) + 1
        self.frames, self.found = self.frames + outcome.frames, self.found + outcome.found
        if outcome.frames:
            self.shares[min(int(BINS * outcome.share), BINS - 1)] += 1
        if outcome.state != "found" or outcome.share < 1.0:
            heapq.heappush(self._worst, (-outcome.share, -self.count, outcome))
        if len(self._worst) > PARAMETERS.worst:
            heapq.heappop(self._worst)

    @property
    def worst(self) -> list[VideoOutcome]:
        """See above."""
        return [outcome for _, _, outcome in sorted(self._worst, reverse=True)]

    @property
    def good(self) -> bool:
        """Whether a ball was found in every video."""
        return set(self.states) <= {"found"} and not self.missing


def write_report(store: Store, manifest: Manifest, plan: Plan) -> Totals:
    """Write videos.csv, all.csv, all.parquet and summary.html, and say so.

    Parameters
    ----------
    store : Store
    manifest : Manifest
    plan : Plan

    Returns
    -------
    Totals
    """
    totals = Totals()
    with store.unfinished() as folder:
        with AllRows(folder) as rows, (folder / "videos.csv").open("w", encoding="utf-8", newline="") as text:
            table = csv.writer(text, lineterminator="\n")
            table.writerow(COLUMNS)
            for outcome in _in_order(manifest, plan, totals):
                found = noted_table(store, outcome)
                if outcome.frames and found is None:
                    manifest.append(msgspec.structs.replace(outcome, state="stopped", reason="its table was changed"))
                    totals.missing += 1
                    continue
                totals.add(outcome)
                table.writerow(_cells(outcome))
                if found is not None:
                    rows.append(outcome.folder, found)
        if totals.missing:
            print_note(
                f"{totals.missing} videos have no table, or another one than was noted: the same command goes on"
            )
        write_page(folder, store, totals)
        for path in sorted(folder.iterdir()):
            store.put(path, path.name)
    return totals


def _in_order(manifest: Manifest, plan: Plan, totals: Totals) -> Iterator[VideoOutcome]:
    """Yield the last outcome of each video, in the order of the videos."""
    with manifest.by_folder() as outcomes:
        for video in plan.videos:
            outcome = outcomes.last(folder_of(video, manifest.root))
            if outcome is None or outcome.state == "stopped":
                totals.missing += 1
            else:
                yield outcome


def _cells(outcome: VideoOutcome) -> list[object]:
    share = f"{outcome.share:.4f}" if outcome.frames else ""
    numbers = outcome.frames, outcome.found, share, outcome.seconds
    reason = " ".join(outcome.reason.split())
    return [outcome.folder, outcome.state, *numbers, reason, outcome.click, outcome.worker, outcome.video]
