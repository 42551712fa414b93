"""Pictures of a `World`: what each vehicle's camera delivers after the analog link; `WorldCameras`."""

import numpy as np
import numpy.typing as npt

from matchset.camera.camera_model import CameraModel
from matchset.sim.airframe import airframe
from matchset.sim.analog_link import PRESETS, degrade
from matchset.sim.clips.balloon import Balloon
from matchset.sim.conditions.exposures import Exposures
from matchset.sim.conditions.shade import Shade
from matchset.sim.rendering.background import FastScene
from matchset.sim.rendering.surface import Surface
from matchset.sim.scene.scene import Scene
from matchset.sim.vehicle import VehiclePose
from matchset.sim.vehicle_camera import Appearance, VehicleCamera
from matchset.sim.world import RATE, World, camera_position
from matchset.sim.world_views import WorldViews

Floats = npt.NDArray[np.float64]
Bytes = npt.NDArray[np.uint8]

FIELD = 4  # format: steps from the middle of a frame to that of a field
FLOOR = 3  # format: number of the floor among the surfaces of a room


class WorldCameras(WorldViews):
    """Draws what the cameras of a world see. Its kernels are compiled in the constructor.

    Parameters
    ----------
    world : World
        Its seed decides the room and the noise, too.
    camera : CameraModel
        What is told about every follower's, with its distortion.
    preset : str
        The analog link: "clean", "typical" or "bad", the names in `matchset.sim.analog_link.PRESETS`.

    Raises
    ------
    ValueError
        If there is no such link.
    """

    def __init__(self, world: World, camera: CameraModel, preset: str = "typical") -> None:
        if preset not in PRESETS:
            raise ValueError(f"preset must be one of {', '.join(PRESETS)}, got {preset!r}")
        super().__init__(world, camera)
        self._link = PRESETS[preset]
        vehicle, chain = world.vehicle, world.parameters
        scale = np.array((world.room_scale, 1.0, world.room_scale))
        surfaces = Scene.room(world.seed, clutter=True).surfaces
        room = [
            Surface(origin=scale * each.origin, u=scale * each.u, v=scale * each.v, texture=each.texture)
            for each in surfaces
        ]
        balloon = Balloon(radius=vehicle.ball_radius)
        conditions = world.parameters.conditions
        shade = Shade(conditions.shadow, _mean_color(surfaces[FLOOR]), world.seed) if conditions.shadow else None
        self._camera = VehicleCamera(self.model, FastScene(room), balloon, self._link.interlaced, shade)
        self._exposures = Exposures(conditions, RATE, world.seed)
        flying = Appearance(FastScene(airframe(vehicle)), turn=self._marker)
        hanging = Appearance(FastScene(airframe(vehicle, rope=1.0)), above=1.2, turn=self._marker)
        self._appearances = [flying] * (chain.vehicles - 1) + [hanging]
        self._board = _board()
        degrade(self._camera.frame(), self._link, 0)

    def image(self, who: int, step: int) -> Bytes:
        """Take the picture of a camera whose exposure has its middle at a step.

        Parameters
        ----------
        who : int
            Whose, from 0.
        step : int
            Of the last second; interlaced fields are exposed 4 steps before and after it, so at most 4 before now, and
            half of `Conditions.blur_ms` more.

        Returns
        -------
        ndarray of shape (h, w, 3), uint8
            BGR; fresh memory.

        Raises
        ------
        ValueError
            If the step is not remembered, or not over.
        """
        frame, fields = self._camera.frame(), self._camera.fields
        for field in range(fields):
            self._expose_field(field, who, step + FIELD * (2 * field - 1) * (fields - 1), frame)
        seed = (self.world.seed * 64 + who) * 1_000_003 + step
        return degrade(frame, self._link, seed, self._exposures.gain(step))

    def held_ball(self, who: int) -> Bytes:
        """Take a picture of a ball that is held 1 m before a camera, the marker toward it."""
        me = self.world.poses(0)[who]
        position = camera_position(me)
        ball = position + me.rotation[:, 2]
        held = VehiclePose(ball, me.rotation, ball)
        frame = self._camera.frame()
        for field in range(self._camera.fields):
            self._camera.expose(field, position, me.rotation, [(held, Appearance())], frame)
        return degrade(frame, self._link, self.world.seed * 64 + who)

    def _expose_field(self, field: int, who: int, middle: int, frame: Bytes) -> None:
        """Draw a field of a camera whose exposure has its middle at a step: the mean of its sub-exposures, lit."""
        steps, gain, lines = (
            self._exposures.steps(middle),
            self._exposures.field_gain(middle),
            frame[field :: self._camera.fields],
        )
        self._expose(field, who, steps[0], frame)
        if len(steps) == 1 and gain == 1.0:
            return
        total = lines.astype(np.float32)
        for step in steps[1:]:
            self._expose(field, who, step, frame)
            total += lines
        lines[:] = np.clip(total * (gain / len(steps)) + 0.5, 0.0, 255.0)

    def _expose(self, field: int, who: int, step: int, frame: Bytes) -> None:
        """Draw a field of a camera as it is at a step."""
        poses = self.world.poses(step)
        me, position = poses[who], camera_position(poses[who])
        others = [(pose, self._appearances[k]) for k, pose in enumerate(poses) if k != who]
        if self.is_hidden(who, step / RATE):
            middle = position + 0.5 * (poses[who + 1].ball - position)
            others.append((VehiclePose(middle, me.rotation, middle), self._board))
        self._camera.expose(field, position, self.viewpoint(me).from_room.T, others, frame)


def _mean_color(surface: Surface) -> Floats:
    """Mean of the colors of a surface, BGR."""
    mean: Floats = surface.texture[..., :3].reshape(-1, 3).mean(axis=0)
    return mean


def _board() -> Appearance:
    """Make a board that is held half way between a camera and a ball."""
    return Appearance(
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
