"""Follow several targets at once, in pixels: `MultiTracker`."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from matchset.image.color import ColorModel
from matchset.image.frame import ArrayFrames, Frame, Picture, check_follows
from matchset.media.both_ways import BothWays, PicturesBothWays
from matchset.media.video import Video
from matchset.numeric.arguments import check_kind, checked_count, checked_point
from matchset.numeric.copies import Copied
from matchset.numeric.words import one_line
from matchset.shapes.shape import Shape
from matchset.tracking.many.linking import Linking
from matchset.tracking.many.motion_bank import Predicted
from matchset.tracking.many.observer import Observer
from matchset.tracking.many.parameters import MultiTrackerParameters
from matchset.tracking.many.sightings import sighting_of
from matchset.tracking.many.smoothing.answers import TargetsAt
from matchset.tracking.many.smoothing.smoother import Known, Smoother
from matchset.tracking.many.smoothing.sweep import Click, Sweep
from matchset.tracking.many.target import Target
from matchset.tracking.many.tracklet import Followed
from matchset.tracking.track import Lost, Track

MOST = 100  # format: targets at once

Colors = ColorModel | Sequence[ColorModel] | Mapping[str, ColorModel]
Families = type[Any] | Mapping[str, type[Any]]
Clicks = Sequence[tuple[int, tuple[float, float] | Shape, str | None]]


class MultiTracker(Copied):
    """Follows several targets at once; each keeps its identity while others cross or hide it.

    What is followed from frame to frame without a gap is a tracklet. Where targets touch, so that only one of them is
    seen, or one comes out from behind something, it is in doubt whose a tracklet is. Then the motion of each target
    that it may be is filtered on with it, at constant velocity, in free flight and at rest, and what is likeliest for
    all together is taken (SciPy's `linear_sum_assignment` on log-likelihoods), until nothing else is nearly as good.

    Parameters
    ----------
    family : type, or mapping of str to type
        The family of shapes, `Circle`, `Rectangle`, ...; or one for each label.
    colors : ColorModel, sequence of ColorModel, or mapping of str to ColorModel
        What the targets look like: of one color, of several, or of several with labels. Without labels these are "0",
        "1", ... in their order.
    most : int
        How many are followed at once.
    parameters : MultiTrackerParameters, optional
    finds : bool
        Whether all that looks like the targets is searched for; otherwise only what `add` names is followed.
    fps : float or None
        For plain arrays: their rate, 1/s. None: they have the times at which `update` is called, as before a camera.
    on_table : bool
        Whether they are balls of one mass that roll on a table, seen from above: none flies freely, friction slows
        them, and two that touch exchange their velocities along the line of their centers (`TableParameters`).

    Attributes
    ----------
    colors : dict of str to ColorModel
        By label.
    finds : bool
        See there; it may be changed.
    doubtful : list of Track
        What the last search saw that may be one of the balls.
    left_out : int
        How many more were found at last than `most`.

    Raises
    ------
    ValueError
        If `most` is not 1 to 100, there is no color, two of them are the same, or the labels of families and colors
        differ.
    TypeError
        If a color is no `ColorModel`, or the parameters are none.

    Examples
    --------
    >>> import numpy as np, matchset as ms
    >>> rows, columns = np.indices((240, 320))
    >>> image = np.full((240, 320, 3), 90, np.uint8)
    >>> for x in (80, 220):
    ...     image[np.hypot(columns - x, rows - 110) < 30] = (200, 60, 30)
    >>> tracker = ms.MultiTracker(ms.Circle, ms.ColorModel.pick(image, 80, 110))
    >>> for _ in range(4):
    ...     targets = tracker.update(image)
    >>> [(target.identity, round(target.track.shape.x)) for target in targets]
    [(0, 80), (1, 220)]
    """

    def __init__(
        self,
        family: Families,
        colors: Colors,
        most: int = 20,
        parameters: MultiTrackerParameters | None = None,
        *,
        finds: bool = True,
        fps: float | None = 30.0,
        on_table: bool = False,
    ) -> None:
        """Check what is handed in; seven parameters: each is a choice of the user's."""
        check_kind("parameters", parameters, (MultiTrackerParameters, type(None)))
        self.most = checked_count("most", most, 1, MOST)
        self.parameters, self.colors = parameters or MultiTrackerParameters(), named_colors(colors)
        if on_table and self.parameters.motion.table is None:
            self.parameters = self.parameters.on_table()
        families = _families(family, self.colors)
        self._made = families, self.colors, most, self.parameters, finds, fps
        self._observer = Observer(families, self.colors, self.parameters, finds)
        self._linking = Linking(most, self.parameters.motion, self.parameters.linking)
        self.finds = finds
        self._arrays = ArrayFrames(fps)
        self._count = self._frames = 0
        self._format: tuple[int, ...] | None = None
        self._time, self._passed = -math.inf, 1.0 / 30.0

    @one_line
    def __repr__(self) -> str:
        followed = sum(each.identity is not None for each in self._linking.targets)
        return f"MultiTracker({followed} targets followed, {self._count} found, {self._frames} frames)"

    @property
    def finds(self) -> bool:
        """Whether all that looks like the targets is searched for."""
        return self._linking.births

    @finds.setter
    def finds(self, finds: bool) -> None:
        self._linking.births = self._observer.finds = finds

    @property
    def doubtful(self) -> list[Track[Any]]:
        """What the last search saw that may be one of the balls, and that is not followed: `add` follows one."""
        return list(self._observer.searches.doubtful)

    @property
    def left_out(self) -> int:
        """How many more were found at last than are followed, since there are `most`."""
        return self._linking.left_out

    def add(
        self, what: tuple[float, float] | Shape | Track[Any], label: str | None = None, *, hidden: bool = False
    ) -> int:
        """Follow what is at a point, a shape, or what another tracker has followed, from the next frame on.

        Parameters
        ----------
        what : tuple of float, Shape or Track
            A point (x, y), px, of something whose outline is looked for around it for half a second; its outline,
            roughly; or its track in a frame before the next one, which is believed.
        label : str, optional
            Of its color; where there is one color only, that.
        hidden : bool
            Of a track: it is not seen any more.

        Returns
        -------
        int
            The identity that it has as soon as it is found.

        Raises
        ------
        ValueError
            If there is no such label, or several and none is given; if the point is not finite, or the shape of another
            family; if it is on a target that is followed already, or there are `most`.
        """
        if label is None and len(self.colors) == 1:
            label = next(iter(self.colors))
        if label not in self.colors:
            raise ValueError(f"the label must be one of {', '.join(map(repr, self.colors))}, got {label!r:.60}")
        if isinstance(what, Track):
            return self._take(what, label, hidden)
        point = checked_point("the point", what if isinstance(what, tuple) else what.state[:2])
        for each in self._linking.targets:
            if each.tracklet is not None:
                place = each.tracklet.sighting.place
                if math.hypot(place.x - point[0], place.y - point[1]) < place.half_width:
                    raise ValueError(f"at ({point[0]:.0f}, {point[1]:.0f}) is target {each.identity}, followed already")
        self._check_room()
        self._observer.request(label, what if not isinstance(what, tuple) else point, self._count)
        self._count += 1
        return self._count - 1

    def _take(self, track: Track[Any], label: str, hidden: bool) -> int:
        """Take over a target; what is there and has no identity yet is the same."""
        self._observer.check(label, track.shape)
        sighting = sighting_of(track, self.parameters.motion.center_sigmas, label)._replace(identity=self._count)
        for each in [each for each in self._linking.targets if each.identity is None]:
            if each.last.place.distance(sighting.place) < sighting.place.half_width:
                self._remove(each)
        self._check_room()
        self._linking.take(sighting, hidden)
        self._count += 1
        return self._count - 1

    def _check_room(self) -> None:
        if len(self._linking.targets) + len(self._observer.requests) >= self.most:
            raise ValueError(f"{self.most} targets are followed already: remove one, or allow for more by `most`")

    def remove(self, identity: int) -> None:
        """Follow a target no longer; what finds all may find it again, as another one.

        Raises
        ------
        ValueError
            If there is none.
        """
        found = next((each for each in self._linking.targets if each.identity == identity), None)
        if found is None:
            raise ValueError(f"there is no target {identity!r:.20}")
        self._remove(found)

    def _remove(self, target: Followed) -> None:
        for tracklet in self._linking.remove(target):
            self._observer.take_back(tracklet)

    def update(self, frame: Picture) -> list[Target[Any]]:
        """Track all targets in a frame, and search a strip of it for new ones.

        Parameters
        ----------
        frame : Frame, or ndarray of shape (h, w, 3) or (h, w), uint8
            The next picture, later than the one before; arrays as for `Tracker.update`.

        Returns
        -------
        list of Target
            In the order of their identities; those not seen for a while are `Lost` among them.

        Raises
        ------
        ValueError, TypeError
            As for `Tracker.update`.
        """
        frame = self._checked(frame)
        linking, observer = self._linking, self._observer
        linking.forget(frame.time, self.parameters.memory, self.parameters.unconfirmed)
        table = self.parameters.motion.table
        if table is not None:
            linking.foresee(frame.time)
        predicted = Predicted(linking.bank, frame.time)
        seen = observer.observe(frame, predicted, linking.tracklets, linking.hidden(), self._passed)
        bridged = linking.bridge(seen, predicted)
        lost = linking.end(seen.ended, frame.time)
        if table is not None:
            linking.doubt_rivals(seen.continued, predicted, table.rival)
        linking.doubt(lost, seen.continued, predicted)
        linking.go_on(seen.continued, frame.time, self._frames % self.parameters.period != 0)
        linking.begin(seen.fresh, predicted, frame.time)
        dropped = linking.decide(frame.time)
        for tracklet in (*seen.ended, *bridged, *dropped):
            observer.take_back(tracklet)
        return self._answers(frame, predicted)

    def smooth(self, video: Video | Sequence[Picture], clicks: Clicks = ()) -> list[TargetsAt]:
        """Follow all targets in a whole file, forward and backward, and find the best joint explanation of both.

        What `update` finds out only later is known from the beginning: a target from where it enters, whose a tracklet
        was after two had touched, what went on where one was lost. Identities are those that `update` would have given,
        and later numbers for what it never found. This tracker itself stays as it is: the video is followed by others
        like it. The memory it takes, some kB for each target and frame, is that of the answers.

        Parameters
        ----------
        video : Video, or sequence of Frame or ndarray
            A file, which is opened anew and read twice; or pictures.
        clicks : sequence of (int, (float, float) or Shape, str or None)
            What shall be followed from where it was clicked, both ways: index of the frame, then as for `add`.

        Returns
        -------
        list of TargetsAt
            One for each frame: between its first sighting and its last one each target is a `Track` or `Lost`.

        Raises
        ------
        ValueError
            If the video is live; and as by `update` and `add`.
        TypeError
            As by `update`.
        """
        smoother = self.smoother(clicks)
        ways = BothWays(video) if isinstance(video, Video) else PicturesBothWays(video, self._arrays.fps)
        for frame in ways.forward():
            smoother.forward(frame)
        for frame in ways.backward():
            smoother.backward(frame)
        return smoother.answers()

    def smoother(self, clicks: Clicks = ()) -> Smoother:
        """Return what `smooth` uses, for those that read a video both ways themselves."""
        parameters, (*_, finds, _) = self.parameters, self._made

        def sweep(clicked: Sequence[Click], backward: bool) -> Sweep:
            families, colors, most, _, _, fps = self._made
            tracker = MultiTracker(families, colors, most, parameters, finds=finds, fps=fps)
            return Sweep(tracker, tracker._linking, clicked, not (finds or backward), backward)

        known = Known(parameters.memory, parameters.motion, parameters.linking)
        return Smoother(sweep, [Click(*each) for each in clicks], not finds, known, parameters.smoothing)

    def _checked(self, picture: Picture) -> Frame:
        """Check a picture against those before it; return it as a frame."""
        if type(picture) is not Frame or self._arrays.count:
            picture = self._arrays.next(picture, self._frames)
        check_follows(picture, self._format, self._time)
        if self._format is None:
            for color in self.colors.values():
                color.check(picture.image)
        else:
            self._passed = min(picture.time - self._time, 1.0)
        self._format, self._time = picture.image.shape, picture.time
        self._frames += 1
        return picture

    def _answers(self, frame: Frame, predicted: Predicted) -> list[Target[Any]]:
        answers = list[Target[Any]]()
        for each in self._linking.candidates():
            if each.identity is None and each.sightings >= self.parameters.confirm:
                each.identity, self._count = self._count, self._count + 1
            if each.identity is None:
                continue
            if each.tracklet is None:
                behind, lost = self._hidden(each, frame, predicted)
                answers.append(Target(each.identity, each.label, lost, each.since, behind=behind))
                continue
            track = each.tracklet.sighting.track
            answers.append(Target(each.identity, each.label, track, each.since, _alternatives(each)))
        return answers if len(answers) < 2 else sorted(answers, key=lambda target: target.identity)

    def _hidden(self, each: Followed, frame: Frame, predicted: Predicted) -> tuple[int | None, Lost[Any]]:
        """Say behind what a target is hidden that is not seen, and where it should be."""
        place, _ = predicted.likeliest(each.slot)
        seen = [(other.identity, other.tracklet.sighting.place) for other in self._linking.targets if other.tracklet]
        for identity, nearer in seen:
            if identity is not None and place.distance(nearer) < nearer.half_width:
                return identity, Lost(f"hidden behind target {identity}", frame.time, each.shape_at(place))
        return None, Lost("not seen where its motion would have it", frame.time, each.shape_at(place))


def named_colors(colors: Colors) -> dict[str, ColorModel]:
    """Return colors by their labels.

    Raises
    ------
    ValueError
        If there is none, or two are the same.
    TypeError
        If one is no `ColorModel`.
    """
    if isinstance(colors, ColorModel):
        return {"0": colors}
    if isinstance(colors, Mapping):
        named = dict(colors)
    else:
        check_kind("colors", colors, Sequence, "one ColorModel, several, or a dict of them by label")
        named = {str(k): each for k, each in enumerate(colors)}
    if not named:
        raise ValueError("there must be a color to follow, got none")
    labels = list(named)
    for k, label in enumerate(labels):
        check_kind(f"the color {label!r}", named[label], ColorModel)
        for other in labels[:k]:
            same = named[label].log_odds.shape == named[other].log_odds.shape
            if same and np.array_equal(named[label].log_odds, named[other].log_odds):
                raise ValueError(f"the colors {other!r} and {label!r} are the same: one label is enough for both")
    return named


def _families(family: Families, colors: Mapping[str, ColorModel]) -> dict[str, type[Any]]:
    if not isinstance(family, Mapping):
        return dict.fromkeys(colors, family)
    if set(family) != set(colors):
        raise ValueError(f"families and colors must have the same labels, got {list(family)} and {list(colors)}")
    return dict(family)


def _alternatives(each: Followed) -> tuple[int, ...]:
    """Which other targets a tracklet may be of."""
    hypotheses = () if each.tracklet is None else each.tracklet.hypotheses
    return tuple(sorted(other.identity for other in hypotheses if other is not each and other.identity is not None))
