"""Track a shape from frame to frame: `Tracker` (Epstein & Feldman, Alg. 1 and 3)."""

import math
from typing import Generic, TypeVar

import numpy as np
import numpy.typing as npt

from matchset.fitting.color_adapting import ColorAdapting
from matchset.fitting.fitter import NOT_FOUND, Estimate, Fitter
from matchset.fitting.validation import Prior
from matchset.fitting.workspace import MAX_LINES, SearchWindow
from matchset.image.color import ColorModel
from matchset.image.frame import ArrayFrames, Frame, Picture, channels_last, check_follows
from matchset.numeric.arguments import check_kind, checked_count, checked_point
from matchset.numeric.copies import Copied
from matchset.numeric.words import one_line
from matchset.shapes.shape import Shape, finds_itself, nearest
from matchset.tracking.ball.estimator import BallEstimator
from matchset.tracking.compiled_step import tracking_fitter
from matchset.tracking.detector import Detector, track_of
from matchset.tracking.detectors import Detectors
from matchset.tracking.initialization import check_start, initialize_near, model_for_image
from matchset.tracking.motion import forget_motion, gate_of, initialize, predict_state
from matchset.tracking.parameters import TrackerParameters
from matchset.tracking.too_near import TOO_NEAR, fills_picture
from matchset.tracking.track import Acquisition, Lost, Mode, Track
from matchset.tracking.track_step import TrackStep, precompile, precompile_search

S = TypeVar("S", bound=Shape)
Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]

MIN_POINTS, MAX_POINTS = 16, MAX_LINES  # format: capacity of the workspace


