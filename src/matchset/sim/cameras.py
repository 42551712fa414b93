"""Pictures of a `World`: what each vehicle's camera delivers after the analog link; `WorldCameras`."""

import numpy as np
import numpy.typing as npt

from matchset.camera.camera_model import CameraModel
from matchset.sim.airframe import airframe
from matchset.sim.analog_link import PRESETS, degrade
from matchset.sim.clips.balloon import Balloon
from matchset.sim.rendering.background import FastScene
from matchset.sim.rendering.surface import Surface
from matchset.sim.scene.scene import Scene
from matchset.sim.vehicle import VehiclePose
from matchset.sim.vehicle_camera import Appearance, VehicleCamera
from matchset.sim.world import RATE, World, camera_position

Floats = npt.NDArray[np.float64]

QUIET = 2.0  # s at the beginning in which nothing is hidden
FIELD = 4  # steps from the middle of a frame to that of a field


class WorldCameras:
    """Draws what the cameras of a world see.

    Parameters
    ----------
    world : World
    camera : CameraModel
        Every follower's.
    preset : str
        The analog link: a name in `matchset.sim.analog_link.PRESETS`.
    """

    def __init__(self, world: World, camera: CameraModel, preset: str) -> None:
        self.world, self._camera, self._link = world, camera, PRESETS[preset]
        vehicle, chain = world.parameters.vehicle, world.parameters
        scale = np.array((world.room_scale, 1.0, world.room_scale))
        surfaces = Scene.room(world.seed, clutter=True).surfaces
        room = [
            Surface(origin=scale * each.origin, u=scale * each.u, v=scale * each.v, texture=each.texture)
            for each in surfaces
        ]
        balloon = Balloon(radius=vehicle.ball_radius)
        self._eye = VehicleCamera(camera, FastScene(room), balloon, self._link.interlaced)
        flying, hung = (
            Appearance(FastScene(airframe(vehicle))),
            Appearance(FastScene(airframe(vehicle, rope=1.0)), above=1.2),
        )
        self._looks = [flying] * (chain.vehicles - 1) + [hung]
        self._hidden, self._every = 0.0, 1.0

    def hide_balls(self, duration: float, every: float) -> None:
        """Hide the ball from each camera for so long, so often, s; each at times of its own."""
        self._hidden, self._every = duration, every

    def image(self, who: int, step: int) -> npt.NDArray[np.uint8]:
        """Take the picture of a camera whose exposure has its middle at a step, BGR, uint8."""
        frame = self._eye.frame()
        for field in range(self._eye.fields):
            at = step + FIELD * (2 * field - 1) * (self._eye.fields - 1)
            sights = self.world.poses(at)
            self._expose(field, sights[who], who, sights, at, frame)
        seed = (self.world.seed * 64 + who) * 1_000_003 + step
        return degrade(frame, self._link, seed, work=self._eye.planes())

    def held_ball(self, who: int) -> npt.NDArray[np.uint8]:
        """Take a picture of a ball that is held 1 m before a camera, the marker toward it."""
        me = self.world.poses(0)[who]
        lens = camera_position(me)
        ball = lens + me.rotation[:, 2]
        held = VehiclePose(ball, me.rotation, ball)
        frame = self._eye.frame()
        for field in range(self._eye.fields):
            self._eye.expose(field, lens, me.rotation, [(held, Appearance())], frame)
        return degrade(frame, self._link, self.world.seed * 64 + who)

    def shows_ball(self, who: int, step: int) -> bool:
        """Whether the next one's ball has its middle in a camera's picture at a step, and nothing is held before it."""
        sights = self.world.poses(step)
        place = sights[who].rotation.T @ (sights[who + 1].ball - camera_position(sights[who]))
        return not self._is_hidden(who, step / RATE) and bool(self._camera.visible(place[np.newaxis])[0])

    def _expose(
        self, field: int, me: VehiclePose, who: int, sights: list[VehiclePose], step: int, frame: npt.NDArray[np.uint8]
    ) -> None:
        lens = camera_position(me)
        others = [(sight, self._looks[k]) for k, sight in enumerate(sights) if k != who]
        if self._is_hidden(who, step / RATE):
            middle = lens + 0.5 * (sights[who + 1].ball - lens)
            others.append((VehiclePose(middle, me.rotation, middle), _BOARD))
        self._eye.expose(field, lens, me.rotation, others, frame)

    def _is_hidden(self, who: int, time: float) -> bool:
        return time > QUIET and (time + 0.37 * self._every * who) % self._every < self._hidden


_BOARD = Appearance(
    FastScene(
        [
            Surface(
                origin=np.array((-0.2, -0.2, 0.0)),
                u=np.array((0.4, 0.0, 0.0)),
                v=np.array((0.0, 0.4, 0.0)),
                texture=np.array([[(96, 110, 120, 255)]], np.uint8),
            )
        ]
    ),
    below=0.3,
    ball=False,
)
"""A board that is held half way between a camera and a ball."""
