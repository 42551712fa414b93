"""What a camera can be set to: how it is asked (`apply`), and what it says (`read_controls`, `differences`)."""

import math
from collections.abc import Mapping
from typing import NamedTuple

import cv2

from matchset.media.capture import Capture

Settings = dict[str, tuple[float, float | None]]
PROPERTIES = {  # in the order in which they are set: a driver needs the size first, and both of it
    "width": cv2.CAP_PROP_FRAME_WIDTH,
    "height": cv2.CAP_PROP_FRAME_HEIGHT,
    "fps": cv2.CAP_PROP_FPS,
    "exposure": cv2.CAP_PROP_EXPOSURE,
    "gain": cv2.CAP_PROP_GAIN,
    "white_balance": cv2.CAP_PROP_WB_TEMPERATURE,
}
AUTOMATIC = {"exposure": cv2.CAP_PROP_AUTO_EXPOSURE, "white_balance": cv2.CAP_PROP_AUTO_WB}
V4L2_EXPOSURE = 1.0, 3.0  # format: V4L2_EXPOSURE_MANUAL and _APERTURE_PRIORITY; the other systems say 0 and 1


class Control(NamedTuple):
    """A setting of a camera.

    Attributes
    ----------
    value : float
        In the driver's unit.
    automatic : bool or None
        Whether the camera chooses it itself; None if it cannot, or does not say.
    """

    value: float
    automatic: bool | None


def apply(capture: Capture, wishes: Mapping[str, float]) -> Settings:
    """Set each wish, its automatic counterpart off, and read back what became of it.

    Parameters
    ----------
    capture : Capture
        An open camera.
    wishes : mapping of str to float
        Names of `PROPERTIES`, and the values asked for.

    Returns
    -------
    dict
        Name -> (asked, got); got is None where the camera has no such setting.
    """
    accepted = {}
    ordered = [(name, wishes[name]) for name in PROPERTIES if name in wishes]
    for name, asked in ordered:
        set_automatic(capture, name, False)
        accepted[name] = capture.set(PROPERTIES[name], asked)
    settings: Settings = {}
    for name, asked in ordered:  # when all are set: one may move another
        got = capture.get(PROPERTIES[name])
        absent = math.isnan(got) or (not accepted[name] and got in (-1.0, 0.0))
        settings[name] = asked, None if absent else got
    return settings


def read_controls(capture: Capture) -> dict[str, Control]:
    """Read the settings that a camera has.

    Parameters
    ----------
    capture : Capture
        An open camera.

    Returns
    -------
    dict of str to Control
        By the names of `PROPERTIES`; one that the camera does not have is left out.
    """
    controls = {}
    for name, number in PROPERTIES.items():
        value = capture.get(number)
        if math.isnan(value) or value == -1.0:  # -1: how OpenCV says that there is none
            continue
        controls[name] = Control(value, _is_automatic(capture, name))
    return controls


def set_automatic(capture: Capture, name: str, on: bool) -> None:
    """Let the camera choose a setting itself, or not; nothing where it cannot."""
    if name in AUTOMATIC:
        v4l2_exposure = name == "exposure" and capture.getBackendName() == "V4L2"
        capture.set(AUTOMATIC[name], V4L2_EXPOSURE[on] if v4l2_exposure else float(on))


def _is_automatic(capture: Capture, name: str) -> bool | None:
    """Whether the camera chooses a setting itself; None if it does not say."""
    if name not in AUTOMATIC:
        return None
    mode = capture.get(AUTOMATIC[name])
    if math.isnan(mode) or mode == -1.0:
        return None
    v4l2_exposure = name == "exposure" and capture.getBackendName() == "V4L2"
    return mode != V4L2_EXPOSURE[0] if v4l2_exposure else mode != 0.0


def differences(settings: Settings) -> list[str]:
    """Say in words which wishes were not granted.

    Parameters
    ----------
    settings : dict
        Name -> (asked, got).

    Returns
    -------
    list of str
        One sentence for each difference of more than 1 %.
    """
    words = []
    for name, (asked, got) in settings.items():
        if got is None:
            words.append(f"{name}: asked for {asked:g}, but this source has no such setting")
        elif not math.isclose(asked, got, rel_tol=0.01):
            words.append(f"{name}: asked for {asked:g}, the driver says {got:g}")
    return words
