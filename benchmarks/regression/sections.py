"""All that is measured, by name: `SECTIONS`, and what belongs to a choice of them: `chosen`."""

from collections.abc import Callable, Sequence
from pathlib import Path

import msgspec

from benchmarks.real.clips import Clip
from benchmarks.regression import drawn, footage, rendered, times, worse_copies
from benchmarks.regression.balls import equal, flights, small, stills
from benchmarks.regression.figures import Figure


class Job(msgspec.Struct, frozen=True):
    """What a section is measured with.

    Parameters
    ----------
    clips : sequence of Clip
    data : Path
        Their folder.
    photographs : Path or None
        To render random videos before; None: there are none.
    quick : bool
        The fast part only.
    """

    clips: Sequence[Clip]
    data: Path
    photographs: Path | None = None
    quick: bool = False


class Section(msgspec.Struct, frozen=True):
    """A piece of the work.

    Parameters
    ----------
    measure : callable
        From a `Job` to figures.
    how : str
        What is measured, a sentence or two.
    quick : bool
        Whether it has a fast part.
    photographs : bool
        Whether it needs photographs.
    footage : bool
        Whether it needs clips or other files of their folder.
    figures : tuple of str
        The sections of its figures.
    """

    measure: Callable[[Job], list[Figure]]
    how: str
    figures: tuple[str, ...]
    quick: bool = False
    photographs: bool = False
    footage: bool = True


def _videos(job: Job) -> list[Figure]:
    return [] if job.photographs is None else drawn.measure_videos(job.photographs)


def _clicks(job: Job) -> list[Figure]:
    return [] if job.photographs is None else drawn.measure_clicks(job.photographs)


SECTIONS = {
    "standard": Section(
        lambda job: footage.measure_standard(job.clips, job.quick),
        "The standard click, half a radius left of the center in the first tight row, is followed to the end of a "
        "clip, with no help.",
        (footage.STANDARD,),
        quick=True,
    ),
    "searches": Section(
        lambda job: footage.measure_searches(job.clips, job.data),
        "`detect` searches every labelled row with the color of the standard click; each clip's color is sought in "
        f"frames of others, about {footage.SEARCHES} times in all.",
        (footage.SEARCH, footage.FOREIGN),
    ),
    "nine": Section(
        lambda job: footage.measure_nine(job.clips),
        f"All nine clicks into the first tight row, each for {footage.FOLLOWED} pictures.",
        (footage.NINE,),
    ),
    "copies": Section(
        lambda job: worse_copies.measure(job.clips),
        f"Of each worse copy of a clip the first {worse_copies.PICTURES} pictures, from three clicks into the first "
        "tight row; `detect` in the labelled rows of them.",
        (worse_copies.SECTION,),
    ),
    "false_locks": Section(
        lambda _: rendered.measure_false_locks(),
        "A thousand rendered frames without the ball for each of two seeds.",
        (rendered.FALSE_LOCKS,),
        footage=False,
    ),
    "shapes": Section(
        lambda _: rendered.measure_shapes(),
        f"Two sequences of {rendered.SHAPE_FRAMES} rendered frames of each shape; *hidden*: a third of the outline.",
        (rendered.SHAPES,),
        footage=False,
    ),
    "videos": Section(
        _videos,
        f"Random videos {drawn.VIDEOS[0]} to {drawn.VIDEOS[-1]}, matchset alone.",
        (drawn.SECTION,),
        photographs=True,
        footage=False,
    ),
    "clicks": Section(
        _clicks,
        f"Three clicks into the first frames of the random videos {drawn.CLICKED[0]} to {drawn.CLICKED[-1]}.",
        (drawn.CLICKS,),
        photographs=True,
        footage=False,
    ),
    "small": Section(
        lambda job: small.measure(job.quick),
        f"Sixteen rendered scenes of {small.PICTURES} pictures with a small fast ball, seeds {small.REPORTED} to "
        f"{small.REPORTED + 15}, each from one click. *Right*: the center is less than half a radius off, or less than "
        f"{small.RIGHT_PX:g} px. *Wrong*: it is more than {small.FAR:g} radii off, and more than {small.FAR_PX:g} px.",
        (small.SECTION,),
        quick=True,
        footage=False,
    ),
    "stills": Section(
        lambda job: stills.measure(job.data),
        "`detect` searches single pictures of a football field, with the color of a click at the center of the widest "
        "ball of the same folder. *Found*: a label's center within half the size of its box, or "
        f"{stills.WITHIN_PX:g} px, and its radius within a factor {stills.RATIO:g}. *False*: what is no labelled ball.",
        (stills.SECTION,),
        quick=True,
    ),
    "equal": Section(
        lambda _: equal.measure(),
        f"Two equal red balls, a blue one that passes before one of them, {equal.PICTURES} rendered pictures. One "
        f"click, in each of {len(equal.STARTS)} pictures. *Right*: the center is less than half a radius off. *Wrong*: "
        f"it is more than {equal.FAR:g} radii off.",
        (equal.SECTION,),
        footage=False,
    ),
    "flights": Section(
        lambda _: flights.measure(),
        f'`matchset fly "sim://chain?seed=N"` for {len(flights.SEEDS)} seeds, {flights.DURATION:g} s each. *Worst '
        "axis*: the largest root mean square off the set place, of any follower in any axis.",
        (flights.SECTION,),
        footage=False,
    ),
    "time": Section(lambda job: times.measure(job.clips, job.quick), times.HOW, times.FIGURES, quick=True),
}
ACCURACY, TIME = "accuracy", "time"


def chosen(only: str = "", quick: bool = False, photographs: bool = True, clips: bool = True) -> list[str]:
    """Name the sections of a choice.

    Parameters
    ----------
    only : str
        "accuracy", "time", or names of sections, joined by commas; empty: all.
    quick : bool
        Those with a fast part only.
    photographs : bool
        Whether there are photographs; without them some are left out.
    clips : bool
        Whether there are clips; without them some are left out.

    Returns
    -------
    list of str

    Raises
    ------
    ValueError
        If it names anything else.
    """
    groups = {"": list(SECTIONS), ACCURACY: [name for name in SECTIONS if name != TIME]}
    names = groups.get(only, only.split(","))
    strange = [name for name in names if name not in SECTIONS]
    if strange:
        raise ValueError(f"choose accuracy, time or some of {', '.join(SECTIONS)}, got {', '.join(strange)}")
    fast = [name for name in names if SECTIONS[name].quick or not quick]
    shown = [name for name in fast if photographs or not SECTIONS[name].photographs]
    return [name for name in shown if clips or not SECTIONS[name].footage]
