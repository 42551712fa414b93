"""What several targets look like and where they were clicked, from the options: `chosen_targets`."""

import math
import shlex
import sys
from typing import Any

import msgspec
import numpy as np

from matchset.app.cli_options import SeveralTargetOptions, source_words
from matchset.app.guidance.explain import explain_refused_click
from matchset.app.guidance.next_command import FailedRun, kept_options
from matchset.app.run_folder import output_folder
from matchset.app.several.options import MOST, TypedOptions, named_color
from matchset.app.target.target_options import (
    LearnedTarget,
    RefusedClickError,
    check_target_options,
    parse_pick,
    target_for,
)
from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.media.video import Video
from matchset.shapes.circle import Circle

_KEPT = {"every": "--all", "most": "--most", "smooth": "--smooth", "on_table": "--on-table"}


class SharingParameters(msgspec.Struct, frozen=True):
    """When two clicks are on one color.

    Parameters
    ----------
    share : float
        Part of the smaller color, weighted by its log-odds, that the other one covers, from which both have one label.
        Higher gives equal balls in different light labels of their own, lower mixes similar colors.
    """

    share: float = 0.5


class PickedTarget(msgspec.Struct, frozen=True):
    """A click on one of several targets.

    Parameters
    ----------
    point : tuple of two floats
        px.
    frame : int
        Where it was clicked.
    label : str
        Of its color.
    radius : float
        What it was taken for, px; 0 if that is not known.
    """

    point: tuple[float, float]
    frame: int
    label: str
    radius: float = 0.0


class ChosenTargets(msgspec.Struct, frozen=True):
    """What to follow.

    Parameters
    ----------
    colors : dict of str to ColorModel
        By label.
    picks : tuple of PickedTarget
    finds : bool
        Whether all that looks like it is followed; else what was clicked alone.
    most : int
        How many at once.
    taken : tuple of Frame
        Frames that were taken from a live source to learn from; they are to be tracked too.
    """

    colors: dict[str, ColorModel]
    picks: tuple[PickedTarget, ...] = ()
    finds: bool = True
    most: int = MOST
    taken: tuple[Frame, ...] = ()

    @property
    def first(self) -> LearnedTarget:
        """The first of it: what is explained where nothing was found."""
        if self.picks:
            pick = self.picks[0]
            return LearnedTarget(self.colors[pick.label], pick.point, pick.frame)
        return LearnedTarget(next(iter(self.colors.values())))


def failed_run(options: TypedOptions, command: str, family: type[Any], kept: tuple[str, ...], live: bool) -> FailedRun:
    """Describe a command that follows several targets, for what is said where it has found nothing."""
    clicked = (options.target.picks or [""])[0]
    kept += kept_options(options.several, _KEPT)
    return FailedRun(command, options.source, options.topic, family, clicked, kept, live, options.view)


def check_targets(options: TypedOptions) -> None:
    """Check what was typed of the targets, before the video is opened (ValueError)."""
    words = shlex.join(source_words(options.source, options.topic, options.view))
    check_target_options(options.target.single, words)
    for text in options.target.picks or ():
        parse_pick(text)


def chosen_targets(video: Video, options: TypedOptions, ball: bool) -> ChosenTargets:
    """Learn what to follow in a video that is about to be read.

    Parameters
    ----------
    video : Video
        Not yet read; a file is opened again for each click.
    options : TypedOptions
    ball : bool
        Whether the shape that is followed is one.
    """
    target = msgspec.structs.replace(options.target, ball=ball)
    named = [named_color(path) for path in target.color or ()]
    most = options.several.most or max(MOST, len(target.picks or ()))
    if any(name for name, _ in named):
        return ChosenTargets({name: ColorModel.load(path) for name, path in named}, most=most)
    colors, picks, taken = dict[str, ColorModel](), list[PickedTarget](), list[Frame]()
    for single in _singles(target):
        learned, frames = target_for(video, single)
        learned.say_notes()
        taken += frames
        label = labelled(colors, learned.color)
        if learned.start is not None:
            radius = (learned.color.circle or (0.0, 0.0, 0.0))[2]
            picks.append(_apart(picks, PickedTarget(learned.start, learned.frame, label, radius)))
    finds = options.several.every or not picks
    return ChosenTargets(colors, tuple(picks), finds, most, tuple(taken))


def chosen_or_explained(video: Video, options: TypedOptions, run: FailedRun) -> ChosenTargets:
    """Return the same; where a click is refused, `why.png` says why before the error does."""
    try:
        return chosen_targets(video, options, run.family is Circle)
    except RefusedClickError as refused:
        explain_refused_click(refused, run, output_folder(options.out, run.command, options.force))
        raise


def _singles(target: SeveralTargetOptions) -> list[SeveralTargetOptions]:
    """Return the options for each click, or the only ones."""
    texts: list[str] | list[None] = target.picks or [None]
    return [msgspec.structs.replace(target, pick=text, picks=None) for text in texts]


def _apart(picks: list[PickedTarget], pick: PickedTarget) -> PickedTarget:
    """Return a click, if it is not on the target of an earlier one."""
    for other in picks:
        near = math.dist(pick.point, other.point) < max(pick.radius, other.radius)
        if near and (pick.frame, pick.label) == (other.frame, other.label):
            places = " and at ".join(f"({each.point[0]:.0f}, {each.point[1]:.0f})" for each in (other, pick))
            raise ValueError(f"two clicks are on one target: at {places}")
    return pick


def labelled(colors: dict[str, ColorModel], color: ColorModel) -> str:
    """Add a color to those that there are, joined with one that is the same; return its label, "1", "2", ..."""
    for label, other in colors.items():
        if shared_part(color, other) >= PARAMETERS.share:
            if not color.gray:
                colors[label] = _joined(other, color)
            print(f"note: this has the color {label}, too", file=sys.stderr)
            return label
    label = str(len(colors) + 1)
    colors[label] = color
    return label


def _joined(one: ColorModel, other: ColorModel) -> ColorModel:
    """Join two clicks on one color; what was around the first is known on, so that balls are searched for by it."""
    joined = one | other
    joined.circle, joined.sample, joined.is_local, joined.note = one.circle, one.sample, one.is_local, one.note
    return joined


def shared_part(one: ColorModel, other: ColorModel) -> float:
    """Return which part of the smaller of two colors the other one covers, 0 ... 1."""
    if one.log_odds.shape != other.log_odds.shape or one.gray != other.gray:
        return 0.0
    first, second = np.maximum(one.log_odds, 0.0), np.maximum(other.log_odds, 0.0)
    smaller = min(float(first.sum()), float(second.sum()))
    return float(np.minimum(first, second).sum()) / smaller if smaller > 0.0 else float(one.gray == other.gray != "")


PARAMETERS = SharingParameters()
