"""Finds a ball that was lost: `LostBall`.

Places are where the ball should be or was seen last, where a disc of its color stands out, and where the boundary of
its color votes for a circle. The network of discs judges them (`image/disc_network`): to its log-odds what is known of
place, size and color is added. The likeliest disc is the prior of a fit to its edge points; where these do not confirm
it, the disc itself counts.
"""

import functools
import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import cv2
import numpy as np
import numpy.typing as npt

from matchset.fitting.soft_region import SoftRegionParameters, find_soft_region
from matchset.fitting.validation import Prior
from matchset.image.color import ColorModel
from matchset.image.disc_network.lab import lab_of
from matchset.image.disc_network.network import Disc, DiscNetwork, NetworkFollowParameters
from matchset.image.disc_network.polar_patch import colors_of
from matchset.numeric.jit import collection_paused
from matchset.shapes.shape import Shape
from matchset.tracking.ball.disc_search import DiscSearch, DiscSearchParameters
from matchset.tracking.ball.distractors import Distractors
from matchset.tracking.ball.judge import NetworkParameters, covariance_of, likeliest
from matchset.tracking.detectors import Detectors
from matchset.tracking.motion import Gate, gate_of, usual_size
from matchset.tracking.parameters import TrackerParameters
from matchset.tracking.track import Acquisition
from matchset.tracking.track_step import TrackStep

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]

SMALL = 64  # format: side of a small picture, px


