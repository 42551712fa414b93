"""What a worker does with one video: `do_job`."""

import contextlib
import errno
import time
import traceback
from pathlib import Path

import msgspec

from matchset.app.exit_codes import FOUND, NOT_FOUND, print_note, stopped_when
from matchset.app.locate.command import locate
from matchset.app.locate.options import LocateOptions
from matchset.app.track.command import track
from matchset.batch.jobs.choice import Chosen, chosen_for, doubt_afterwards, write_frame
from matchset.batch.jobs.counts import counts_in, noted_table, table_in
from matchset.batch.jobs.identity import code_digest, content_digest, stat_of, worker_name
from matchset.batch.jobs.job import DONE, Job, State, Stretch, VideoOutcome
from matchset.batch.jobs.video_options import Options
from matchset.batch.jobs.videos import plain_name, plain_words
from matchset.batch.jobs.watch import Watch
from matchset.batch.results.store import LOG, RUN, Store, SupersededError, store_at
from matchset.batch.split.joining import MisfitError
from matchset.batch.split.parts import length_of
from matchset.batch.split.stretch_work import join_stretches, stretch_options
from matchset.image.errors import LinkError


class UnfitWorkerError(LinkError):
    """A worker cannot do the work: its program is another one, or it does not see the folders of the batch.

    Parameters
    ----------
    worker : str
    reason : str
    """

    def __init__(self, worker: str, reason: str) -> None:
        super().__init__(worker, reason)
        self.worker, self.reason = worker, reason


class FullDiskError(OSError):
    """There is no room for results."""


def do_job(job: Job) -> VideoOutcome:
    """Do what `track` or `locate` does with a video, and keep what it writes in the folder of its results.

    Parameters
    ----------
    job : Job

    Returns
    -------
    VideoOutcome
        Also of a video that cannot be read: with the reason.

    Raises
    ------
    UnfitWorkerError
        If this worker cannot do it.
    FullDiskError
        If the results do not fit on the disk.
    SupersededError
        If another batch has begun to write there since; nothing is kept then.
    """
    store = store_at(job.out, job.mark)
    _check_worker(job, store)
    begin = time.monotonic()
    size, modified = stat_of(job.video)
    try:
        content = _content_of(job, size, modified)
    except OSError as error:
        content, problem = "", f"cannot read {job.video}: {error.strerror}"
        return _outcome(job, "failed", problem, size=size, modified=modified)
    known = _known(store, job, content)
    if known is not None:
        return msgspec.structs.replace(known, size=size, modified=modified)
    try:
        with store.unfinished() as folder:
            with stopped_when(Watch(store)):
                outcome = _run(job, folder, store)
            if outcome.state == "stopped" and not store.is_current():
                raise SupersededError(job.out)
            known = _known(store, job, content) if job.parts and outcome.state == "failed" else None
            if known is not None:  # by another worker meanwhile
                return msgspec.structs.replace(known, size=size, modified=modified)
            seconds = round(time.monotonic() - begin + job.seconds, 3)
            outcome = msgspec.structs.replace(outcome, size=size, modified=modified, content=content, seconds=seconds)
            if stat_of(job.video) != (size, modified):  # so the same command does it again
                outcome = msgspec.structs.replace(
                    outcome, reason=f"it has changed meanwhile; {outcome.reason}".rstrip("; ")
                )
            if outcome.state not in ("stopped", "chosen"):
                _name_results(folder / LOG, folder, job.folder)
                (folder / RUN).write_bytes(msgspec.json.encode(outcome))
                store.keep(folder, job.folder)
                for stretch in reversed(job.parts):  # `remove_stretches` goes on from the first one
                    store.remove(stretch.folder_in(job.folder))
    except OSError as error:
        if is_full(error):
            raise FullDiskError(errno.ENOSPC, f"no room for the results of {job.video}", job.out) from None
        if not store.is_current():  # so its folder is gone
            raise SupersededError(job.out) from None
        raise
    return outcome


def kept_outcome(store: Store, job: Job) -> VideoOutcome | None:
    """Return what the results of a video say became of it with these settings; None if nothing, or if not whole."""
    text = store.read(f"{job.folder}/{RUN}")
    if text is None:
        return None
    try:
        outcome = msgspec.json.decode(text, type=VideoOutcome)
    except msgspec.MsgspecError:
        return None
    if outcome.settings != job.settings or (outcome.frames and noted_table(store, outcome) is None):
        return None
    return outcome


def _content_of(job: Job, size: int, modified: int) -> str:
    """Return what the bytes of a video are known by; a stretch by less, as what joins it reads the whole file."""
    whole = job.stretch is None and not job.choosing
    return content_digest(job.video) if whole else f"{size} {modified}"


