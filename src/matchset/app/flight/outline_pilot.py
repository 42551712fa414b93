"""A follower without pictures: `OutlinePilot` takes outlines from its camera, and is a `Pilot` in all else."""

import time

from matchset.app.flight.pilot import Colors, Outlines, Pilot, PilotParameters
from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.links.link import Link
from matchset.links.simulated import SimulatedCamera
from matchset.localization.localizer import Localizer
from matchset.localization.pose import Pose


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
        self._beyond = Localizer(camera.model, self.parameters.target)

    def _rehearse(self) -> None:
        """Do nothing: simulated time waits for what has to be compiled."""

    def _outlines(self, frame: Frame, stamps: list[float]) -> Outlines:
        outlines = self.camera.outlines(frame)
        follower = self._follower
        if follower.parameters.beyond.share:
            pose = self._beyond.update(self.camera.ball_beyond(frame), ())
            if isinstance(pose, Pose):
                follower.beyond.update(follower.mount.turn(pose), follower.ego_motion.at(pose.time))
        stamps.extend([time.perf_counter()] * 2)
        return outlines
