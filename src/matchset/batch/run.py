"""The run of `matchset batch`: from its options to the manifest, table and page."""

import contextlib
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

from matchset.app.exit_codes import FOUND, NOT_FOUND, StopRequest, print_note
from matchset.batch.clicking.clicker import Clicker, NoClicker
from matchset.batch.jobs.job import VideoOutcome
from matchset.batch.jobs.target import TargetChoice
from matchset.batch.jobs.videos import VideoList, folder_of
from matchset.batch.loop import Batch
from matchset.batch.options import BatchOptions
from matchset.batch.plan import Plan
from matchset.batch.progress import BatchCounts, BatchDisplay
from matchset.batch.results.lock import LOCK, lock_of
from matchset.batch.results.manifest import FILE, PARTS, Manifest
from matchset.batch.results.report import REPORTS, write_report
from matchset.batch.results.store import MARK, FolderStore, Store, SupersededError, store_at
from matchset.batch.split.parts import check_split
from matchset.batch.workers.dask_cluster import DaskCluster
from matchset.batch.workers.pool import Pool
from matchset.batch.workers.processes import Processes
from matchset.image.errors import LinkError
from matchset.numeric.imports import advice

CLICKS = "clicks.csv"  # format: in the folder of all results, the clicks of the page


def run_batch(options: BatchOptions) -> int:
    """Do what the options say.

    Returns
    -------
    int
        The exit code.
    """
    check_split(options)
    videos = VideoList(options.videos, options.out)
    if videos.twice:
        print_note(f"{videos.twice} videos are listed twice: each is done once")
    for words in videos.unread:
        print_note(f"{words}: what is in it is left out")
    store, out = opened_store(options.out)
    if os.path.realpath(out) == os.path.realpath(videos.common):
        raise ValueError(f"--out is the folder of the videos, {videos.common}: give the results one of their own")
    check_place(store, out)
    choice = chosen_with(options, store)
    with lock_of(store, out), Manifest(store, videos.common) as manifest, StopRequest() as stop:
        plan = Plan(videos, choice, store, manifest, out, options)
        counts = BatchCounts(videos.count)
        with store.begun(plan.mark):
            try:
                _work(options, plan, manifest, counts, stop)
            except LinkError:
                if store.is_current():
                    raise
                raise SupersededError(out) from None
            print(counts.words)
            if stop:
                print_note("stopped: the same command goes on")
                return stop.code
            total = write_report(store, manifest, plan)
    return FOUND if total.good else NOT_FOUND


def check_place(store: Store, out: str) -> None:
    """Refuse a place with files that a batch would replace, if no batch has begun there (ValueError)."""
    names = set(store.names(""))
    own = sorted(names & {CLICKS, *REPORTS})
    if own and not names & {FILE, MARK, LOCK} and not store.names(PARTS):
        raise ValueError(f"{out} has {own[0]}, but no batch has written there: choose another --out")


def chosen_with(options: BatchOptions, store: Store) -> TargetChoice:
    """Return what is followed, with the clicks of earlier pages."""
    clicked = store.read(CLICKS)
    if clicked is None:
        return TargetChoice(options)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / CLICKS
        path.write_bytes(clicked)
        return TargetChoice(options, path)


def opened_store(out: str) -> tuple[Store, str]:
    """Return the store that `--out` names, made if it is not there, and its whole name."""
    store = store_at(out)
    if not isinstance(store, FolderStore):
        return store, out
    try:
        store.path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ValueError(f"cannot write to {store.path}: {error.strerror}") from None
    return store, os.fspath(store.path)


def _work(options: BatchOptions, plan: Plan, manifest: Manifest, counts: BatchCounts, stop: StopRequest) -> None:
    clicker = _clicker(options, plan)
    if options.page and not options.retry:
        for outcome in doubtful(manifest, plan):
            clicker.ask(outcome)
    batch = Batch(plan, manifest, counts, clicker)
    with contextlib.closing(clicker), _pool(options) as pool, BatchDisplay(counts) as display:
        while not stop and batch.step(pool):
            display.show(pool)
        display.show(pool)


def doubtful(manifest: Manifest, plan: Plan) -> Iterator[VideoOutcome]:
    """Yield what was doubtful in an earlier run, and still is."""
    with manifest.by_folder() as outcomes:
        for video in plan.videos:
            outcome = outcomes.last(folder_of(video, manifest.root))
            if outcome is None or outcome.state != "doubtful":
                continue
            with contextlib.suppress(ValueError):  # nothing says any more what to follow in it: its row says so
                if outcome.settings == plan.again(video, outcome.folder).settings:  # nobody has clicked in it since
                    yield outcome


def _clicker(options: BatchOptions, plan: Plan) -> Clicker:
    if not options.page:
        return NoClicker()
    try:
        from matchset.batch.clicking.page import ClickPage
    except ImportError as error:
        raise ValueError(f"--page needs the extra web ({error.name} is missing): {advice('web')}") from None
    return ClickPage(plan.out, CLICKS)


def processors() -> int:
    """Return how many processors this program may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _pool(options: BatchOptions) -> Pool:
    worker = options.worker
    if worker.scheduler is None:
        return Processes(worker.jobs or processors(), options.shape)
    if worker.jobs is not None:
        raise ValueError("give one of --jobs and --scheduler")
    cluster = DaskCluster(worker.scheduler, options.shape)
    if cluster.dashboard:
        print_note(f"Dask shows its work at {cluster.dashboard}")
    return cluster
