"""First clicks in a recorded video of which nothing was found yet, and when they are given up: `Trials`."""

import time
from collections.abc import Iterable
from typing import NamedTuple

import msgspec

from matchset.live.files.file_target import FileTarget
from matchset.live.files.run import TrackingRun
from matchset.live.targets.alike import on_one
from matchset.live.targets.clicks import AGAIN
from matchset.live.targets.messages import Begin
from matchset.live.targets.target import BesideParameters, is_beside
from matchset.tracking.track import Track


class TrialParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How long something clicked may not be found.

    Parameters
    ----------
    frames : int
        From the click on; the target must be found in one of them, or the click was on nothing. Chosen by hand.
    patience : float
        How long trying them may take, s; the frame of the click is tried in any case. Longer: a ball that is hidden in
        that frame is still found in large pictures; and a wrong click is refused later. Chosen by hand: with what
        learning a color takes, within a second.
    beside : BesideParameters
    """

    frames: int = 30
    patience: float = 0.6
    beside: BesideParameters = BesideParameters()


class Trial(NamedTuple):
    """A first click, and since when it is tried, s."""

    begin: Begin
    since: float


class Trials(dict[int, Trial]):
    """The trials by the numbers of their targets. For one thread.

    Parameters
    ----------
    parameters : TrialParameters, optional
    """

    def __init__(self, parameters: TrialParameters | None = None) -> None:
        super().__init__()
        self._parameters = parameters or TrialParameters()

    def verdict(self, run: TrackingRun, others: Iterable[FileTarget] = ()) -> str | None:
        """Judge a target after a step of its way forward; it must be none of the others.

        Returns
        -------
        str or None
            Why its click was on nothing; empty: it is found; None: it is not known yet.
        """
        trial, target, place = self[run.target.number], run.target, run.place - 1
        answer = target.answer(place)
        if isinstance(answer, Track):
            if is_beside(trial.begin, answer, answer.time - run.began, self._parameters.beside):
                return f"the {target.shape} that was found is not where you clicked. {AGAIN}"
            for other in others:
                known = other.answer(place)
                if other is not target and isinstance(known, Track) and on_one(known, answer):
                    return f"that is {other.name}, which is followed already"
            return ""
        late = time.monotonic() - trial.since > self._parameters.patience
        if answer is None or not (late or run.place - run.click >= self._parameters.frames):
            return None
        return f"no {target.shape} was found there: {answer.reason}. {AGAIN}"
