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
from matchset.tracking.many.sightings import Sighting, sighting_of
from matchset.tracking.many.tracklet import Followed
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
        self._left_over = dict.fromkeys(self._discs, 0)

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
        unseen: tuple[Sequence[Followed], Sequence[Followed]],
        known: Sequence[Sighting],
        *,
        finds: bool,
    ) -> list[Sighting]:
        """Search for what nobody follows, and a quarter of the image around one that is hidden.

        Parameters
        ----------
        frame : Frame
        predicted : Predicted
        unseen : (sequence of Followed, sequence of Followed)
            Targets that were hidden before this frame, and those that were lost in it.
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
            found += self._new_discs(frame, predicted, [*unseen[1], *hidden], known)
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
        self, frame: Frame, predicted: Predicted, hidden: Sequence[Followed], known: Sequence[Sighting]
    ) -> list[Sighting]:
        """Balls of all colors whose search is due."""
        image = channels_last(frame.image)
        found = list[Sighting]()
        for label, search in self._discs.items():
            of_color = [each for each in hidden if each.label == label]
            places = [each.place for each in (*known, *found)]
            sizes = [each.place.half_width for each in known if each.label == label]
            radius = search.smallest(sizes)
            seen = self._count(image, label, places, radius)
            more = max(seen - self._left_over[label], 0)
            self._left_over[label] = min(self._left_over[label], seen)
            if not (of_color or self._is_due(more, radius)):
                continue
            lost = [each for each in of_color if frame.time - each.seen < self._limits.expected]
            lost = sorted(lost, key=lambda each: -each.seen)[: self._limits.probes]
            expected = [predicted.likeliest(each.slot)[0] for each in lost]
            missing = more * self._step(radius) ** 2 / (math.pi * search.usual(sizes) ** 2)
            fresh = [
                self._sighting(track, label) for track in search.update(frame, Sought(places, sizes, expected, missing))
            ]
            found += fresh
            places += [each.place for each in fresh]
            self._left_over[label] = self._count(image, label, places, radius)
        return found

    def _is_due(self, more: int, radius: float) -> bool:
        """Whether more of a color is seen than the balls that are known explain, or it is time to look again."""
        limits = self._limits.discs
        if self._frames <= limits.settled or self._frames % limits.again == 0:
            return True
        return more > limits.noticed * math.pi * (radius / self._step(radius)) ** 2

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
