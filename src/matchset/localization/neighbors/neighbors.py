"""All balls in view at once: `Neighbors` (step 5 of the paper's pipeline)."""

import msgspec

from matchset.camera.camera_model import CameraModel
from matchset.image.color import ColorModel
from matchset.image.frame import ArrayFrames, Frame, Picture
from matchset.localization.ball_target import BallTarget
from matchset.localization.localizer import LocalizerParameters
from matchset.localization.markers.marker_workspace import MarkerParameters
from matchset.localization.neighbors.neighbor import Neighbor, NeighborLocalizer
from matchset.numeric.arguments import check_kind
from matchset.numeric.copies import Copied
from matchset.numeric.words import one_line
from matchset.shapes.circle import Circle
from matchset.tracking.many.multi_tracker import MultiTracker
from matchset.tracking.many.parameters import MultiTrackerParameters


class NeighborsParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How neighbors are followed and located.

    Where nothing else is said they were chosen by hand; `python -m benchmarks --only localization_neighbors` would show
    a change.

    Parameters
    ----------
    marker_memory : float
        How long a ball counts as a neighbor after its marker was last seen, s.
    max_count : int
        How many balls are followed at once.
    balls : MultiTrackerParameters
        How they are told apart.
    markers : MarkerParameters
    localizer : LocalizerParameters
    """

    marker_memory: float = 1.0
    max_count: int = 16
    balls: MultiTrackerParameters = MultiTrackerParameters()
    markers: MarkerParameters = MarkerParameters()
    localizer: LocalizerParameters = LocalizerParameters()


class Neighbors(Copied):
    """Follows every ball in view; each keeps its identity while others cross or hide it.

    Parameters
    ----------
    camera : CameraModel
        What films them.
    target : BallTarget
        What they all carry, with a marker.
    ball_color : ColorModel
        Of the balls with their markers (the paper's filter a: ``blue | purple``).
    marker_color : ColorModel
        Of the markers alone (filter b).
    parameters : NeighborsParameters, optional
    fps : float or None
        For plain arrays: their rate, 1/s. None: they have the times at which `update` is called, as before a camera.

    Raises
    ------
    ValueError
        If the balls have no marker.

    Examples
    --------
    >>> import numpy as np, matchset as ms
    >>> rows, columns = np.indices((240, 320))
    >>> image = np.full((240, 320, 3), 90, np.uint8)
    >>> for x in (80, 220):
    ...     image[np.hypot(columns - x, rows - 110) < 30] = (200, 60, 30)
    >>> blue, purple = ms.ColorModel.pick(image, 80, 110), ms.ColorModel.hsv((135, 80, 40), (165, 255, 255))
    >>> camera = ms.CameraModel.from_fov(320, 240, 1.07)
    >>> neighbors = ms.Neighbors(camera, ms.BallTarget(0.28, markers=((0, 0, 1),)), blue, purple)
    >>> for k in range(4):
    ...     seen = neighbors.update(ms.Frame(image, k / 30, k))
    >>> [(each.identity, each.marked, round(each.pose.distance, 1)) for each in seen]
    [(0, False, 1.3), (1, False, 1.3)]
    """

    def __init__(
        self,
        camera: CameraModel,
        target: BallTarget,
        ball_color: ColorModel,
        marker_color: ColorModel,
        parameters: NeighborsParameters | None = None,
        *,
        fps: float | None = 30.0,
    ) -> None:
        check_kind("camera", camera, CameraModel)
        check_kind("target", target, BallTarget)
        for name, color in (("ball_color", ball_color), ("marker_color", marker_color)):
            check_kind(name, color, ColorModel)
        check_kind("parameters", parameters, (NeighborsParameters, type(None)))
        target.require_markers("Neighbors")
        self.parameters = parameters or NeighborsParameters()
        self._camera, self._target, self._marker_color = camera, target, marker_color
        self._balls = MultiTracker(Circle, ball_color, self.parameters.max_count, self.parameters.balls)
        self._followed: dict[int, NeighborLocalizer] = {}
        self._frames, self._arrays = 0, ArrayFrames(fps)
        self._make_derived()

    def _derive(self) -> None:
        self._localizer()  # compiles what new balls need

    def _localizer(self) -> NeighborLocalizer:
        limits = self.parameters
        return NeighborLocalizer(self._camera, self._target, self._marker_color, limits.markers, limits.localizer)

    @one_line
    def __repr__(self) -> str:
        names = ", ".join(map(str, self._followed))
        return f"Neighbors({len(self._followed)} balls followed{names and ': ' + names}, {self._frames} frames)"

    def update(self, frame: Picture) -> list[Neighbor]:
        """Track all balls in a frame, and search a strip of it for new ones.

        Parameters
        ----------
        frame : Frame, or ndarray of shape (h, w, 3) or (h, w), uint8
            The next picture, of the camera's size, later than the one before; arrays as for `Tracker.update`.

        Returns
        -------
        list of Neighbor
            In the order of their identities; those not seen for a while are `Lost` among them.

        Raises
        ------
        ValueError
            If the picture is not of the camera's size, or as for `Tracker.update`.
        """
        if type(frame) is not Frame or self._arrays.count:
            frame = self._arrays.next(frame, self._frames)
        self._frames += 1
        self._camera.check(frame.image)
        targets, memory = self._balls.update(frame), self.parameters.marker_memory
        before = self._followed
        self._followed = {each.identity: before.get(each.identity) or self._localizer() for each in targets}
        return [self._followed[each.identity].update(each.identity, frame, each.track, memory) for each in targets]
