"""`matchset score`: answers against the truth (`score`), the truth's file (`read_truth`), and the printed table."""

import math
import textwrap
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.app.tables import CsvLine, by_frame, read_csv
from matchset.app.track.rows import TrackRow, read_tracks

Circle3 = tuple[float, float, float]

# theorem: a detection is valid when its error, Eq. 10 of Epstein & Feldman, is below 5 px (the paper's definition)
VALID_BELOW_PX = 5.0
TRUTH_COLUMNS = ("video", "frame", "x", "y", "r", "visible", "method")


class TruthRow(msgspec.Struct, frozen=True):
    """Where the ball is in one frame.

    Parameters
    ----------
    frame : int
        The frame's index in the video, from 0, in decode order.
    circle : tuple of three floats, or None
        Center x, y and radius, px; None where the ball is absent.
    lowconf : bool
        The circle is known to a few pixels only: it shows that the ball is visible, but no error is measured against
        it.
    """

    frame: int
    circle: tuple[float, float, float] | None
    lowconf: bool = False

    @property
    def tight(self) -> bool:
        """Whether the circle is visible and known well enough to measure an error against."""
        return self.circle is not None and not self.lowconf


class Score(msgspec.Struct, frozen=True):
    """The figures of a run; None where the truth holds no frames to tell one from.

    The error of an answer is Eq. 10: ``|x - x*| + |y - y*| + |r - r*|``, px. *Tight* frames are those in
    which the ball is visible and the truth is not ``lowconf``.

    Parameters
    ----------
    visible, tight, absent : int
        Frames of the truth with the ball, those of them known well, and those without it.
    answered : int
        Tight frames that were answered; the errors are taken over these.
    mean_error_px, median_error_px, error_95_px : float or None
        Mean, median and 95th percentile of the error.
    valid : int
        Tight frames answered with an error below 5 px.
    valid_percent : float or None
        The same, as a percentage of all tight frames: a `Lost` there is not valid.
    lost : int
        Frames with the ball visible, tight or not, that were not answered.
    lost_percent : float or None
        The same, as a percentage of all frames with the ball visible.
    false_locks : int
        Answers where the ball is absent, or with a center farther than the true radius from the true one.
    trembling_px : float or None
        Mean over consecutive answered tight frames of ``|de_x| + |de_y| + |de_r|``, where e = answer - truth.
    jitter_px : float or None
        Root mean square of the length of the second difference of e, over three consecutive answered tight
        frames.
    """

    visible: int
    tight: int
    absent: int
    answered: int
    mean_error_px: float | None
    median_error_px: float | None
    error_95_px: float | None
    valid: int
    valid_percent: float | None
    lost: int
    lost_percent: float | None
    false_locks: int
    trembling_px: float | None
    jitter_px: float | None


def score(answers: Mapping[int, Circle3 | None], truths: Iterable[TruthRow], start: int = 0) -> Score:
    """Measure answers against the truth.

    Parameters
    ----------
    answers : mapping of int to (x, y, radius) or None
        By frame: the circle found, px, or None; a frame that is missing was not answered.
    truths : iterable of TruthRow
        Where the ball is; frames without truth do not count.
    start : int
        The first frame that counts.

    Returns
    -------
    Score
        The figures.
    """
    counted = sorted((truth for truth in truths if truth.frame >= start), key=lambda truth: truth.frame)
    visible = [truth for truth in counted if truth.circle is not None]
    tight = [truth for truth in visible if truth.tight]
    offsets = {
        truth.frame: np.subtract(circle, truth.circle)
        for truth in tight
        if truth.circle is not None and (circle := answers.get(truth.frame)) is not None
    }
    errors = np.array([np.abs(offset).sum() for offset in offsets.values()])
    valid = int((errors < VALID_BELOW_PX).sum())
    lost = sum(answers.get(truth.frame) is None for truth in visible)
    return Score(
        visible=len(visible),
        tight=len(tight),
        absent=len(counted) - len(visible),
        answered=len(offsets),
        mean_error_px=_statistic(errors, np.mean),
        median_error_px=_statistic(errors, np.median),
        error_95_px=_statistic(errors, lambda values: np.percentile(values, 95.0)),
        valid=valid,
        valid_percent=_percent(valid, len(tight)),
        lost=lost,
        lost_percent=_percent(lost, len(visible)),
        false_locks=sum(_is_false_lock(answers.get(truth.frame), truth.circle) for truth in counted),
        trembling_px=_statistic(_differences(offsets, order=1), lambda steps: np.abs(steps).sum(axis=1).mean()),
        jitter_px=_statistic(
            _differences(offsets, order=2), lambda bends: np.sqrt(np.square(bends).sum(axis=1).mean())
        ),
    )


