"""What is still to be done: `Plan` goes through the videos of a batch and leaves out those that are finished."""

import secrets
import unicodedata
from collections.abc import Iterator

import msgspec

from matchset.batch.jobs.identity import code_digest, problem_of, stat_of
from matchset.batch.jobs.job import DONE, Job, VideoOutcome
from matchset.batch.jobs.target import TargetChoice
from matchset.batch.jobs.video_options import settings_digest
from matchset.batch.jobs.videos import VideoList, folder_of, plain_name, plain_words
from matchset.batch.jobs.work import kept_outcome
from matchset.batch.options import BatchOptions
from matchset.batch.results.manifest import Manifest
from matchset.batch.results.store import FolderStore, Store
from matchset.batch.split.stretch_work import remove_stretches


class Plan:
    """Makes a job of each video that is not finished.

    Parameters
    ----------
    videos : VideoList
    choice : TargetChoice
    store : Store
    manifest : Manifest
    out : str
        Where results go, as workers name it.
    options : BatchOptions

    Raises
    ------
    ValueError
        If a row of the table of clicks may mean several videos.

    Attributes
    ----------
    split : float or None
        Length of stretches, s.
    earlier : int
        Videos that were finished before.
    mark : str
        What workers must find in `out`.
    """

    def __init__(
        self,
        videos: VideoList,
        choice: TargetChoice,
        store: Store,
        manifest: Manifest,
        out: str,
        options: BatchOptions,
    ) -> None:
        self.videos, self.choice, self._store, self._manifest = videos, choice, store, manifest
        self.out, self._retry, self.split = out, options.retry, options.worker.split
        self._same: set[int] | None = None
        self.earlier, self.mark = 0, secrets.token_hex(8)
        choice.match((video, folder_of(video, manifest.root)) for video in videos)

    def work(self) -> Iterator[Job | VideoOutcome]:
        """Yield what is to be done; of what cannot be done, or was done and is not in the manifest, the outcome."""
        self._same = set[int]() if self._store.ignores_case else None
        for video in self.videos:
            folder = folder_of(video, self._manifest.root)
            found = self._of(video, folder)
            if found is None:
                self.earlier += 1
            else:
                yield found

    def job(self, video: str, folder: str, size: int) -> Job:
        """Return the job of a video (ValueError if nothing says what to follow in it)."""
        options, auto = self.choice.options(video, folder)
        settings = settings_digest(options, f"{code_digest(every=False)} auto={auto} split={self.split}")
        return Job(
            video=video,
            folder=folder,
            out=self.out,
            options=options,
            settings=settings,
            code=code_digest(),
            mark=self.mark,
            auto=auto,
            size=size,
        )

    def again(self, video: str, folder: str) -> Job:
        """Return the job of a video in which somebody has clicked since (ValueError if it cannot be read)."""
        return self.job(video, folder, stat_of(video)[0])

    def _unless_known(self, failed: VideoOutcome, reason: str) -> VideoOutcome | None:
        known = self._manifest.is_done(failed, not self._retry)
        return None if known else msgspec.structs.replace(failed, reason=plain_words(reason))

    def _of(self, video: str, folder: str) -> Job | VideoOutcome | None:
        size, modified = stat_of(video)
        name = plain_name(video)
        failed = VideoOutcome(video=name, folder=folder, settings="", state="failed", size=size, modified=modified)
        try:
            job = self.job(video, folder, size)
        except ValueError as error:
            return self._unless_known(failed, str(error))
        problem = "" if size else problem_of(video)
        if self._same is not None and not problem:
            key = hash(unicodedata.normalize("NFC", folder).casefold())
            if key in self._same:
                problem = (
                    "the name of another one differs in upper and lower case alone, which --out does not tell apart"
                )
            self._same.add(key)
        if problem:
            return self._unless_known(failed, problem)
        if self._manifest.is_done(msgspec.structs.replace(failed, settings=job.settings), not self._retry):
            return None
        if not isinstance(self._store, FolderStore) and self.split is None:
            return job  # asking takes as long as handing it out, and a worker looks, too, unless it is cut
        kept = kept_outcome(self._store, job)  # a batch that was killed between both
        if kept is not None and self.split is not None:
            remove_stretches(self._store, folder)
        if kept is not None and (kept.size, kept.modified) == (size, modified) and kept.video == name:
            return kept if kept.state in DONE or not self._retry else job
        return job
