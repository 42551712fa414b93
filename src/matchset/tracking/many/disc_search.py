"""Finds balls of one color that nobody follows yet, anywhere in a picture: `DiscSearch`.

It is `detect` with what is known of the crowd: places where the color stands out are looked at, in the sizes of the
balls that are followed, and not where one of these is. A fit to the edge points there that is clear needs no other
witness; of the others the network says where a disc is, and one weighted sum whether that is one of the balls
(`DiscDetector`). A picture costs no more than so many looks of the network; what was seen to be none of the balls is
not looked at again for some pictures, so that other places have their turn.
"""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.fitting.fitter import Fitter
from matchset.fitting.validation import Prior
from matchset.fitting.workspace import SearchWindow
from matchset.image.color import ColorModel
from matchset.image.disc_network.patch_format import Circle3
from matchset.image.frame import Frame, channels_last
from matchset.shapes.circle import Circle
from matchset.tracking.ball.disc_detector import DiscDetector, DiscDetectorParameters
from matchset.tracking.ball.discs import are_same
from matchset.tracking.ball.judge import NetworkParameters
from matchset.tracking.ball.places.color_places import ColorPlaceParameters
from matchset.tracking.compiled_step import tracking_fitter
from matchset.tracking.detector import track_of
from matchset.tracking.motion import Gate
from matchset.tracking.track import Track

Image = npt.NDArray[np.uint8]


class DiscSearchParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How balls that nobody follows are found.

    Parameters
    ----------
    looks : int
        Looks of the network in a picture: more finds more balls at once, each takes 0.4 ms.
    first_looks : int
        The same in the first picture.
    scales : tuple of float
        Sizes that are looked for by turns, in the usual size of those that are known.
    least_px : float
        Least radius that is looked for, px.
    again : int
        Pictures after which a place is looked at again at which no ball was seen: less finds one sooner that has come
        there, more leaves more looks to other places.
    covered, vain : float
        Share of its radius within which no place is proposed, around a ball that is known and around a place that was
        looked at in vain.
    same_distance : float
        Discs nearer to one that is known than so many of the larger radius are that one.
    range_share, least_range_px : float
        Search range of the fit at a place, in its radius and at least px.
    clear_msac : float
        MSAC score of a confirmed fit from which the network is not asked.
    discs : DiscDetectorParameters
        How places are proposed, and which discs are balls.
    """

    looks: int = 8
    first_looks: int = 200
    scales: tuple[float, ...] = (1.0, 0.6, 1.0, 1.6)
    least_px: float = 3.0
    again: int = 6
    size_step: float = 1.3
    sizes: int = 3
    same_place: float = 0.4
    covered: float = 0.8
    vain: float = 0.5
    same_distance: float = 0.7
    range_share: float = 0.3
    least_range_px: float = 2.0
    clear_msac: float = 0.7
    settled: int = 4
    noticed: float = 0.3
    explained: float = 1.2
    radius_cells: float = 2.0
    discs: DiscDetectorParameters = DiscDetectorParameters(
        compared=30,
        network=NetworkParameters(moved=1.5),
        places=ColorPlaceParameters(lightness=30.0, chroma=15.0, most=3, least=0.05, cells=20_000),
    )


class Found(NamedTuple):
    """A ball that was found.

    Attributes
    ----------
    log_odds : float
        That it is one.
    track : Track
    """

    log_odds: float
    track: Track[Circle]


class DiscSearch:
    """Finds balls of one color that nobody follows yet.

    Parameters
    ----------
    color : ColorModel
        Learned at a click: with what was around the ball.
    points : int
        Lines across the outline of a ball.
    parameters : DiscSearchParameters, optional
    """

    def __init__(self, color: ColorModel, points: int, parameters: DiscSearchParameters | None = None) -> None:
        assert color.sample is not None
        self.parameters = parameters or DiscSearchParameters()
        self._color = color
        self._fitter: Fitter[Any] = tracking_fitter(Circle, points)
        self.doubtful = list[Track[Any]]()
        self._detector = DiscDetector(self._fitter, color, self.parameters.discs)
        self._clicked = color.sample.radius
        self._searched = 0
        self._in_vain = list[tuple[Circle3, int]]()

    def smallest(self, sizes: Sequence[float]) -> float:
        """Radius of the smallest ball that is looked for, px, if those of some radii are known."""
        limits = self.parameters
        return max(min(limits.scales) * (float(np.median(sizes)) if sizes else self._clicked), limits.least_px)

    def update(
        self, frame: Frame, known: Sequence[Gate], sizes: Sequence[float] = (), lost: Sequence[Gate] = ()
    ) -> list[Found]:
        """Search a picture.

        Parameters
        ----------
        frame : Frame
        known : sequence of Gate
            What is followed already.
        sizes : sequence of float
            Radii of those of them that have the color that is looked for, px.
        lost : sequence of Gate
            Where balls are expected that were seen lately.

        Returns
        -------
        list of Found
            Balls that are none of these, those with a clear outline first.
        """
        limits, image = self.parameters, channels_last(frame.image)
        self._fitter.take_rows(frame.rows)
        self._in_vain = [each for each in self._in_vain if self._searched - each[1] < limits.again]
        found, unclear = list[Found](), list[Circle3]()
        taken = list(known)
        first = self._searched == 0
        for place in self._places(image, known, sizes, lost, everything=first):
            outline = self._outlined(image, place, frame)
            if outline is None:
                unclear.append(place)
            elif not _is_known(outline.track.shape, taken, limits.same_distance):
                found.append(outline)
                taken.append(Gate(*outline.track.shape.state[:3].tolist()))
        unclear = [
            place for place in unclear if not _is_known(Circle(*place), taken[len(known) :], limits.same_distance)
        ]
        discs = self._detector.led(image, unclear, limits.first_looks if first else limits.looks)
        fresh = [disc for disc in discs if not _is_known(Circle(*disc.circle), taken, limits.same_distance)]
        self.doubtful = []
        for log_odds, spread in self._detector.judged(image, fresh):
            track = track_of(self._fitter, None, frame.time, spread, pixel_aspect=frame.pixel_aspect)
            if log_odds > limits.discs.asked:
                found.append(Found(log_odds, track))
            else:
                self.doubtful.append(track)
        shapes = [each.track.shape for each in found]
        self._in_vain += [
            (place, self._searched)
            for place in unclear
            if all(math.dist(place[:2], (shape.x, shape.y)) > place[2] for shape in shapes)
        ]
        self._searched += 1
        self._fitter.forget()
        return found

    def _places(
        self, image: Image, known: Sequence[Gate], sizes: Sequence[float], lost: Sequence[Gate], *, everything: bool
    ) -> list[Circle3]:
        """Circles where the color stands out; of all sizes in the first picture, then of one of them by turns."""
        limits = self.parameters
        usual = float(np.median(sizes)) if sizes else self._clicked
        turn, which = divmod(self._searched, len(limits.scales))
        covered = [(each.x, each.y, limits.covered * each.half_width) for each in known]
        covered += [(x, y, limits.vain * radius) for (x, y, radius), _ in self._in_vain]
        scales = dict.fromkeys(limits.scales) if everything else (limits.scales[which],)
        radii = list[float]()
        for radius in [*(each.half_width for each in lost), *(scale * usual for scale in scales)]:
            radius = max(radius, limits.least_px)
            if all(abs(math.log(radius / other)) > math.log(limits.size_step) for other in radii):
                radii.append(radius)
        places = [(each.x, each.y, each.half_width) for each in lost]
        for radius in radii[: None if everything else limits.sizes]:
            for place in self._detector.places(image, radius, turn, covered):
                if not any(are_same(place, other, limits.same_place) for other in places):
                    places.append(place)
        return places

    def _outlined(self, image: Image, place: Circle3, frame: Frame) -> Found | None:
        """Ball at a place if its outline is clear."""
        limits, fitter = self.parameters, self._fitter
        reach = max(limits.range_share * place[2], limits.least_range_px)
        fitter.forget()
        state = Circle.from_coarse(*place).state
        estimate = fitter.fit(image, self._color, state, SearchWindow(reach))
        if not estimate.is_fitted or estimate.fit.msac_score < limits.clear_msac:
            return None
        estimate = fitter.weigh(estimate, image, self._color)
        if fitter.validate_detection(estimate, Prior.NONE):
            return None
        track = track_of(fitter, None, frame.time, pixel_aspect=frame.pixel_aspect)
        return Found(estimate.evidence or 0.0, track)


def _is_known(circle: Circle, others: Sequence[Gate], same: float) -> bool:
    """Whether a circle is one of the others, or inside one, or around one."""
    return any(
        math.hypot(circle.x - each.x, circle.y - each.y) < same * max(circle.radius, each.half_width) for each in others
    )
