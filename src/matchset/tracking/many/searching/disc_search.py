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
from matchset.tracking.many.sightings import is_near_one, place_of
from matchset.tracking.motion import Gate
from matchset.tracking.track import Track

Image = npt.NDArray[np.uint8]


class DiscSearchParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How balls that nobody follows are found.

    Chosen by hand on composed crowds, seeds 600 to 603, and on a program of balls thrown on a table that is not in this
    repository (docs/log/tracking.md#real-crowds).

    Parameters
    ----------
    places : int
        Places of each size that are looked at in a picture while nothing is missing: more finds small ones beside
        large ones sooner, and leaves fewer looks to each.
    most_places : int
        The same where as many balls are missing, by the color that nothing explains.
    first_places : int
        The same in the first picture.
    looks : int
        Looks of the network in a picture while nothing is missing; it grows with the places. More finds more balls at
        once, each takes 0.4 ms.
    first_looks : int
        The same in the first picture.
    scales : tuple of float
        Sizes that are looked for by turns, in the usual size of those that are followed.
    sizes : int
        Sizes that are looked for in a picture at most: those of lost balls come first.
    size_step : float
        Factor between sizes from which both are looked for.
    kind_step : float
        Factor between the sizes of two balls, with no other ball between them, from which they are of two kinds, both
        of which are looked for: less takes equal balls at two distances for two kinds, each of which gets fewer looks.
    kind_balls : int
        How many balls of a size must be followed for it to be a kind: less finds a second one sooner, and lets one
        wrong outline find others like it.
    least_px : float
        Least radius that is looked for, px.
    again : int
        Pictures after which a place is looked at again at which no ball was seen: less finds one sooner that has come
        there, more leaves more looks to other places.
    most_again : int
        A search is due in any case after `again` pictures, and after twice as many each time that nothing is found, up
        to this: less finds sooner what is small or pale, more costs less.
    covered, vain : float
        Share of its radius within which no place is proposed, around a ball that is known and around a place that was
        looked at in vain.
    same_place : float
        Circles that differ by less, in the larger radius, are one place.
    same_distance : float
        Discs nearer to one that is known than so many of the larger radius are that one.
    range_share, least_range_px : float
        Search range of the fit at a place, in its radius and at least px.
    clear_msac : float
        MSAC score of a confirmed fit from which the network is not asked.
    alike, alike_odds : float
        How near to the size of one that is followed a disc must be, as a logarithm, to be one more of these; and the
        log-odds that this is worth.
    expected_near, expected_odds : float
        How near to where a lost ball is expected a disc must be, in half-widths, and what that is worth.
    settled : int
        First pictures, in which a search is always due.
    noticed : float
        Share of the smallest ball's area by which color that nothing explains must have grown for a search to be due:
        less notices balls sooner at the border, more costs less in noise.
    follows : float
        Share by which what was left over follows a picture in which there is less of it: more takes noise for a ball.
    explained : float
        How far the color around a ball that is known is its own, in its radius: its blur and shadow.
    radius_cells : float
        Radius of the smallest ball in steps of the grid on which that color is counted.
    discs : DiscDetectorParameters
        How places are proposed, and which discs are balls.
    """

    places: int = 3
    most_places: int = 8
    first_places: int = 30
    looks: int = 8
    first_looks: int = 200
    scales: tuple[float, ...] = (1.0, 0.6, 1.0, 1.6)
    sizes: int = 3
    size_step: float = 1.3
    kind_step: float = 1.5
    kind_balls: int = 2
    least_px: float = 3.0
    again: int = 6
    most_again: int = 48
    covered: float = 0.8
    vain: float = 0.5
    same_place: float = 0.4
    same_distance: float = 0.7
    range_share: float = 0.3
    least_range_px: float = 2.0
    clear_msac: float = 0.7
    alike: float = 0.15
    alike_odds: float = 1.0
    expected_near: float = 2.0
    expected_odds: float = 2.0
    settled: int = 4
    noticed: float = 0.3
    follows: float = 0.2
    explained: float = 1.2
    radius_cells: float = 2.0
    discs: DiscDetectorParameters = DiscDetectorParameters(
        compared=30,
        network=NetworkParameters(moved=1.5),
        places=ColorPlaceParameters(lightness=30.0, chroma=15.0, least=0.05, cells=40_000),
    )


class Sought(NamedTuple):
    """What is known of a crowd before a picture is searched.

    Attributes
    ----------
    known : sequence of Gate
        What is followed already, of any color.
    sizes : sequence of float
        Radii of those of them that have the color that is looked for, px.
    lost : sequence of Gate
        Where balls of that color are expected that were seen lately.
    missing : float
        How many balls the color that nothing explains would make.
    """

    known: Sequence[Gate]
    sizes: Sequence[float] = ()
    lost: Sequence[Gate] = ()
    missing: float = 0.0


class DiscSearch:
    """Finds balls of one color that nobody follows yet.

    Parameters
    ----------
    color : ColorModel
        Learned at a click: with what was around the ball.
    points : int
        Lines across the outline of a ball.
    parameters : DiscSearchParameters, optional

    Attributes
    ----------
    doubtful : list of Track
        What the last search saw that may be a ball, and was not taken for one.
    """

    def __init__(self, color: ColorModel, points: int, parameters: DiscSearchParameters | None = None) -> None:
        assert color.sample is not None
        self.parameters = parameters or DiscSearchParameters()
        self.doubtful = list[Track[Any]]()
        self._color = color
        self._fitter: Fitter[Any] = tracking_fitter(Circle, points)
        self._detector = DiscDetector(self._fitter, color, self.parameters.discs)
        self._clicked = color.sample.radius
        self._searched = 0
        self._in_vain = list[tuple[Circle3, int]]()

    def usual(self, sizes: Sequence[float]) -> float:
        """Radius that is looked for first, px: the median of those that are known, or that at the click."""
        return float(np.median(sizes)) if sizes else self._clicked

    def smallest(self, sizes: Sequence[float]) -> float:
        """Radius of the smallest ball that is looked for, px."""
        return max(min(self.parameters.scales) * min(self._kinds(sizes)), self.parameters.least_px)

    def _kinds(self, sizes: Sequence[float]) -> list[float]:
        """Radii that are looked for first, px: the median of each group of sizes; of one group only, the usual one."""
        groups = list[list[float]]()
        for size in sorted(sizes):
            if groups and size < self.parameters.kind_step * groups[-1][-1]:
                groups[-1].append(size)
            else:
                groups.append([size])
        kinds = [float(np.median(group)) for group in groups if len(group) >= self.parameters.kind_balls]
        return kinds if len(kinds) > 1 else [self.usual(sizes)]

    def update(self, frame: Frame, sought: Sought) -> list[Track[Any]]:
        """Search a picture.

        Parameters
        ----------
        frame : Frame
        sought : Sought

        Returns
        -------
        list of Track
            Balls that are none of those that are known.
        """
        limits = self.parameters
        image = channels_last(frame.image)
        self._fitter.take_rows(frame.rows)
        self._in_vain = [each for each in self._in_vain if self._searched - each[1] < limits.again]
        most = limits.first_places
        looks = limits.first_looks
        if self._searched:
            most = min(limits.places + round(sought.missing), limits.most_places)
            looks = limits.looks * most // limits.places
        found, unclear = self._clear(frame, self._places(image, sought, most), sought.known)
        taken = [*sought.known, *_places_of(found)]
        discs = self._detector.led(image, unclear, looks)
        fresh = [disc for disc in discs if not is_near_one(Gate(*disc.circle), taken, limits.same_distance)]
        self.doubtful = []
        for log_odds, spread in self._detector.judged(image, fresh, lambda disc: self._prior(disc.circle, sought)):
            track = track_of(self._fitter, None, frame.time, spread, pixel_aspect=frame.pixel_aspect)
            (found if log_odds > limits.discs.asked else self.doubtful).append(track)
        self._note_in_vain(unclear[:looks], found, sought.lost)
        self._searched += 1
        self._fitter.forget()
        return found

    def _clear(
        self, frame: Frame, places: Sequence[Circle3], known: Sequence[Gate]
    ) -> tuple[list[Track[Any]], list[Circle3]]:
        """Balls whose outline is clear at some places, and the places at which none is."""
        same = self.parameters.same_distance
        found = list[Track[Any]]()
        unclear = list[Circle3]()
        for place in places:
            track = self._outlined(frame, place)
            if track is None:
                unclear.append(place)
            elif not is_near_one(place_of(track.shape), [*known, *_places_of(found)], same):
                found.append(track)
        return found, [place for place in unclear if not is_near_one(Gate(*place), _places_of(found), same)]

    def _places(self, image: Image, sought: Sought, most: int) -> list[Circle3]:
        """Circles where lost balls are expected and where the color stands out, so many at most of each size.

        All sizes are looked for in the first picture, then one of them by turns beside those of lost balls.
        """
        limits = self.parameters
        turn, which = divmod(self._searched, len(limits.scales))
        covered = [(each.x, each.y, limits.covered * each.half_width) for each in sought.known]
        covered += [(x, y, limits.vain * radius) for (x, y, radius), _ in self._in_vain]
        scales = dict.fromkeys(limits.scales) if not self._searched else (limits.scales[which],)
        kinds = self._kinds(sought.sizes)
        radii = list[float]()
        for size in [
            *(each.half_width for each in sought.lost),
            *(scale * kind for scale in scales for kind in kinds),
        ]:
            radius = max(size, limits.least_px)
            if all(abs(math.log(radius / other)) > math.log(limits.size_step) for other in radii):
                radii.append(radius)
        places = [(each.x, each.y, each.half_width) for each in sought.lost]
        for radius in radii[: limits.sizes if self._searched else None]:
            for place in self._detector.places(image, radius, turn, covered, most):
                if not any(are_same(place, other, limits.same_place) for other in places):
                    places.append(place)
        return places

    def _note_in_vain(self, places: Sequence[Circle3], found: Sequence[Track[Any]], lost: Sequence[Gate]) -> None:
        """Note places that were looked at in vain, but for those at which a lost ball may be seen in the next one."""
        near = [*_places_of(found), *lost]
        for place in places:
            if all(math.hypot(place[0] - each.x, place[1] - each.y) > place[2] for each in near):
                self._in_vain.append((place, self._searched))

    def _prior(self, circle: Circle3, sought: Sought) -> float:
        """Say what is known beforehand of a disc: others are as large, or it is expected there, in this size."""
        limits = self.parameters
        x, y, radius = circle
        is_alike = any(abs(math.log(radius / size)) < limits.alike for size in sought.sizes)
        is_expected = any(
            math.hypot(x - each.x, y - each.y) < limits.expected_near * each.half_width
            and abs(math.log(radius / each.half_width)) < limits.alike
            for each in sought.lost
        )
        odds = max(limits.alike_odds * is_alike, limits.expected_odds * is_expected)
        if is_alike and len(self._kinds(sought.sizes)) > 1:
            odds -= limits.discs.weights.size * abs(math.log(radius / self._clicked))
        return odds

    def _outlined(self, frame: Frame, place: Circle3) -> Track[Any] | None:
        """Ball at a place if its outline is clear."""
        limits = self.parameters
        fitter = self._fitter
        image = channels_last(frame.image)
        reach = max(limits.range_share * place[2], limits.least_range_px)
        fitter.forget()
        state = Circle.from_coarse(*place).state
        estimate = fitter.fit(image, self._color, state, SearchWindow(reach))
        if not estimate.is_fitted or estimate.fit.msac_score < limits.clear_msac:
            return None
        estimate = fitter.weigh(estimate, image, self._color)
        if fitter.validate_detection(estimate, Prior.NONE):
            return None
        return track_of(fitter, None, frame.time, pixel_aspect=frame.pixel_aspect)


def _places_of(tracks: Sequence[Track[Any]]) -> list[Gate]:
    return [place_of(track.shape) for track in tracks]