def circles(rows: Iterable[TrackRow]) -> dict[int, Circle3 | None]:
    """Turn the rows of a table into the answers that `score` takes."""
    return {
        row.frame: None if row.shape is None else (row.shape["x"], row.shape["y"], row.shape["radius"]) for row in rows
    }


def _differences(offsets: Mapping[int, npt.NDArray[np.float64]], order: int) -> npt.NDArray[np.float64]:
    runs = [[offsets.get(frame + back) for back in range(-order, 1)] for frame in offsets]
    whole = [run for run in runs if all(offset is not None for offset in run)]
    return np.diff(np.array(whole, dtype=np.float64).reshape(len(whole), order + 1, 3), n=order, axis=1)[:, 0]


def _is_false_lock(answer: Circle3 | None, truth: Circle3 | None) -> bool:
    if answer is None:
        return False
    return truth is None or math.hypot(answer[0] - truth[0], answer[1] - truth[1]) > truth[2]


def _statistic(
    values: npt.NDArray[np.float64], statistic: Callable[[npt.NDArray[np.float64]], np.floating]
) -> float | None:
    return float(statistic(values)) if len(values) else None


def _percent(part: int, whole: int) -> float | None:
    return 100.0 * part / whole if whole else None


def error_px(answer: Sequence[float], truth: Sequence[float]) -> float:
    """Return the error of one answer, Eq. 10: ``|x - x*| + |y - y*| + |r - r*|``, px."""
    return float(sum(abs(a - b) for a, b in zip(answer, truth, strict=True)))


def read_truth(path: str | Path, video: str | None = None) -> list[TruthRow]:
    """Read a truth file.

    Parameters
    ----------
    path : str or Path
        A CSV file with the columns ``video,frame,x,y,r,visible,method``.
    video : str, optional
        Which video's rows to take; needed only if the file holds several.

    Returns
    -------
    list of TruthRow
        One for each row, in the order of their frames.

    Raises
    ------
    ValueError
        If the file cannot be read or a row is wrong; the message holds the file and the line.
    """
    rows = read_csv(path, required=("frame", "x", "y", "r", "visible"))
    videos = sorted({row.text("video") for row in rows})
    if video is not None and video not in videos:
        raise ValueError(f"{path} holds no rows of the video {video!r}; it has {', '.join(videos) or 'none'}")
    if video is None and len(videos) > 1:
        raise ValueError(f"{path} holds several videos ({', '.join(videos)}): say which")
    chosen = [row for row in rows if video is None or row.text("video") == video]
    return by_frame(chosen, _truth_of)


def _truth_of(row: CsvLine) -> TruthRow:
    frame = row.index("frame")
    if not row.flag("visible"):
        return TruthRow(frame, None)
    circle = row.number("x"), row.number("y"), row.number("r")
    if circle[2] <= 0.0:
        raise row.error(f"the radius must be positive, got {row.text('r')}")
    return TruthRow(frame, circle, lowconf=row.text("method").endswith("|lowconf"))


