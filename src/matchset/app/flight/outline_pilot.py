"""A follower without pictures: `OutlinePilot` takes outlines from its camera, and is a `Pilot` in all else."""

import time

from matchset.app.flight.pilot import Colors, Pilot, PilotParameters
from matchset.control.repeated_picture import note_picture
from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.links.link import Link
from matchset.links.simulated import SimulatedCamera
from matchset.localization.pose import Pose
from matchset.shapes.circle import Circle
from matchset.tracking.track import Lost, Track


class OutlinePilot(Pilot):
    """Flies one simulated follower by outlines: localizer, filter, controllers and safety are those of every pilot.

    Which ball is the neighbor's is never in question, and no ball is missed that is in sight: what a tracker does wrong
    is left out.

    Parameters
    ----------
    camera : SimulatedCamera
        Of a quick chain.
    link : Link
    parameters : PilotParameters, optional
    """

    camera: SimulatedCamera

    def __init__(self, camera: SimulatedCamera, link: Link, parameters: PilotParameters | None = None) -> None:
        no_color = ColorModel.dark()
        super().__init__(camera, link, Colors(no_color, no_color), parameters)

    def _rehearse(self) -> None:
        """Do nothing: simulated time waits for what has to be compiled."""

    def _locate(
        self,
        frame: Frame | None,
        now: float,
        stamps: list[float],
    ) -> tuple[Track[Circle] | Lost[Circle], tuple[Track[Circle], ...], Pose | Lost[Pose]]:
        if frame is not None:
            self._pictures = note_picture(frame.image, self._pictures, self.parameters.repeated)
        if frame is None or self._pictures.repeats:
            why = "no picture came" if frame is None else "a picture came again"
            stamps.extend([stamps[-1]] * 3)
            return Lost(why, now), (), Lost(why, now)
        ball, markers = self.camera.outlines(frame)
        stamps.extend([time.perf_counter()] * 2)
        pose = self._localizer.update(ball, markers)
        stamps.append(time.perf_counter())
        self._frame_time = frame.time
        return ball, markers, pose
