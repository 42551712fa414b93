"""From where the cameras of a `World` look, and whether they see the next one's ball: `WorldViews`; no pictures."""

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.camera.camera_model import CameraModel
from matchset.control.mount.camera_mount import mounting, turn_about_down
from matchset.sim.vehicle import VehiclePose
from matchset.sim.vehicle_camera import Viewpoint
from matchset.sim.world import RATE, World, camera_position

Floats = npt.NDArray[np.float64]


class HidingParameters(msgspec.Struct, frozen=True, kw_only=True):
    """When a board hides the ball from a camera.

    Parameters
    ----------
    duration : float
        How long at a time, s; 0: never.
    period : float
        From one time to the next, s.
    begin : float
        Time in which nothing is hidden, from the beginning, s: so that every flight begins with a ball in view.
    shift : float
        Share of the period by which each camera is later than the one behind it: not all are blind at once.
    """

    duration: float = 0.0
    period: float = 1.0
    begin: float = 2.0
    shift: float = 0.37


class WorldViews:
    """The cameras of a world without their pictures, mounted and with lenses as the world's conditions have them.

    Parameters
    ----------
    world : World
    camera : CameraModel
        What is told about every follower's camera.

    Attributes
    ----------
    world : World
    model : CameraModel
        The cameras as they are.
    """

    def __init__(self, world: World, camera: CameraModel) -> None:
        conditions = world.parameters.conditions
        factor = conditions.focal_length
        self.world = world
        self.model = msgspec.structs.replace(camera, fx=camera.fx * factor, fy=camera.fy * factor)
        self._mount = mounting(*conditions.mount) if any(conditions.mount) else None
        self._marker = turn_about_down(-conditions.marker_yaw) if conditions.marker_yaw else None
        self._hiding = HidingParameters()

    def hide_balls(self, duration: float, every: float) -> None:
        """Hide the ball from each camera for so long, so often, s; each at times of its own."""
        self._hiding = HidingParameters(duration=duration, period=every)

    def viewpoint(self, me: VehiclePose) -> Viewpoint:
        """Where the camera of a vehicle is and how it is turned."""
        turned = me.rotation if self._mount is None else me.rotation @ self._mount
        return Viewpoint(camera_position(me), turned.T)

    def marked(self, rotation: Floats) -> Floats:
        """Rotation of a ball, whose marker is at its -z, from that of its vehicle."""
        return rotation if self._marker is None else rotation @ self._marker

    def shows_ball(self, who: int, step: int) -> bool:
        """Whether the next one's ball has its middle in a camera's picture at a step, and no board is before it."""
        poses = self.world.poses(step)
        view = self.viewpoint(poses[who])
        ball = view.from_room @ (poses[who + 1].ball - view.position)
        return not self.is_hidden(who, step / RATE) and bool(self.model.visible(ball[np.newaxis])[0])

    def is_hidden(self, who: int, time: float) -> bool:
        """Whether a board is before a camera at a time, s."""
        hiding = self._hiding
        return time > hiding.begin and (time + hiding.shift * hiding.period * who) % hiding.period < hiding.duration
