"""What a worker does with a stretch of a long video, and with all its stretches at the end."""

import itertools
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

import msgspec

from matchset.app.exit_codes import FOUND, NOT_FOUND
from matchset.app.target.shape_option import parse_shape
from matchset.app.target.target_options import target_for
from matchset.batch.jobs.counts import TABLES, kept_table, table_in
from matchset.batch.jobs.job import Job, Stretch
from matchset.batch.jobs.video_options import Options
from matchset.batch.results.store import RUN, Store
from matchset.batch.split.joining import Cut, MisfitError, Part, cuts_between, joined
from matchset.batch.split.opening import MARKS, StretchOpening, read_marks
from matchset.media.video import Video
from matchset.shapes.circle import Circle

Follow = Callable[[Stretch, Path], int]
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


def join_stretches(job: Job, store: Store, folder: Path, follow: Follow) -> tuple[int, str]:
    """Write one table of all stretches; those beside a cut at which their rows differ are followed again, as one.

    Parameters
    ----------
    job : Job
    store : Store
    folder : Path
        Where the table is written.
    follow : callable
        Follows a stretch into a folder; returns the exit code of the command.

    Returns
    -------
    int
        An exit code: of `follow` where that was stopped.
    str
        What became of the stretches.

    Raises
    ------
    MisfitError
        If they do not fit together: their pictures or numbers are others, or rows differ at all cuts; one is missing.
    """
    if job.whole:
        raise MisfitError(job.whole)
    parts = {each: _kept_part(store, each.folder_in(job.folder)) for each in job.parts}
    cuts, words = cuts_between(list(parts.values())), f"joined of {len(parts)} stretches"
    if not all(cut.same for cut in cuts):
        stretches = _merged(job.parts, cuts)
        if len(stretches) == 1:
            raise MisfitError(f"rows of {len(parts)} stretches differ at all cuts")
        for each in stretches:
            if each not in parts:
                code, part = _followed(each, folder, follow)
                if part is None:
                    return code, words
                parts[each] = part
        words += f", {sum(each not in stretches for each in job.parts)} of them followed again: rows differed at a cut"
        parts = {each: parts[each] for each in stretches}
        cuts = cuts_between(list(parts.values()))
        if not all(cut.same for cut in cuts):
            raise MisfitError(f"rows of {len(parts)} stretches differ at a cut again")
    name, _ = kept_table(store, job.parts[0].folder_in(job.folder)) or (TABLES[0], b"")
    (folder / name).write_bytes(joined(list(parts.values()), cuts))
    return FOUND, words


def _kept_part(store: Store, folder: str) -> Part:
    _, table = kept_table(store, folder) or ("", None)
    return _part(table, store.read(f"{folder}/{MARKS}"), folder)


def _part(table: bytes | None, marks: bytes | None, name: str) -> Part:
    if not table or not marks:
        raise MisfitError(f"the results of {name} are not there")
    return Part(table, read_marks(marks))


def remove_stretches(store: Store, folder: str) -> None:
    """Remove the stretches of a video that is finished, which a batch has left that was killed just then."""
    for number in itertools.count():
        name = Stretch(number, 0.0, 0.0).folder_in(folder)
        if RUN not in store.names(name):
            return
        store.remove(name)


def _followed(stretch: Stretch, folder: Path, follow: Follow) -> tuple[int, Part | None]:
    """Follow a stretch in a folder that is gone afterwards."""
    with tempfile.TemporaryDirectory(dir=folder) as name:
        code, place = follow(stretch, Path(name)), Path(name)
        table = table_in(place)
        marks = place / MARKS
        if code not in (FOUND, NOT_FOUND):
            return code, None
        read = [each.read_bytes() if each is not None and each.is_file() else None for each in (table, marks)]
        return code, _part(read[0], read[1], f"stretch {stretch.number}")


def _merged(stretches: Sequence[Stretch], cuts: Sequence[Cut]) -> list[Stretch]:
    """Return stretches in which those beside a cut where rows differ are one."""
    merged = [stretches[0]]
    for stretch, cut in zip(stretches[1:], cuts, strict=True):
        if cut.same:
            merged.append(stretch)
        else:
            merged[-1] = msgspec.structs.replace(merged[-1], end=stretch.end)
    return merged
