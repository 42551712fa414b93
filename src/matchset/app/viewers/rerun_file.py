"""A result for the viewer Rerun: `RerunFile`; it imports the package rerun when one is opened."""

from pathlib import Path
from typing import Any

import numpy as np

from matchset.app.several.painter import PALETTE
from matchset.app.viewers.piped_file import PipedFile
from matchset.app.viewers.viewed_frame import CORNER, ViewedFrame, ViewedTarget
from matchset.camera.camera_model import CameraModel
from matchset.localization.pose import Pose
from matchset.media.closing import Closing

EPOCH = 1e9  # format: s; times of bags are later, after 1970, those of videos and clocks earlier, after their begin
SHOWN = 3  # format: numbers that have a plot of their own
SEEN_WIDTH, PREDICTED_WIDTH = 1.0, 0.5  # format: half widths of lines, px


class RerunFile(Closing):
    """Writes frames as they come, by Rerun's own thread; a file that exists is overwritten by `close`.

    Parameters
    ----------
    path : Path
    camera : CameraModel or None
        Where targets are located.
    diameter : float
        Of the balls, m.

    Raises
    ------
    OSError
        If the file cannot be written.
    """

    def __init__(self, path: Path, camera: CameraModel | None = None, diameter: float = 0.0) -> None:
        import rerun

        self._rerun: Any = rerun
        self._radius = 0.5 * diameter
        self._there, self._logged, self._plotted = set[str](), set[str](), set[str]()
        self._planned = self._closed = False
        self._record = rerun.RecordingStream("matchset")
        self._file = PipedFile(path)
        try:
            self._begin(camera)
        except BaseException:
            self.discard()
            raise

    def _begin(self, camera: CameraModel | None) -> None:
        """Open the file, and log what holds for all frames."""
        self._record.set_log_time_enabled(False)
        self._record.set_log_tick_enabled(False)
        self._record.save(self._file.name)
        self._file.opened()
        classes = [(k, "", (red, green, blue)) for k, (blue, green, red) in enumerate(PALETTE)]
        self._record.log("/", self._rerun.AnnotationContext(classes), self._rerun.ViewCoordinates.RDF, static=True)
        if camera is not None:
            self._record.log("camera", self._pinhole(camera), static=True)

    def write(self, seen: ViewedFrame) -> None:
        """Append a frame; of one that could not be decoded the targets only.

        Raises
        ------
        OSError
            If one of those before it could not be written.
        """
        self._file.check()
        clock = "timestamp" if seen.time > EPOCH else "duration"
        self._record.set_time("capture_time", **{clock: seen.time})
        self._record.set_time("frame", sequence=seen.number)
        if seen.jpeg:
            self._log("camera/image", self._rerun.EncodedImage(contents=seen.jpeg, media_type="image/jpeg"))
        for each in seen.targets:
            self._target(each)
        for entity in sorted(self._there - self._logged):  # not there any more: a loss is a gap
            self._record.log(entity, self._rerun.Clear(recursive=False))
        self._there, self._logged = self._logged, set()

    def close(self) -> None:
        """Finish the file, and give it its name.

        Raises
        ------
        OSError
            If not all of it could be written.
        """
        if self._closed:
            return
        self._closed = True
        self._record.disconnect()
        self._file.close()

    def discard(self) -> None:
        """Delete what was written; what was there before stays."""
        self._closed = True
        self._record.disconnect()
        self._file.discard()

    def _target(self, seen: ViewedTarget) -> None:
        """Log a target: outline, place, numbers."""
        identity = seen.target.identity
        lines = self._lines(seen)
        if lines is not None:
            self._log(f"camera/outlines/{identity}", lines)
        if seen.pose is not None:
            self._log(f"targets/{identity}", *self._ball(seen, seen.pose))
        numbers = seen.measured()
        if numbers and not self._planned:
            self._planned = True
            self._record.send_blueprint(self._layout(list(numbers)[:SHOWN], seen.pose is not None))
        for name, (value, sigma) in numbers.items():
            self._plot(f"measured/{name}/{identity}", seen, value, sigma)

    def _plot(self, entity: str, seen: ViewedTarget, value: float, sigma: float | None) -> None:
        """Log a number, with what is one standard deviation below and above it."""
        if entity not in self._plotted:
            self._plotted.add(entity)
            names, widths = [str(seen.target.identity), "- std", "+ std"], [2.0, 0.5, 0.5]
            style = self._rerun.SeriesLines(names=names, colors=[seen.color] * len(names), widths=widths)
            self._record.log(entity, style, static=True)
        spread = [] if sigma is None else [value - sigma, value + sigma]
        self._log(entity, self._rerun.Scalars([value, *spread]))

    def _log(self, entity: str, *parts: Any) -> None:
        """Log an entity that is there in this frame."""
        self._logged.add(entity)
        self._record.log(entity, *parts)

    def _lines(self, seen: ViewedTarget) -> Any:
        """Return the outline, in dashes where it should be; None where that is not known."""
        ring, dashes = seen.outline, seen.predicted
        if ring is not None:
            strips, width = [[*ring.tolist(), ring[0].tolist()]], SEEN_WIDTH
        elif dashes is not None and len(dashes):
            strips, width = dashes.tolist(), PREDICTED_WIDTH
        else:
            return None
        group = seen.target.identity % len(PALETTE)
        labels = [seen.words, *[""] * (len(strips) - 1)]
        return self._rerun.LineStrips2D(strips, class_ids=[group] * len(strips), labels=labels, radii=width)

    def _ball(self, seen: ViewedTarget, pose: Pose) -> tuple[Any, Any]:
        turn = np.eye(3) if pose.rotation_matrix is None else pose.rotation_matrix
        place = self._rerun.Transform3D(translation=pose.position, mat3x3=turn)
        size = [[self._radius] * 3]
        return place, self._rerun.Ellipsoids3D(half_sizes=size, colors=[seen.color], labels=[seen.words])

    def _pinhole(self, camera: CameraModel) -> Any:
        """Return the camera; Rerun knows no lens, so its distortion is left out."""
        return self._rerun.Pinhole(
            focal_length=(camera.fx, camera.fy),
            principal_point=(camera.cx + CORNER, camera.cy + CORNER),
            resolution=(camera.width, camera.height),
            camera_xyz=self._rerun.ViewCoordinates.RDF,
        )

    def _layout(self, names: list[str], located: bool) -> Any:
        """Return where what is shown: the picture, space, and a plot for each number."""
        views = self._rerun.blueprint
        left = [views.Spatial2DView(origin="camera", name="picture")]
        left += [views.Spatial3DView(origin="/", name="space")] if located else []
        plots = [views.TimeSeriesView(origin=f"measured/{name}", name=name) for name in names]
        return views.Blueprint(views.Horizontal(views.Vertical(*left), views.Vertical(*plots)), collapse_panels=True)