def _known(store: Store, job: Job, content: str) -> VideoOutcome | None:
    """Return what became of a video, if its results are there, of the same bytes."""
    known = kept_outcome(store, job)
    if known is not None and known.content == content and known.state in DONE:
        return msgspec.structs.replace(known, video=plain_name(job.video))
    return None


def is_full(error: BaseException | None) -> bool:
    """Whether an error is that of a full disk, or came after one."""
    while error is not None:
        if isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EDQUOT):
            return True
        error = error.__cause__ or error.__context__
    return False


def another_program(there: str, here: str = "") -> str:
    """Return what is said of a worker with another program than the batch."""
    return f"its matchset is another one: {there}, here {here or code_digest()}"


def _check_worker(job: Job, store: Store) -> None:
    worker = worker_name()
    if job.code and job.code != code_digest():
        raise UnfitWorkerError(worker, another_program(code_digest(), job.code))
    if not store.is_current():
        raise UnfitWorkerError(worker, f"it does not see {job.out} as it is here: share that folder")
    if job.size and stat_of(job.video) == (0, 0):
        raise UnfitWorkerError(worker, f"it does not see {job.video}: share that folder")


def _run(job: Job, folder: Path, store: Store) -> VideoOutcome:
    """Run the command; what it says goes to `log.txt`."""
    with (
        (folder / LOG).open("w", encoding="utf-8", errors="surrogateescape") as log,
        contextlib.redirect_stdout(log),
        contextlib.redirect_stderr(log),
    ):
        try:
            chosen = chosen_for(job, folder)
            if chosen.doubt:
                return _outcome(job, "doubtful", chosen.doubt, click=chosen.click)
            if job.choosing:
                outcome = _outcome(job, "chosen", chosen.words, click=chosen.click)
                return msgspec.structs.replace(outcome, length=length_of(job))
            code, words = _joined(job, chosen.options, folder, store) if job.parts else (None, "")
            chosen = msgspec.structs.replace(chosen, words="; ".join(filter(None, (chosen.words, words))))
            if code is None:
                code = _run_command(job, chosen.options, folder)
        except Exception as error:  # whatever a file makes of a decoder: one video is one row
            if is_full(error):
                raise
            if not isinstance(error, ValueError | OSError):
                traceback.print_exc(file=log)
            print(f"error: {error}", file=log)
            return _outcome(job, "failed", " ".join(str(error).split()) or type(error).__name__)
    return _counted(job, folder, code, chosen)


def _joined(job: Job, options: Options, folder: Path, store: Store) -> tuple[int | None, str]:
    """Join the stretches of a video; returns an exit code, None if the video is to be followed whole, and words."""

    def follow(stretch: Stretch, place: Path) -> int:
        return _run_command(msgspec.structs.replace(job, stretch=stretch), options, place)

    try:
        return join_stretches(job, store, folder, follow)
    except MisfitError as error:
        print_note(f"{error}: the video is followed whole")
        return None, f"followed whole: {error}"


def _name_results(log: Path, folder: Path, name: str) -> None:
    """Write the names of files in a log as they will be."""
    words = log.read_text(encoding="utf-8", errors="surrogateescape")
    log.write_text(words.replace(str(folder), name), encoding="utf-8", errors="surrogateescape")


def _run_command(job: Job, options: Options, folder: Path) -> int:
    """Run `track` or `locate` for a video, or for a stretch of it; returns its exit code."""
    if job.stretch is not None:
        options = stretch_options(job, options, folder)
    return run_command(msgspec.structs.replace(options, source=job.video, out=folder, force=True))


def run_command(options: Options) -> int:
    """Run `track` or `locate`; returns its exit code."""
    return locate(options) if isinstance(options, LocateOptions) else track(options)


def _counted(job: Job, folder: Path, code: int, chosen: Chosen) -> VideoOutcome:
    if code not in (FOUND, NOT_FOUND):
        return _outcome(job, "stopped", "stopped")
    frames, found = counts_in(folder)
    state: State = "found" if found else "not found"
    whole = job.auto and job.stretch is None and chosen.click
    doubt = doubt_afterwards(frames, found) if whole else ""
    if doubt:
        write_frame(job, chosen.click, folder)
        state, chosen = "doubtful", msgspec.structs.replace(chosen, words=doubt)
    table = table_in(folder)
    return msgspec.structs.replace(
        _outcome(job, state, chosen.words, click=chosen.click),
        frames=frames,
        found=found,
        table="" if table is None else content_digest(str(table)),
    )


def _outcome(
    job: Job, state: State, reason: str = "", *, click: str = "", size: int = 0, modified: int = 0
) -> VideoOutcome:
    return VideoOutcome(
        video=plain_name(job.video),
        folder=job.folder,
        settings=job.settings,
        state=state,
        reason=plain_words(reason),
        worker=worker_name(),
        click=click,
        size=size,
        modified=modified,
    )
