"""Which searches a frame is worth, for what nobody follows yet and for what is hidden: `Searches`."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from matchset.image.color import ColorModel
from matchset.image.frame import Frame, channels_last
from matchset.shapes.circle import Circle
from matchset.tracking.many.motion_bank import Predicted
from matchset.tracking.many.parameters import MultiTrackerParameters
from matchset.tracking.many.searching.disc_search import DiscSearch, Sought
from matchset.tracking.many.searching.strip_search import STRIPS, StripSearch
from matchset.tracking.many.searching.unexplained import precompile_unexplained, unexplained
from matchset.tracking.many.sightings import Sighting, is_inside, sighting_of
from matchset.tracking.many.tracklet import Followed, Tracklet
from matchset.tracking.motion import Gate
from matchset.tracking.track import Track

Image = npt.NDArray[np.uint8]


class Searches:
    """The searches of a crowd, one for each color.

    Balls whose color was clicked are searched for in the whole picture, as soon as there is more of their color than
    those that are known explain; other shapes strip by strip.

    Parameters
    ----------
    families : mapping of str to type
        By label.
    colors : mapping of str to ColorModel
        By label.
    parameters : MultiTrackerParameters
    """

    def __init__(
        self, families: Mapping[str, type[Any]], colors: Mapping[str, ColorModel], parameters: MultiTrackerParameters
    ) -> None:
        self._colors = colors
        self._limits = parameters
        self._strips = {
            label: StripSearch(families[label], color, parameters.search) for label, color in colors.items()
        }
        self._discs = {
            label: DiscSearch(color, parameters.points, parameters.discs)
            for label, color in colors.items()
            if families[label] is Circle and color.sample is not None
        }
        if self._discs:
            precompile_unexplained()
        self._striped = [label for label in colors if label not in self._discs]
        self._frames = 0
        self._turn = 0
        self._left_over = dict.fromkeys(self._discs, 0.0)
        self._next = dict.fromkeys(self._discs, 0)  # frames in which a search is due in any case
        self._rest = dict.fromkeys(self._discs, 0)

    @property
    def doubtful(self) -> list[Track[Any]]:
        """What the last search of each color saw that may be a ball, and was not taken for one."""
        return [track for search in self._discs.values() for track in search.doubtful]

    def at(self, frame: Frame, label: str, point: tuple[float, float], known: Sequence[Gate]) -> list[Track[Any]]:
        """Shapes of a label near a point, px."""
        return self._strips[label].near(frame, Gate(*point, 0.0), known)

    def search(
        self,
        frame: Frame,
        predicted: Predicted,
        unseen: tuple[Sequence[Followed], Sequence[Tracklet]],
        known: Sequence[Sighting],
        *,
        finds: bool,
    ) -> list[Sighting]:
        """Search for what nobody follows, and a quarter of the image around one that is hidden.

        Parameters
        ----------
        frame : Frame
        predicted : Predicted
        unseen : (sequence of Followed, sequence of Tracklet)
            Targets that were hidden before this frame, and tracklets that ended in it.
        known : sequence of Sighting
            What is seen.
        finds : bool
            Whether new targets are searched for.
        """
        hidden = unseen[0]
        places = [each.place for each in known]
        found = list[Sighting]()
        self._frames += 1
        if finds:
            found += self._new_discs(frame, predicted, unseen, known)
        found += self._strip(frame, hidden, places, finds=finds)
        if hidden:
            sought = min(hidden, key=lambda each: (each.identity is not None, each.sought, -each.seen))
            sought.sought = frame.time
            place, _ = predicted.likeliest(sought.slot)
            places += [each.place for each in found]
            tracks = self._strips[sought.label].near(frame, place, places)
            found += [self._sighting(track, sought.label)._replace(sure=False) for track in tracks]
        return found

    def _new_discs(
        self,
        frame: Frame,
        predicted: Predicted,
        unseen: tuple[Sequence[Followed], Sequence[Tracklet]],
        known: Sequence[Sighting],
    ) -> list[Sighting]:
        """Balls of all colors whose search is due."""
        image = channels_last(frame.image)
        found = list[Sighting]()
        for label, search in self._discs.items():
            places = [each.place for each in (*known, *found)]
            sizes = [each.place.half_width for each in known if each.label == label]
            radius = search.smallest(sizes)
            seen = self._count(image, label, places, radius)
            more = max(seen - self._left_over[label], 0.0)
            expected = self._expected(frame, predicted, unseen, label)
            if not (expected or self._is_due(label, more, radius)):
                self._left_over[label] += self._limits.discs.follows * min(seen - self._left_over[label], 0.0)
                continue
            missing = more * self._step(radius) ** 2 / (math.pi * search.usual(sizes) ** 2)
            fresh = [
                self._sighting(track, label) for track in search.update(frame, Sought(places, sizes, expected, missing))
            ]
            found += fresh
            places += [each.place for each in fresh]
            self._left_over[label] = self._count(image, label, places, radius)
            self._wait(label, bool(fresh or expected), radius)
        return found

    def _wait(self, label: str, found: bool, radius: float) -> None:
        """Wait with the next search in any case: twice as long as before where nothing was found, and no ball is left.

        Parameters
        ----------
        label : str
        found : bool
            Whether anything was found, or expected.
        radius : float
            Of the smallest ball, px.
        """
        limits = self._limits.discs
        soon = found or self._left_over[label] > self._least(radius)
        self._rest[label] = limits.again if soon else min(max(2 * self._rest[label], limits.again), limits.most_again)
        self._next[label] = self._frames + self._rest[label]

    def _expected(
        self, frame: Frame, predicted: Predicted, unseen: tuple[Sequence[Followed], Sequence[Tracklet]], label: str
    ) -> list[Gate]:
        """Places in the picture where balls of a color are expected that were lost, those that were lost last first."""
        hidden, ended = unseen
        late = frame.time - self._limits.expected
        lost = [each for each in hidden if each.label == label and each.seen > late]
        slots = [each.hypotheses[each.owner()].slot for each in ended if each.label == label]
        slots += [each.slot for each in sorted(lost, key=lambda each: -each.seen)]
        places = [predicted.likeliest(slot)[0] for slot in slots]
        return [place for place in places if is_inside(place, frame.image)][: self._limits.probes]

    def _is_due(self, label: str, more: float, radius: float) -> bool:
        """Whether more of a color is seen than the balls that are known explain, or it is time to look again."""
        limits = self._limits.discs
        if self._frames <= limits.settled or self._frames >= self._next[label]:
            return True
        return more > self._least(radius)

    def _least(self, radius: float) -> float:
        """Cells of the grid, as a part of the smallest ball, from which more of its color is noticed."""
        return self._limits.discs.noticed * math.pi * (radius / self._step(radius)) ** 2

    def _count(self, image: Image, label: str, places: Sequence[Gate], radius: float) -> int:
        """Pixels of the grid with a color that no place explains."""
        color = self._colors[label]
        if color.channels != image.shape[2]:
            return 0
        known = np.array(places, np.float64).reshape(-1, 3)
        known[:, 2] *= self._limits.discs.explained
        return unexplained(image, color, known, self._step(radius))

    def _step(self, radius: float) -> int:
        return max(int(radius / self._limits.discs.radius_cells), 1)

    def _strip(
        self, frame: Frame, hidden: Sequence[Followed], places: Sequence[Gate], *, finds: bool
    ) -> list[Sighting]:
        """Shapes in one strip: of every label by turns while new ones are looked for, else of one that is gone."""
        limits = self._limits
        labels = self._striped
        if finds and labels:
            if hidden or self._frames % limits.period == 0 or self._frames < STRIPS * len(labels):
                label = labels[self._turn]
                self._turn = (self._turn + 1) % len(labels)
                return [self._sighting(track, label) for track in self._strips[label].update(frame, places)]
        elif not finds:
            gone = [each for each in hidden if frame.time - each.seen > limits.searched]
            if gone:
                label = gone[0].label
                return [self._sighting(track, label) for track in self._strips[label].update(frame, places)]
        return []

    def _sighting(self, track: Track[Any], label: str) -> Sighting:
        return sighting_of(track, self._limits.motion.center_sigmas, label)
