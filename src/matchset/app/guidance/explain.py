"""When a run has found nothing, or hardly anything: `why.png`, words on the terminal, and the next command."""

import sys
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any, Protocol, TextIO, TypeVar

import msgspec

from matchset.app.drawing.picture_file import write_picture
from matchset.app.exit_codes import print_note
from matchset.app.guidance.next_command import FailedRun, next_command
from matchset.app.guidance.rejected import RejectedOutline, best_rejected
from matchset.app.guidance.why_picture import DrawnEvidence, covered, percent, why_picture
from matchset.app.progress import announce_if_slow
from matchset.app.target.target_options import LearnedTarget, RefusedClickError
from matchset.image.color import ColorModel
from matchset.image.frame import Frame

WHY = "why.png"


class ExplainParameters(msgspec.Struct, frozen=True):
    """When a run is explained, and what is said.

    All were chosen by hand; nothing but words depends on them.

    Parameters
    ----------
    few : float
        Share of the frames up to which hardly anything was found. More explains runs in which the ball was away.
    wide : float
        Share of the picture from which a color covers too much: a ball that fills the picture from side to side covers
        half of it or more.
    """

    few: float = 0.1
    wide: float = 0.3


PARAMETERS = ExplainParameters()


class SeenFrame(Protocol):
    """What an `Explainer` needs to know of a frame."""

    @property
    def frame(self) -> Frame | None:
        """The frame; None if it could not be decoded."""
        ...

    @property
    def row(self) -> Any:
        """With `found` and `reason`."""
        ...


Seen = TypeVar("Seen", bound=SeenFrame)


class Explainer:
    """Watches a run and explains it, if it has found nothing or hardly anything.

    Parameters
    ----------
    run : FailedRun
        The command.
    target : LearnedTarget
        What was looked for.
    """

    def __init__(self, run: FailedRun, target: LearnedTarget) -> None:
        self._run, self._target = run, target
        self._lost: Frame | None = None
        self._first: Frame | None = None
        self._reason = ""
        self._frames = self._found = 0

    def watch(self, frames: Iterable[Seen]) -> Iterator[Seen]:
        """Pass frames on; the first that was lost from the click on is kept."""
        for seen in frames:
            self._frames += 1
            self._found += seen.row.found
            self._first = seen.frame if self._first is None and seen.row.found else self._first
            lost = None if seen.row.found else seen.frame
            if self._lost is None and lost is not None and lost.index >= self._target.frame:
                self._lost, self._reason = lost, seen.row.reason
            yield seen

    @property
    def is_wanted(self) -> bool:
        """Whether there is anything to explain."""
        return self._lost is not None and self._found <= PARAMETERS.few * self._frames

    def explain(self, folder: Path, out: TextIO) -> None:
        """Write `why.png` into a folder, and what to do next to a terminal; where enough was found, only a doubt."""
        if not self.is_wanted or self._lost is None:
            self._doubt()
            return
        with announce_if_slow("looking for the reason ..."):
            image, color = self._lost.image, self._target.color
            click = self._target.start if self._target.frame == self._lost.index else None
            rejected = best_rejected(image, self._run.family, color, click)
            words = _words(self._lost, self._reason, color, rejected)
            picture = why_picture(
                f"frame {self._lost.index}", image, color, DrawnEvidence(rejected and rejected.shape, click), words
            )
            write_picture(folder / WHY, picture)
            advice = next_command(self._run, self._lost)
        _print(words, folder / WHY, advice, out)

    def _doubt(self) -> None:
        """Say so if a color that nobody clicked is that of much else: what was followed need not be the ball."""
        if self._first is None or self._target.start is not None or self._target.color.gray:
            return
        share = covered(self._first.image, self._target.color)
        if share > PARAMETERS.wide:
            where = f"the color covers {percent(100.0 * share)} of frame {self._first.index}"
            doubt = "unless the ball does, something else may have been followed: narrow the color, or click the ball"
            print_note(f"{where}; {doubt} (--pick X,Y)")


def explain_refused_click(refused: RefusedClickError, run: FailedRun, folder: Path) -> None:
    """Write `why.png` for a click whose color was refused, and what to do next to stderr."""
    words = [f"frame {refused.frame.index}: {refused}"]
    shown = DrawnEvidence(None, refused.click)
    write_picture(folder / WHY, why_picture(f"frame {refused.frame.index}", refused.frame.image, None, shown, words))
    _print([], folder / WHY, next_command(run, refused.frame), sys.stderr)


def _words(lost: Frame, reason: str, color: ColorModel, rejected: RejectedOutline | None) -> list[str]:
    """Say what the tracker said, what the color covers, and which outline was rejected."""
    share = covered(lost.image, color)
    covers = f"the color covers {percent(100.0 * share)} of frame {lost.index}"
    if share > PARAMETERS.wide:
        covers += ": narrow it"
    elif share == 0.0:
        covers = f"nothing in frame {lost.index} has this color: choose another"
    words = [f"frame {lost.index}: {reason}", covers]
    if rejected is None:
        return [*words, "no outline was found in it that could be fitted"]
    x, y = rejected.shape.state[:2].tolist()
    size = float(type(rejected.shape).half_width(rejected.shape.state))
    where = f"at ({x:.0f}, {y:.0f}), with a radius of {size:.0f} px"
    return [*words, f"the best outline (dashed), {where}, was rejected: {rejected.reason}"]


def _print(words: list[str], picture: Path, advice: tuple[str, str], out: TextIO) -> None:
    for line in words:
        print(f"why: {line}", file=out)
    print(f"look at it: {picture}", file=out)
    print(f"{advice[0]}. Type:\n\n  {advice[1]}", file=out)
