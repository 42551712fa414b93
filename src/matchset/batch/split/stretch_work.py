"""What a worker does with a stretch of a long video, and with all its stretches at the end."""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import msgspec

from matchset.app.target.shape_option import parse_shape
from matchset.app.target.target_options import target_for
from matchset.batch.jobs.counts import TABLES, kept_table
from matchset.batch.jobs.job import Job, Stretch
from matchset.batch.jobs.video_options import Options
from matchset.batch.results.store import Store
from matchset.batch.split.joining import Cut, MisfitError, Part, cuts_between, joined
from matchset.batch.split.opening import MARKS, StretchOpening, read_marks
from matchset.media.video import Video
from matchset.shapes.circle import Circle

COLOR = "color.npz"  # format: beside the table of a stretch, what was clicked


def stretch_options(job: Job, options: Options, folder: Path) -> Options:
    """Return what the command is told for a stretch: it reads that alone, and knows a click by its color.

    Parameters
    ----------
    job : Job
    options : TrackOptions or LocateOptions
        For the whole video.
    folder : Path
        Where its results are written.
    """
    assert job.stretch is not None
    opening = StretchOpening(stretch=job.stretch, marks=folder / MARKS)
    changed: Options = msgspec.structs.replace(options, silence=opening)
    target = options.target.single
    if job.stretch.number == 0 or (target.pick is None and target.candidate is None):
        return changed
    with Video(job.video, fps=options.fps, **options.view.arguments) as video:
        ball = parse_shape(getattr(options, "shape", "circle")) is Circle
        learned, _ = target_for(video, msgspec.structs.replace(target, ball=ball))
    learned.color.save(folder / COLOR)
    opening = msgspec.structs.replace(opening, first=learned.frame)
    colored = msgspec.structs.replace(options.target, picks=None, candidate=None, reading=1, color=[folder / COLOR])
    return msgspec.structs.replace(changed, target=colored, silence=opening)


class Joined(msgspec.Struct, frozen=True):
    """What became of the stretches of a video.

    Parameters
    ----------
    words : str
    stretches : tuple of Stretch
        Those that are kept in folders of their own.
    """

    words: str
    stretches: tuple[Stretch, ...]


def join_stretches(job: Job, store: Store, folder: Path, follow: Callable[[Job], None]) -> Joined:
    """Write one table of all stretches; those beside a cut where their rows differ are followed again, as one.

    Parameters
    ----------
    job : Job
    store : Store
    folder : Path
        Where the table is written.
    follow : callable
        Follows a stretch, and keeps what that gives.

    Raises
    ------
    MisfitError
        If they do not fit together: their pictures or numbers are others, or all would be followed again.
    """
    stretches, words = job.parts, f"joined of {len(job.parts)} stretches"
    parts, cuts = _parts_of(job, store, stretches)
    apart = [cut.frame + cut.shift for cut in cuts if not cut.same]
    if apart:
        stretches = tuple(_merged(stretches, [cut.same for cut in cuts]))
        again = [each for each in stretches if each.last > each.number]
        if len(stretches) == 1:
            raise MisfitError(f"rows differ at each of the {len(cuts)} cuts")
        for each in again:
            follow(msgspec.structs.replace(job, folder=each.folder_in(job.folder), stretch=each, parts=()))
        parts, cuts = _parts_of(job, store, stretches)
        if not all(cut.same for cut in cuts):
            raise MisfitError("rows differ at a cut although the stretches beside it were followed again")
        words += f"; {sum(each.last - each.number + 1 for each in again)} of them followed again: rows differed at a cut"
    name, _ = kept_table(store, stretches[0].folder_in(job.folder)) or (TABLES[0], b"")
    (folder / name).write_bytes(joined(parts, cuts))
    return Joined(words, (*job.parts, *(each for each in stretches if each not in job.parts)))


def _parts_of(job: Job, store: Store, stretches: Sequence[Stretch]) -> tuple[list[Part], list[Cut]]:
    """Read the tables of stretches, and find where they go over into each other."""
    parts = list[Part]()
    for stretch in stretches:
        place = stretch.folder_in(job.folder)
        _, table = kept_table(store, place) or ("", b"")
        parts.append(Part(table, read_marks(store.read(f"{place}/{MARKS}") or b"")))
    return parts, cuts_between(parts)


def _merged(stretches: Sequence[Stretch], same: Sequence[bool]) -> Iterator[Stretch]:
    """Yield stretches, those beside a cut where rows differ as one."""
    first = stretches[0]
    for stretch, good in zip(stretches, [*same, True], strict=True):
        if good:
            yield msgspec.structs.replace(first, last=stretch.last, end=stretch.end)
            first = next((each for each in stretches if each.number > stretch.last), first)
