"""Where the ball of a clip is at any time: `BallTrajectory`, a smooth random path through the picture."""

import functools
import math

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.camera.camera_model import CameraModel

Array = npt.NDArray[np.float64]


class WaveParameters(msgspec.Struct, frozen=True, kw_only=True):
    """The two sine waves of a smooth random path, and how a ball leaves the picture.

    Parameters
    ----------
    shares : tuple of 2 floats
        Amplitudes; they add up to 1. The second is small, so that steps stay close to those of the first. Chosen by
        hand, `test_clip` states the resulting steps and radii.
    ratios : tuple of 2 floats
        Frequencies, relative to each other; no whole number, so that the path does not repeat itself soon.
    crossing : float
        Frames that the ball takes to leave the picture or to come back.
    """

    shares: tuple[float, float] = (0.82, 0.18)
    ratios: tuple[float, float] = (1.0, 2.3)
    crossing: float = 24.0


WAVES = WaveParameters()


class BallTrajectory(msgspec.Struct, frozen=True, kw_only=True):
    """A smooth path in picture and depth, the same for the same seed.

    x, y and r are sums of two sine waves with random phases, so position and speed are bounded.

    Parameters
    ----------
    camera : CameraModel
        The camera, at rest.
    ball_radius : float
        Radius of the sphere, m.
    radii : tuple of 2 floats
        Smallest and largest radius in the picture, px; equal: the radius stays the same.
    shrink_to : float or None
        At the end of the path r has gone smoothly down to this, px, instead of swinging.
    frames : int
        Length of the path in frames, for `shrink_to`.
    step, radius_step : float
        Largest step of x and y, and of r, per frame, px.
    away : tuple of (int, int)
        Windows [from, to) of frames in which the ball is outside the picture; it leaves and returns beside
        them.
    seed : int
        Decides the phases.
    """

    camera: CameraModel
    ball_radius: float
    radii: tuple[float, float] = (20.0, 120.0)
    shrink_to: float | None = None
    frames: int = 300
    step: float = 10.0
    radius_step: float = 1.85
    away: tuple[tuple[int, int], ...] = ()
    seed: int = 0

    def position(self, time: float) -> Array:
        """Center of the ball in the camera frame.

        Parameters
        ----------
        time : float
            In frames: 0 is the middle of the exposure of the first frame.

        Returns
        -------
        ndarray of shape (3,), float64
            m.
        """
        x, y, r = self.apparent(time)
        camera = self.camera
        ray = np.array([(x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1.0])
        return ray * math.hypot(1.0, r / camera.fx) * camera.fx * self.ball_radius / r

    def apparent(self, time: float) -> tuple[float, float, float]:
        """Planned x, y and r of the ball, px; the exact outline follows from `position`.

        Parameters
        ----------
        time : float
            In frames.

        Returns
        -------
        tuple of 3 floats
            x, y, r, px.
        """
        phases = _phases(self.seed)
        r = self._radius(time, phases[2])
        # Off axis the outline is an ellipse, up to a few percent larger than r.
        width, height = self.camera.width, self.camera.height
        room_x, room_y = width / 2.0 - 1.25 * r - 3.0, height / 2.0 - 1.25 * r - 3.0
        low = min(self.radii)
        across = _wave(time, self.step / max(width / 2.0 - low, 1.0), phases[0])
        down = _wave(time, self.step / max(height / 2.0 - low, 1.0), phases[1])
        x = self.camera.cx + max(room_x, 0.0) * across
        y = self.camera.cy + max(room_y, 0.0) * down
        outside = self.camera.width + 1.5 * r + 20.0
        return x + self._away_share(time) * (outside - x), y, r

    def _radius(self, time: float, phases: Array) -> float:
        """Planned radius, px."""
        low, high = self.radii
        if self.shrink_to is not None:
            share = min(max(time / max(self.frames - 1, 1), 0.0), 1.0)
            return float(high * (self.shrink_to / high) ** share)
        half = (high - low) / 2.0
        return low + half + (half * _wave(time, self.radius_step / half, phases) if half > 0.0 else 0.0)

    def _away_share(self, time: float) -> float:
        """Share of the way out of the picture, 0 ... 1."""
        share = 0.0
        for begin, end in self.away:
            distance = max(begin - time, time - (end - 1), 0.0)
            near = max(1.0 - distance / WAVES.crossing, 0.0)
            share = max(share, near * near * (3.0 - 2.0 * near))
        return share


@functools.lru_cache(maxsize=256)
def _phases(seed: int) -> Array:
    """Phases of x, y and r, two each, rad."""
    return np.random.default_rng((seed, 0xBA11)).uniform(0.0, 2.0 * math.pi, (3, 2))


def _wave(time: float, pace: float, phases: Array) -> float:
    """Value in -1 ... 1 whose change per frame is at most `pace`."""
    shares, ratios = np.array(WAVES.shares), np.array(WAVES.ratios)
    pace /= float(shares @ ratios)
    return float(shares @ np.sin(pace * ratios * time + phases))
