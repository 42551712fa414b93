"""Shadows in the pictures of a flying camera: `Shade`.

One lamp far away, at rest in the room. The side of a ball that is turned away from it loses some of the light of the
room, too; whole balls do in patches of the room; and what flies throws a spot on the floor, away from the lamp.
Furniture throws none beyond what is painted on the floor, and the room's own light does not change.
"""

import math

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.numeric.record import Block, fields
from matchset.sim.rendering.background import FastScene
from matchset.sim.rendering.coverage import SHADING
from matchset.sim.rendering.surface import Surface
from matchset.sim.scene.furniture import FLOOR

Floats = npt.NDArray[np.float64]


class ShadeParameters(msgspec.Struct, frozen=True, kw_only=True):
    """What throws shadows; all chosen by hand, by looking at pictures.

    Parameters
    ----------
    lamp : tuple of 3 float
        Direction toward the lamp in the room, x right, y down, z forward; any length.
    patch_length : float
        From one dark patch of the room to the next, m: less than what a chain moves, more than a ball.
    patch_direction : float
        Direction along which they follow each other, to the right of z, rad.
    spot_radius : float
        Of the spot of a vehicle and its ball on the floor, m.
    spot_depth : float
        Share of the floor's light that it takes at a `strength` of 1.
    texels : int
        Across a spot. Its border is soft: the farther out, the fewer of them are dark.
    lift : float
        How far it is above the floor, m, so that no rounding hides it.
    """

    lamp: tuple[float, float, float] = (-0.48, -0.72, -0.5)
    patch_length: float = 1.6
    patch_direction: float = 0.6
    spot_radius: float = 0.22
    spot_depth: float = 0.7
    texels: int = 40
    lift: float = 0.005


class Shade:
    """Shadows of one world.

    Parameters
    ----------
    strength : float
        Share of the light that is lost in a shadow, 0 ... 1.
    floor : (3,) of float
        Color of the floor in the mean, BGR.
    seed : int
        Decides where the patches are.
    parameters : ShadeParameters, optional
    """

    def __init__(self, strength: float, floor: Floats, seed: int, parameters: ShadeParameters | None = None) -> None:
        self.parameters = parameters or ShadeParameters()
        self.strength = strength
        lamp = np.array(self.parameters.lamp)
        self._lamp: Floats = lamp / math.hypot(*lamp)
        self._phase = float(np.random.default_rng((seed, 0x5AD)).uniform(0.0, 2.0 * math.pi))
        self.spot = FastScene([_spot(self.parameters, floor * (1.0 - self.parameters.spot_depth * strength))])

    def light_at(self, place: Floats) -> float:
        """Share of the light that arrives at a place in the room, (3,), m: 1 between the patches."""
        settings = self.parameters
        along = place[0] * math.sin(settings.patch_direction) + place[2] * math.cos(settings.patch_direction)
        wave = math.sin(2.0 * math.pi * along / settings.patch_length + self._phase)
        return 1.0 - self.strength * (0.5 + 0.5 * wave)

    def ball(self, template: Block, place: Floats, from_room: Floats) -> Block:
        """Light a ball.

        Parameters
        ----------
        template : block
            `BallShading` of a ball without shadows; unchanged.
        place : ndarray of shape (3,)
            Of the ball in the room, m.
        from_room : ndarray of shape (3, 3)
            Rotation from the room to the camera.
        """
        lit, share = template.copy(), self.light_at(place)
        shading = fields(lit, SHADING)
        shading.light[:] = from_room @ self._lamp
        shading.color[:] *= share
        shading.marker_color[:] *= share
        shading.highlight *= share
        shading.ambient *= 1.0 - self.strength
        return lit

    def below(self, place: Floats) -> Floats:
        """Where on the floor the shadow of what is at a place in the room falls, (3,), m."""
        height = max(FLOOR - place[1], 0.0)
        spot: Floats = place - self._lamp * (height / -self._lamp[1])
        spot[1] = FLOOR - self.parameters.lift
        return spot


def _spot(settings: ShadeParameters, color: Floats) -> Surface:
    """Draw a dark spot with a soft border, in a frame of its own: texels that are dark or not there."""
    count, radius = settings.texels, settings.spot_radius
    across = (np.arange(count) + 0.5) / count * 2.0 - 1.0
    far = np.hypot(across[:, np.newaxis], across[np.newaxis, :])
    dark = np.random.default_rng(count).random((count, count)) < np.clip(2.0 * (1.0 - far), 0.0, 1.0)
    texture = np.empty((count, count, 4), np.uint8)
    texture[..., :3], texture[..., 3] = np.clip(color, 0.0, 255.0), 255 * dark
    corner, long = np.array((-radius, 0.0, -radius)), 2.0 * radius
    return Surface(origin=corner, u=np.array((long, 0.0, 0.0)), v=np.array((0.0, 0.0, long)), texture=texture)
