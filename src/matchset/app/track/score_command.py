"""`matchset score`: a table of tracks against the truth, as a table to read or as JSON."""

from pathlib import Path

import msgspec
from rich.console import Console
from rich.table import Table

from matchset.app.track.row_table import read_tracks
from matchset.app.track.score import VALID_BELOW_PX, Score, circles, score
from matchset.app.track.truth import read_truth


def score_files(tracks: Path, truth: Path, start: int, video: str | None, as_json: bool) -> Score:
    """Score a table and print the result.

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

    Returns
    -------
    Score
        What was printed.
    """
    rows, truths = read_tracks(tracks), read_truth(truth, video)
    result = score(circles(rows), truths, start)
    if not result.visible + result.absent:
        raise ValueError(f"{truth} holds no frames from frame {start} on")
    if as_json:
        print(msgspec.json.encode(result).decode())
    else:
        print_score(result, Console(highlight=False))
    return result


def print_score(result: Score, console: Console) -> None:
    """Print a score as a table of figure, value and what it is taken over."""
    table = Table(box=None, pad_edge=False, show_header=False)
    table.add_column("")
    table.add_column("", justify="right")
    table.add_column("", style="dim")
    for line in score_lines(result):
        table.add_row(*line)
    console.print(table)


def score_lines(result: Score) -> list[tuple[str, str, str]]:
    """Return a score as lines of name, value with its unit, and explanation."""
    answered = f"of {result.answered} answered frames, |dx| + |dy| + |dr|"
    return [
        ("mean error", _px(result.mean_error_px), answered),
        ("median error", _px(result.median_error_px), ""),
        ("95 % of errors below", _px(result.error_95_px), ""),
        (
            "valid",
            _percent(result.valid_percent),
            _of(result.valid, result.tight, f"error < {VALID_BELOW_PX:g} px"),
        ),
        ("lost", _percent(result.lost_percent), _of(result.lost, result.visible, "ball visible, no answer")),
        ("false locks", str(result.false_locks), f"in {result.visible + result.absent} frames with truth"),
        ("trembling", _px(result.trembling_px), "mean change of the error from frame to frame"),
        ("jitter", _px(result.jitter_px), "rms second difference of the error"),
    ]


def _px(value: float | None) -> str:
    return "-" if value is None else f"{value:.3f} px"


def _percent(value: float | None) -> str:
    return "-" if value is None else f"{value:.1f} %"


def _of(part: int, whole: int, words: str) -> str:
    return f"{part} of {whole} frames, {words}"
