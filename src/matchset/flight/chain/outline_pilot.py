"""A follower without pictures: `OutlinePilot` takes outlines from its camera, and is a `Pilot` in all else."""

import time

from matchset.flight.chain.pilot import Outlines, Pilot, PilotParameters
from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.links.link import Link
from matchset.links.simulated import SimulatedCamera
from matchset.localization.localizer import Localizer
from matchset.localization.markers.ball_colors import BallColors
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
        super().__init__(camera, link, BallColors(no_color, no_color), parameters)
        self._outline_beyond = Localizer(camera.model, self.parameters.target)

    def _begin_tracking(self) -> None:
        """Do nothing: there are no pictures."""

    def _restart_tracking(self, pixel: tuple[float, float]) -> None:
        """Do nothing: the outlines are those of the neighbor."""

    def _rehearse(self) -> None:
        """Do nothing: simulated time waits for what has to be compiled."""

    def _outlines(self, frame: Frame, stamps: list[float]) -> Outlines:
        outlines = self.camera.outlines(frame)
        stamps.extend([time.perf_counter()] * 2)
        return outlines

    def _see_beyond(self, frame: Frame, ball: Track[Circle] | Lost[Circle]) -> Pose | Lost[Pose]:  # noqa: ARG002
        return self._outline_beyond.update(self.camera.ball_beyond(frame), ())