class Tracker(Copied, Generic[S]):
    """Tracks one shape; a tracker belongs to one thread, any number of them may run side by side.

    Everything is compiled in the constructor.

    Parameters
    ----------
    family : type
        The family of shapes: `Circle`, `Rectangle`, ...
    color : ColorModel
        What the target looks like; the tracker adapts a copy of its own, `tracker.color`.
    points : int
        Size of the match-set: the number of lines across the outline. More is more exact and slower.
    start : tuple of float, optional
        A point (x, y), px: the first search prefers the candidate that holds it.
    parameters : TrackerParameters, optional
    fps : float or None
        For plain arrays: their rate, 1/s. None: they have the times at which `update` is called, as before a camera.

    Raises
    ------
    ValueError
        If the points are no whole number, 16 to 4096, the start is no finite point, or the rate is not positive.
    TypeError
        If the color is no `ColorModel`, or the parameters are none.

    Examples
    --------
    >>> import numpy as np, matchset as ms
    >>> rows, columns = np.indices((120, 160))
    >>> image = np.full((120, 160, 3), 90, np.uint8)
    >>> image[np.hypot(columns - 70, rows - 50) < 25] = (200, 60, 30)
    >>> tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(image, 70, 50))
    >>> track = tracker.update(ms.Frame(image, 0.0, 0))
    >>> round(track.shape.x), round(track.shape.y), round(track.shape.radius)
    (70, 50, 25)
    """

    def __init__(
        self,
        family: type[S],
        color: ColorModel,
        points: int = 64,
        start: tuple[float, float] | None = None,
        parameters: TrackerParameters | None = None,
        *,
        fps: float | None = 30.0,
    ) -> None:
        check_kind("color", color, ColorModel, "ColorModel.pick(image, x, y) learns one from a click")
        check_kind("parameters", parameters, (TrackerParameters, type(None)))
        points = checked_count("points", points, MIN_POINTS, MAX_POINTS)
        self.parameters = (parameters or TrackerParameters()).resolved()
        self._family, self._given, self._arrays = family, color.copy(), ArrayFrames(fps)
        self._hint = start if start is None else checked_point("start", start)
        self._fitter: Fitter[S] = tracking_fitter(family, points, self.parameters, color.gray != "edges")
        self.step = TrackStep(self._fitter, self.parameters)
        self._adapting = ColorAdapting(self.parameters.adaptation, self.parameters.relighting)
        self._detectors = Detectors(self._fitter, self.parameters)
        self._ball = BallEstimator(self.step, self.parameters)
        self._format: tuple[int, ...] | None
        self._initial: S | None
        self._last: S | None
        self._time: float
        self._forget_frames()
        self._start = self._hint
        self._make_derived()

    def _derive(self) -> None:
        precompile(self._family, self._fitter.points, self._given.table.size, self._given.channels)
        if self.parameters.search.whole_frame:
            precompile_search(self._family, self._given.table.size, self._given.channels)

    @one_line
    def __repr__(self) -> str:
        how = f"{self._fitter.points} points, {self.mode.name.lower()}, {self._frames} frames"
        return f"Tracker({self._family.__name__}, {how})"

    def start(self, shape: S, velocity: tuple[float, float] = (0.0, 0.0)) -> None:
        """Begin at this shape in the next frame, without a search.

        Parameters
        ----------
        shape : S
            Where the shape is, roughly.
        velocity : tuple of float
            Of its center, px/s, from the last frame on.

        Raises
        ------
        ValueError
            If it is of another family, or the velocity not finite.
        """
        if not isinstance(shape, self._family):
            raise ValueError(f"this tracker follows {self._family.__name__}, got {shape!r}")
        limits, motion = self.parameters.initialization, self._fitter.work.motion
        sigma = limits.sigma_px + limits.sigma_share * float(self._family.half_width(shape.state))
        initialize(self._fitter.work, shape.state, self._time, sigma)
        motion.velocity[:2], motion.size_count = checked_point("the velocity", velocity), 0.0
        self._initial, self._last, self.step.acquired, self.mode = shape, shape, None, Mode.TRACKING

    def restart(self, hint: tuple[float, float] | S | None = None, *, same_camera: bool = False) -> None:
        """Begin anew, as a new tracker would, without making or compiling anything.

        The motion, the format of the pictures and what the color has adapted to are forgotten.

        Parameters
        ----------
        hint : tuple of float or Shape, optional
            A point (x, y), px: the next search prefers the candidate that holds it. A shape: the next frame begins at
            it, without a search. By default the whole frame is searched.
        same_camera : bool
            Remember how far the two fields of its interlaced pictures lie apart in time.

        Raises
        ------
        ValueError
            If the point is not finite, or the shape not of the family that is tracked.
        """
        shape = hint if isinstance(hint, self._family) else None
        if shape is None and hint is not None and not isinstance(hint, tuple):
            kind = f"{self._family.__name__}, from one or from a point (x, y)"
            raise ValueError(f"this tracker follows {kind}, got {hint!r:.60}")
        self._hint = None if shape is not None or hint is None else checked_point("the hint", hint)
        self._fitter.forget()
        forget_motion(self._fitter.work, same_camera)
        self._forget_frames()
        if shape is not None:
            self.start(shape)

    def _forget_frames(self) -> None:
        """Be as a tracker is that has seen nothing."""
        self.color, self.mode = self._given.copy(), Mode.SEARCHING
        self._adapting.begin(self.color)
        self._detectors.forget()
        self._format = self._initial = self._last = self._start = None
        self._time, self._interval = -math.inf, 1.0 / 30.0
        self._frames = self._arrays.count = 0
        self.step.forget()
        self._ball.forget(self.color)

    def update(self, frame: Picture) -> Track[S] | Lost[S]:
        """Track the shape into `frame` (Alg. 1): predict, match, fit; search the whole frame only when lost.

        Parameters
        ----------
        frame : Frame, or ndarray of shape (h, w, 3) or (h, w), uint8
            The next picture, later than the one before. Arrays, BGR or gray, are numbered from 0 and have the times of
            `fps`; a tracker is given either frames or arrays.

        Returns
        -------
        Track or Lost
            A `Track` only if this frame's own pixels confirm it; while the shape is not seen a `Lost` that says why,
            and for a while where the motion would have it.

        Raises
        ------
        ValueError
            If the time does not run forward, size or channels of the picture changed on the way, frames and arrays
            alternate, the color was learned on another kind of picture, or the constructor's start is not in it.
        TypeError
            If it is neither a `Frame` nor an array.
        """
        image = self._checked(frame)
        if self._initial is not None or (self.color.gray and self.mode is Mode.SEARCHING):
            self._prepare(image)
        self.step.outlines.network.begin_picture()
        rejected = self._tracked(image)
        if rejected is not None and self._relight(image):
            rejected = self._tracked(image)
        if rejected is None and self._ball.is_look_alike(image, self.color, self._fitter.state, self._time):
            rejected = NOT_FOUND
        if rejected is not None:
            reason = self._fitter.validator.describe(rejected.rejection, rejected.fit)
            if (lost := self._detect(image, reason)) is not None:
                return lost
        elif self.mode is Mode.COASTING:
            self.step.note_acquired(image, self.color, self._time)
        self.mode = Mode.TRACKING
        spread, acquired = self.step.outlines.spread, self.step.acquired
        track = track_of(self._fitter, self._last, self._time, spread, acquired, self._aspect)
        self._last = track.shape
        if self.step.without_outline:
            return track
        if self._ball.is_due(self._time):
            score = self._fitter.statistics.msac_score
            self._ball.note(image, gate_of(self._family, track.shape.state)[:3], self._time, score)
            self._adapting.keep(image, self.color)
        self._adapting.adapt(image, self.color, self._fitter, self._frames)
        return track

    def _tracked(self, image: Image) -> Estimate | None:
        """Track the shape into a picture; the estimate that was rejected, None if one was accepted."""
        when = self._time, self._interval, self._frames
        return NOT_FOUND if self.mode is Mode.SEARCHING else self.step.track(image, self.color, *when)

    def _relight(self, image: Image) -> bool:
        """Take the color, and what else is remembered of the target, in the light of a picture, if that has changed."""
        if (changed := self._adapting.relight(image, self.color)) is not None:
            self.color, gains = changed
            self._ball.relight(gains)
        return changed is not None

    def _checked(self, frame: Picture) -> Image:
        """Check a picture against those before it; return it as (h, w, channels)."""
        if type(frame) is not Frame or self._arrays.count:
            frame = self._arrays.next(frame, self._frames)
        image, time, self._aspect = frame.image, frame.time, frame.pixel_aspect
        self._fitter.take_rows(frame.rows)
        if image.shape != self._format or not time > self._time:
            check_follows(frame, self._format, self._time)
            self.color.check(image)
            check_start(image, self.color, self._start)
            self._format = image.shape
        if self._frames:
            self._interval = min(time - self._time, 1.0)
        self._time, self._frames = time, self._frames + 1
        return channels_last(image)

    def _prepare(self, image: Image) -> None:
        """Fit a brightness model to the picture, and begin at the shape that was given, if one was."""
        given, self._initial, self.step.given = self._initial, None, self._initial is not None
        limits = self.parameters.initialization, self.parameters.brightness
        if self.color.gray:
            self.color = model_for_image(self.color, image, given, limits[1])
            self._adapting.begin(self.color)
        if given is not None and finds_itself(self._family):
            state, sigma = initialize_near(image, self.color, self._fitter, given, *limits)
            initialize(self._fitter.work, state, -math.inf, sigma)

    def _detect(self, image: Image, reason: str) -> Lost[S] | None:
        """Search the whole frame (Alg. 2); while coasting only what can be the lost shape counts. None if found."""
        predicted = self._coast()
        judged = self.step.outlines.judges(self.color)
        if judged and self._by_network(image, predicted):
            return None
        if not (judged and self._ball.knows()):
            best = self._choose(image, predicted) if self.parameters.search.whole_frame else None
            rejection = "" if best is None else self._confirm(image, best, predicted)
            if rejection is None or (not judged and self._by_network(image, predicted)):
                return None
            reason = rejection or reason
        near = self._last is not None and fills_picture(image, self.color, self._last, self.parameters.too_near)
        return Lost(TOO_NEAR if near else reason, self._time, self._shape_of(predicted))

    def _by_network(self, image: Image, predicted: Floats | None) -> bool:
        """Find a ball that was seen before, or begin with the one that was clicked; whether the network sees it."""
        if self._last is not None and self._ball.knows():
            last, when = gate_of(self._family, self._last.state), (self._time, self._interval)
            expected = None if predicted is None else gate_of(self._family, predicted)
            return self._ball.find(image, self.color, last, expected, when)
        clicked = self._clicked() if self._frames == 1 else None
        if begun := clicked is not None and self._ball.begin(image, self.color, clicked, self._time):
            self._hint = None
        return begun

    def _coast(self) -> Floats | None:
        """State expected while the shape is not seen; None once that has lasted too long."""
        work, coast = self._fitter.work, self.parameters.coast
        if self.mode is not Mode.SEARCHING and self._time - float(work.motion.time) <= coast:
            predicted = predict_state(work, self._time)
            if self._family.half_width(predicted) != 0.0:  # otherwise the motion would turn it inside out
                self.mode = Mode.COASTING
                return predicted
        self.mode = Mode.SEARCHING
        return None

    def _choose(self, image: Image, predicted: Floats | None) -> Floats | None:
        """State of the detection to go on with, or None."""
        best, most, first = None, 0.0, self._clicked() if predicted is None else None
        detector = self._detector(image, predicted)
        for estimate, merit in detector.detections(image, self.color, self._prior(predicted), first):
            if predicted is not None:
                if not self._passes_gate(estimate, predicted):
                    continue
            elif self._hint is not None:
                if math.dist(estimate.state[:2].tolist(), self._hint) < self._family.half_width(estimate.state):
                    merit += self.parameters.detection.hint_bonus
                elif self._fitter.validate_detection(estimate, self._elsewhere(self._frames == 1)):
                    continue
            elif not self._is_expected(estimate):
                continue
            if merit > most:
                best, most = estimate.state, merit
        return best

    def _detector(self, image: Image, predicted: Floats | None) -> Detector[S]:
        """Detector for pictures of this size, whose cells suit the shape that is expected."""
        circle = self.color.circle
        size = math.inf if circle is None else self.parameters.detection.smaller * circle[2]
        if predicted is not None:
            size = float(self._family.half_width(predicted))
        return self._detectors.suited(image, size)

    def _clicked(self) -> S | None:
        """Shape of the circle that was found around the click, if that is where the search shall begin."""
        circle = self.color.circle
        if self._hint is None or circle is None or self._fitter.has_corners:
            return None
        return self._family.from_coarse(*circle) if math.dist(self._hint, circle[:2]) < circle[2] else None

    def _is_expected(self, estimate: Estimate) -> bool:
        """Whether a detection can be the target: about where it was seen last, or else with full evidence."""
        limits, last, there = self.parameters.reach, self._last, gate_of(self._family, estimate.state)
        if last is not None and estimate.evidence is not None:
            here = gate_of(self._family, last.state)
            ratio = max(here.half_width, there.half_width) / min(here.half_width, there.half_width)
            recent = self._time - float(self._fitter.work.motion.time) < limits.remembered_s
            near = here.distance(there) < limits.remembered * here.half_width
            if recent and near and ratio < limits.remembered_growth:
                return True
        return not self._fitter.validate_detection(estimate, Prior.NONE)

    def _passes_gate(self, estimate: Estimate, predicted: Floats) -> bool:
        """Whether a detection can be the lost shape: near its prediction, or farther off with full evidence."""
        limits = self.parameters.reach
        here, there = gate_of(self._family, predicted), gate_of(self._family, estimate.state)
        if here.near(there, limits):
            return True
        prior = self._elsewhere(here.alone(there, limits))
        valid = not self._fitter.validate_detection(estimate, prior)
        return valid and here.reachable(there, self.step.missed(self._time, self._interval), limits)

    def _confirm(self, image: Image, state: Floats, predicted: Floats | None) -> str | None:
        """Fit a detection once more, and begin there if nothing was known; why it is rejected, None if it is not."""
        fitter, limits, family = self._fitter, self.parameters.detection, self._family
        alone = predicted is None and self._hint is None
        start, reach = nearest(family, state, fitter.work.motion.last_state[: len(state)]), limits.refit_range
        if fitter.weighs(self.color):
            reach = max(limits.color_range, limits.color_share * float(family.half_width(state)))
        window = SearchWindow(reach, limits.speed if alone else 0.0, velocity_unknown=True)
        estimate = fitter.weigh(fitter.fit(image, self.color, start, window), image, self.color)
        rejection = fitter.validate_detection(estimate, self._prior(predicted))
        if rejection or not family.half_width(estimate.state) > 0.0:  # the second fit ran away
            return fitter.validator.describe(rejection, estimate.fit)
        if predicted is None:
            sigma = self.parameters.initialization.detected_share * float(family.half_width(state))
            initialize(fitter.work, estimate.state, self._time, sigma)
        self._hint = None
        if estimate.fit.color_score > self.parameters.confidence.clear_score:
            self.step.faint = 0
        self.step.accept(self._time)
        self.step.acquired = Acquisition(self._time, estimate.evidence)
        return None

    def _prior(self, predicted: Floats | None) -> Prior:
        """Say what is known of a detection beforehand."""
        if predicted is not None:
            return Prior.HERE
        weighs = self._fitter.weighs(self.color)
        if self._hint is None:
            return self._elsewhere(not weighs or self._last is None)
        return (Prior.CLICKED if self._frames == 1 else Prior.HERE) if weighs else Prior.PRESENT

    def _elsewhere(self, unknown: bool) -> Prior:
        """Say what is known of a shape elsewhere: a color learned against what is next to it may be anywhere."""
        return Prior.NONE if unknown or (self.color.is_local and self._last is None) else Prior.PRESENT

    def _shape_of(self, state: Floats | None) -> S | None:
        """Shape of an extrapolated state, None where there is none or it has shrunk to nothing."""
        try:
            return None if state is None else self._family.from_state(state, self._last)
        except ValueError:
            return None
