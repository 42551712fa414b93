"""What a worker does with a stretch of a long video, and with all its stretches at the end."""

from pathlib import Path

import msgspec

from matchset.app.target.shape_option import parse_shape
from matchset.app.target.target_options import target_for
from matchset.batch.jobs.counts import TABLES, kept_table
from matchset.batch.jobs.job import Job
from matchset.batch.jobs.video_options import Options
from matchset.batch.results.store import Store
from matchset.batch.split.joining import Part, joined
from matchset.batch.split.opening import MARKS, StretchOpening, read_marks
from matchset.media.video import Video
from matchset.shapes.circle import Circle

COLOR = "color.npz"  # format: beside the table of a stretch, what was clicked


def stretch_folder(folder: str, number: int) -> str:
    """Return the folder of a stretch's results, by that of the whole video's."""
    return f"{folder}.{number:04d}"


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
    colored = msgspec.structs.replace(options.target, picks=None, candidate=None, reading=1, color=[folder / COLOR])
    return msgspec.structs.replace(changed, target=colored)


def join_stretches(job: Job, store: Store, folder: Path) -> str:
    """Write one table of all stretches; returns where they go over into each other with other rows, in words.

    Raises
    ------
    MisfitError
        If two of them do not fit together.
    """
    parts, name = list[Part](), TABLES[0]
    for number in range(job.parts):
        place = stretch_folder(job.folder, number)
        name, table = kept_table(store, place) or (name, b"")
        parts.append(Part(table, read_marks(store.read(f"{place}/{MARKS}") or b"")))
    text, differing = joined(parts)
    (folder / name).write_bytes(text)
    words = f"joined of {job.parts} stretches"
    return f"{words}; rows differ at the cuts before frames {', '.join(map(str, differing))}" if differing else words