def score_files(
    tracks: Path, truth: Path, start: int, video: str | None, as_json: bool, identity: int | None = None
) -> Score:
    """Score a table of tracks and print the result.

    Parameters
    ----------
    tracks, truth : Path
        The two tables.
    start : int
        The first frame that counts.
    video : str or None
        Whose rows of the truth to take, if it holds several videos'.
    as_json : bool
        Whether to print one line of JSON.
    identity : int, optional
        Whose rows of the tracks to take, if they are of several targets.

    Returns
    -------
    Score
        What was printed.
    """
    rows, truths = read_tracks(tracks, identity), read_truth(truth, video)
    result = score(circles(rows), truths, start)
    if not result.visible + result.absent:
        raise ValueError(f"{truth} holds no frames from frame {start} on")
    if as_json:
        print(msgspec.json.encode(result).decode())
    else:
        print_score(result)
    return result


def print_score(result: Score) -> None:
    """Print a score as a table of figure, value and what it is computed over, as wide as the terminal is."""
    from rich.console import Console
    from rich.text import Text

    console = Console(highlight=False)
    for figure, rest in score_text(score_lines(result), console.width):
        console.print(Text.assemble(figure, (rest, "dim")), soft_wrap=True)


def score_text(lines: Sequence[tuple[str, str, str]], width: int) -> list[tuple[str, str]]:
    """Align the lines of a score; explanations wrap between words, or stand below where there is little room.

    Parameters
    ----------
    lines : sequence of (name, value, explanation)
    width : int
        Of the terminal, characters.

    Returns
    -------
    list of (str, str)
        Lines of a figure and what follows it, without blanks at their ends.
    """
    names, values = (max(len(line[part]) for line in lines) for part in (0, 1))
    indent = names + values + 4
    beside = width - indent >= max(len(word) for line in lines for word in line[2].split())
    text: list[tuple[str, str]] = []
    for name, value, words in lines:
        figure = f"{name:<{names}}  {value:>{values}}"
        if beside:
            first, *more = textwrap.wrap(words, width - indent) or [""]
            text.append((figure, f"  {first}".rstrip()))
            text += [("", " " * indent + each) for each in more]
        else:
            text.append((figure, ""))
            text += [("", f"  {each}") for each in textwrap.wrap(words, max(width - 2, 1), break_long_words=False)]
    return text


def score_lines(result: Score) -> list[tuple[str, str, str]]:
    """Return a score as lines of name, value with its unit, and explanation."""
    return [
        ("mean error", _px_text(result.mean_error_px), _answered_text(result)),
        ("median error", _px_text(result.median_error_px), ""),
        ("95 % of errors below", _px_text(result.error_95_px), ""),
        (
            "valid",
            _percent_text(result.valid_percent),
            _share_text(result.valid, result.tight, f"error < {VALID_BELOW_PX:g} px"),
        ),
        (
            "lost",
            _percent_text(result.lost_percent),
            _share_text(result.lost, result.visible, "ball visible, no answer"),
        ),
        ("false locks", str(result.false_locks), f"in {result.visible + result.absent} frames with truth"),
        (
            "trembling",
            _px_text(result.trembling_px),
            "mean change of the error from frame to frame"
            if result.trembling_px is not None
            else "needs two answered frames with truth in a row",
        ),
        (
            "jitter",
            _px_text(result.jitter_px),
            "rms second difference: shaking without the drift"
            if result.jitter_px is not None
            else "needs three answered frames with truth in a row",
        ),
    ]


def _answered_text(result: Score) -> str:
    """Say which frames the errors are taken over, or why there are none."""
    if result.answered:
        return f"of {result.answered} answered frames, |dx| + |dy| + |dr|"
    return f"none of {result.tight} frames was answered" if result.tight else "the truth has no exact circle"


def _px_text(value: float | None) -> str:
    return "-" if value is None else f"{value:.3f} px"


def _percent_text(value: float | None) -> str:
    return "-" if value is None else f"{value:.1f} %"


def _share_text(part: int, whole: int, words: str) -> str:
    return f"{part} of {whole} frames, {words}"
