"""A phone or web camera: `DigitalCamera`, its parameters, and `CameraPipeline`, which goes from picture to picture."""

import msgspec
import numpy as np

from matchset.numeric.arguments import require_within
from matchset.sim.digital_camera.control_steps import ControlSteps, Gain
from matchset.sim.digital_camera.processing import add_sensor_noise, defocus, denoise, mix_with_last, saturate, sharpen
from matchset.sim.rendering.renderer import Picture

# format: accepted ranges of parameters
_LIMITS = {
    "readout": (0.0, 1.0),
    "defocus": (0.0, 40.0),
    "noise": (0.0, 80.0),
    "denoising": (0.0, 1.0),
    "trail": (0.0, 0.95),
    "sharpening": (0.0, 5.0),
    "halo": (0.3, 10.0),
    "saturation": (0.0, 3.0),
}


class DigitalCamera(msgspec.Struct, frozen=True, kw_only=True):
    """What a digital camera does to a picture between the lens and the codec; by default nothing.

    In this order: defocus, steps of exposure and white balance, noise, denoising, trail, sharpening, saturation. The
    shutter's readout is a matter of time: `Clip` draws it.

    Parameters
    ----------
    readout : float
        Rolling shutter: time from the first row to the last, frames, 0 ... 1. 0: all rows at once. Row y of frame i is
        exposed around ``i + readout ((y + 1/2) / height - 1/2)``. Phones have 0.3 to 0.9. More: a moving ball is
        sheared by its speed times the time of a row.
    defocus : float
        Radius of the lens's disc of confusion, px, 0 ... 40. An edge is twice as wide.
    steps : ControlSteps
        Steps of automatic exposure and white balance.
    noise : float
        Standard deviation of the sensor's noise at a gray level of 128, display units, 0 ... 80. Indoors 3 to 10.
    denoising : float
        Share of a median and bilateral filter, 0 ... 1. More: less noise, less texture, rounder corners.
    trail : float
        Largest share of the last picture where little changes, 0 ... 0.95. More: less noise, longer trails of weak
        contrast.
    sharpening : float
        Amount of an unsharp mask, 0 ... 5. More: stronger halos around edges. Phones have 0.5 to 2.
    halo : float
        Standard deviation of its blur, px, 0.3 ... 10: how wide halos are.
    saturation : float
        Factor on all color, 0 (gray) ... 3; 1: unchanged.
    """

    readout: float = 0.0
    defocus: float = 0.0
    steps: ControlSteps = ControlSteps()
    noise: float = 0.0
    denoising: float = 0.0
    trail: float = 0.0
    sharpening: float = 0.0
    halo: float = 1.5
    saturation: float = 1.0

    def __post_init__(self) -> None:
        require_within(self, _LIMITS, "of a digital camera lies in")

    @property
    def changes_pictures(self) -> bool:
        """Something beside `readout` is on."""
        return msgspec.structs.replace(self, readout=0.0, halo=IDEAL.halo) != IDEAL


class ProcessorParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How far noise reduction takes a difference for noise.

    Parameters
    ----------
    per_noise : float
        In standard deviations of the sensor's noise. More: smoother, and weaker edges are lost. Chosen by hand: pairs
        of pixels differ by 1.4 of them, few by more than three.
    least : float
        At least, display units: a camera without noise to speak of still smooths a little.
    """

    per_noise: float = 3.0
    least: float = 6.0


IDEAL = DigitalCamera()
PROCESSOR = ProcessorParameters()


class CameraPipeline:
    """Take pictures one after the other through a digital camera.

    Parameters
    ----------
    camera : DigitalCamera
    """

    def __init__(self, camera: DigitalCamera) -> None:
        self._camera = camera
        self._last: Picture | None = None

    def __call__(self, picture: Picture, seconds: float, gain: Gain, seed: int) -> Picture:
        """Take one picture.

        Parameters
        ----------
        picture : ndarray of shape (h, w, 3), float32
            What is before the lens, BGR, 0 ... 255; unchanged.
        seconds : float
            Its time in the clip, s.
        gain : tuple of 3 floats
            Factors of B, G and R by the light, beside the camera's own steps.
        seed : int
            Decides the noise; not negative.

        Returns
        -------
        ndarray of shape (h, w, 3), float32
            BGR, 0 ... 255.
        """
        camera = self._camera
        picture = defocus(picture, camera.defocus)
        factors = np.array(gain, np.float32) * np.array(camera.steps.gain(seconds), np.float32)
        picture = np.minimum(picture * factors, np.float32(255.0))
        if camera.noise > 0.0:
            picture = add_sensor_noise(picture, camera.noise, np.random.default_rng((seed, 0xD161)))
        picture = np.clip(picture, np.float32(0.0), np.float32(255.0))
        reach = max(PROCESSOR.per_noise * camera.noise, PROCESSOR.least)
        picture = denoise(picture, camera.denoising, reach)
        picture = self._last = mix_with_last(picture, self._last, camera.trail, reach)
        picture = sharpen(picture, camera.sharpening, camera.halo)
        if camera.saturation != 1.0:
            picture = saturate(picture, camera.saturation)
        return np.clip(picture, np.float32(0.0), np.float32(255.0))