@functools.cache
@collection_paused()
def precompile_ball() -> None:
    """Run every kernel of a search for a ball once on a small picture, so that no frame waits for the compiler."""
    image, circle = np.zeros((SMALL, SMALL, 3), np.uint8), (0.5 * SMALL, 0.5 * SMALL, 0.25 * SMALL)
    cv2.circle(image, (SMALL // 2, SMALL // 2), SMALL // 4, (255, 255, 255), -1)
    known = colors_of(image, circle)
    DiscNetwork.packaged().lead(image, [circle], NetworkFollowParameters(), known)
    find_soft_region(image, circle, SoftRegionParameters())
    lab_of(image)  # OpenCV makes its tables at the first call, in 70 ms
    DiscSearch(DiscSearchParameters()).about(image, np.array((100.0, 0.0, 0.0)), Gate(*circle), float(SMALL))


class _Expected(NamedTuple):
    """What is known of where a lost target is, and of its size.

    Attributes
    ----------
    place : Gate
        Where it should be, or was seen last.
    half_width : float
        As it was seen last, px.
    missed : float
        How many frames ago that was.
    """

    place: Gate
    half_width: float
    missed: float

    def log_odds(self, found: Gate, limits: NetworkParameters) -> float | None:
        """Say what place and size add to the log-odds of a disc; None where it is far too large or small.

        The place is one of as many as there are about as far off, and the longer it was not seen the less is known.
        """
        growth = abs(math.log(found.half_width / self.half_width))
        window = math.log(limits.growth) * (1.0 + (self.missed - 1.0) / limits.grown)
        if growth > min(window, math.log(limits.returned)):
            return None
        away = (self.place.distance(found) / self.half_width) ** 2 + ((self.missed - 1.0) / limits.forgotten) ** 2
        return -min(0.5 * math.log1p(away), limits.anywhere)


class LostBall:
    """Remembers what a ball is like while it is seen, and finds it once it is not.

    Parameters
    ----------
    step : TrackStep
    parameters : TrackerParameters
    detectors : Detectors
        Their searchers propose circles.

    Attributes
    ----------
    seen : bool
        Whether the outline of the target was seen.
    """

    def __init__(self, step: TrackStep[Any], parameters: TrackerParameters, detectors: Detectors[Any]) -> None:
        self._step, self._parameters, self._detectors = step, parameters, detectors
        self._search, self._others = DiscSearch(parameters.disc_search), Distractors(parameters.others)
        self._color: Floats | None = None
        self._half_width, self._pictures = 0.0, 0
        self.seen = False
        if step.outlines.is_disc and parameters.network.used:
            precompile_ball()

    def forget(self, color: ColorModel) -> None:
        """Be as one is that has seen nothing but what the color was learned from.

        Parameters
        ----------
        color : ColorModel
        """
        self._step.outlines.network.know(color.sample)
        self._search.forget()
        self._others.forget()
        self.seen, self._color, self._half_width, self._pictures = False, None, 0.0, 0

    def remember(self, image: Image, seen: Gate) -> None:
        """Remember the color and the size of a target whose outline is seen.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        seen : Gate
            Where it is.
        """
        self.seen = True
        if self._step.outlines.is_disc:
            self._color = self._step.outlines.network.median_color(image, (seen.x, seen.y, seen.half_width))
            self._half_width = seen.half_width

    def notice_others(self, image: Image, color: ColorModel, seen: Gate, time: float) -> None:
        """Look at a part of the picture for what looks like the ball, while that is seen: later it is not the ball.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        color : ColorModel
        seen : Gate
            Where the ball is.
        time : float
            Of the picture, s.
        """
        if not (self.knows() and self._step.outlines.judges(color)):
            return
        network, limits = self._step.outlines.network, self._others.limits
        network.left = min(network.left, limits.looks)
        known = self._others.places(seen)[: limits.looks // 2]
        self._search.begin_picture()
        anywhere = self._anywhere(image, color, seen)
        places = [*known, *(each for each in anywhere if self._others.is_clear(each, seen))]
        for odds, disc in self._alike(image, color, places):
            if odds > limits.least:
                self._others.notice(Gate(*disc.circle), seen, time)
        for place in places:
            self._search.in_vain(place)

    def is_other(self, place: Gate, time: float) -> bool:
        """Whether what is at a place was there while the ball was elsewhere."""
        return self._others.is_one(place, time)

    def relight(self, gains: Floats) -> None:
        """Remember the color, and what the network knows of it, in another light.

        Parameters
        ----------
        gains : ndarray of shape (channels,), float64
            By which the channels of all pixels were multiplied.
        """
        self._step.outlines.network.relight(gains)
        if self._color is None:
            return
        pixel = cv2.cvtColor(self._color.astype(np.float32).reshape(1, 1, 3), cv2.COLOR_Lab2BGR)
        changed = np.clip(pixel * gains.astype(np.float32), 0.0, 1.0)
        self._color = cv2.cvtColor(changed, cv2.COLOR_BGR2Lab).reshape(3).astype(np.float64)

    def elsewhere(self, color: ColorModel, unknown: bool) -> Prior:
        """Say what is known of a shape that is not where somebody clicked, nor where the target is expected.

        A color that was learned against what is next to the target may be anywhere else.

        Parameters
        ----------
        color : ColorModel
        unknown : bool
            Whether nothing is known of it in any case.
        """
        return Prior.NONE if unknown or (color.is_local and not self.seen) else Prior.PRESENT

    def knows(self) -> bool:
        """Whether this is a ball whose color was seen before: otherwise nothing can be found here."""
        return self._color is not None and self._step.outlines.is_disc

    def confirms(self, image: Image, color: ColorModel, state: Floats | None) -> bool:
        """Whether the network sees a ball of the target's color where edges show one.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        color : ColorModel
        state : ndarray or None
            What edges show; None for nothing.
        """
        if state is None:
            return False
        place = gate_of(self._step.fitter.family, state)
        least, same = self._step.outlines.network.limits.lost, self._search.are_same
        alike = self._alike(image, color, [place])
        return any(odds > least and same(place, Gate(*disc.circle)) for odds, disc in alike)

    def find(
        self, image: Image, color: ColorModel, last: Gate, expected: Gate | None, time: float, interval: float
    ) -> bool:
        """Find the ball, and leave the workspace as its fit made it; whether it was found.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        color : ColorModel
        last : Gate
            Where the target was seen last.
        expected : Gate or None
            Where it should be, if it was seen lately.
        time : float
            Of the picture, s.
        interval : float
            Since the frame before, s.
        """
        if not self._step.without_outline:  # what approaches is larger than when its color was remembered
            self._half_width = last.half_width
        prior = _Expected(expected or last, self._half_width, self._step.missed(time, interval))
        near = [last] if expected is None else [expected, last]
        best = self._likeliest(image, color, near, prior, time)
        if best is None:
            return False
        disc, network = best[1], self._step.outlines.network
        if disc.log_odds > network.limits.renewed:
            self._color, self._half_width = network.median_color(image, disc.circle), disc.circle[2]
        disc = self._step.outlines.refined(image, disc)
        size = None if expected is None else usual_size(self._step.fitter.work, time, disc.circle)
        if size is not None:
            disc = network.of_size(disc, size)
        return self._take(image, color, (best[0], disc), (time, expected is None), network.limits.renewed)

    def _likeliest(
        self, image: Image, color: ColorModel, near: Sequence[Gate], prior: _Expected, time: float
    ) -> tuple[float, Disc] | None:
        """Likeliest disc near some places, or where something stands out, if its log-odds are enough."""
        search, network, own = self._search, self._step.outlines.network, self._color
        assert own is not None
        search.begin_picture()
        around = prior.place._replace(half_width=self._half_width)
        here = search.about(image, own, around, search.limits.reach * prior.missed * self._half_width)
        standing_out = [*map(self._larger, here), *self._anywhere(image, color, prior.place)]
        likely = self._likely(image, color, [*near, *standing_out], prior, time)
        for place in standing_out:
            if all(place.distance(Gate(*disc.circle)) > place.half_width for _, disc in likely):
                search.in_vain(place)
        best = max(likely, key=lambda each: each[0], default=None)
        return best if best is not None and best[0] > network.limits.lost else None

    def _anywhere(self, image: Image, color: ColorModel, around: Gate) -> list[Gate]:
        """Places anywhere where a disc stands out, by turns by its mean color or by votes for its outline."""
        if not self._parameters.search.whole_frame:
            return []
        own = self._color
        assert own is not None
        self._pictures += 1
        if self._pictures % 2 == 0:
            around = around._replace(half_width=self._half_width)
            return [*map(self._larger, self._search.about(image, own, around, float(max(image.shape))))]
        votes = self._detectors.suited(image, self._half_width).searcher.candidates(image, color)
        return [Gate(*vote[:3]) for vote in votes[: self._search.limits.most].tolist()]

    def _larger(self, place: Gate) -> Gate:
        """Place from whose circle the network is led: the size remembered may be that of the lit part."""
        return place._replace(half_width=self._search.limits.larger * place.half_width)

    def _likely(
        self, image: Image, color: ColorModel, places: Sequence[Gate], prior: _Expected, time: float
    ) -> list[tuple[float, Disc]]:
        """Discs that the network sees about some places; before each, the log-odds that it is the target."""
        likely, limits = list[tuple[float, Disc]](), self._step.outlines.network.limits
        for odds, disc in self._alike(image, color, places):
            there = Gate(*disc.circle)
            known = None if self._others.is_one(there, time) else prior.log_odds(there, limits)
            if known is not None:
                likely.append((odds + known, disc))
        return likely

    def _alike(self, image: Image, color: ColorModel, places: Sequence[Gate]) -> list[tuple[float, Disc]]:
        """Discs that the network sees about some places; before each, the log-odds of a ball of the target's color."""
        judge, own, starts = self._step.outlines.network, self._color, list[Gate]()
        assert own is not None
        for place in places:  # of places that are nearly the same one is enough
            if not any(self._search.are_same(place, each) for each in starts):
                starts.append(place)
        discs = judge.discs(image, [np.array(each[:3]) for each in starts], searched=True)
        return [(odds, disc) for disc in discs if (odds := judge.alike(image, disc, own, color)) is not None]

    def _take(
        self, image: Image, color: ColorModel, found: tuple[float, Disc], when: tuple[float, bool], sure: float
    ) -> bool:
        """Take a disc, after its log-odds of being the target, unless it is not sure and the region is another shape.

        If the edge points around it confirm it, the fit to them is taken.
        """
        step, (odds, disc) = self._step, found
        there = Gate(*disc.circle)
        if step.outlines.fit_lost(image, color, disc):
            step.take_fit(*when)
        elif disc.log_odds <= sure and step.outlines.is_other_shape(
            image, step.fitter.family.from_coarse(*there).state
        ):
            return False
        else:
            step.take_disc(image, color, there, covariance_of(disc), when)
        step.acquired = Acquisition(when[0], odds)
        return True

    def begin(self, image: Image, color: ColorModel, clicked: Shape, time: float) -> bool:
        """Begin with a disc that the network sees at the click; whether there is one.

        Parameters
        ----------
        image, color, time
            See `find`.
        clicked : Shape
            Circle around the click.
        """
        step = self._step
        if not step.outlines.is_disc or color.sample is None:
            return False
        network = step.outlines.network
        limits = network.limits
        disc = likeliest(network.discs(image, [clicked.state]), limits.sure, limits.same)
        if disc is None:
            return False
        self._color, self._half_width = network.median_color(image, disc.circle), disc.circle[2]
        return self._take(image, color, (disc.log_odds, disc), (time, True), limits.clicked)
