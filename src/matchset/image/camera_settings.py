"""What a camera is asked for, and what it says it does: drivers ignore wishes without a word."""

import math
from collections.abc import Mapping

import cv2

from matchset.image.capture import Capture

Settings = dict[str, tuple[float, float | None]]
PROPERTIES = {
    "exposure": cv2.CAP_PROP_EXPOSURE,
    "white_balance": cv2.CAP_PROP_WB_TEMPERATURE,
    "fps": cv2.CAP_PROP_FPS,
}
V4L2_MANUAL_EXPOSURE = 1.0  # V4L2_EXPOSURE_MANUAL; the other systems say 0 for "not automatic"


def apply(capture: Capture, wishes: Mapping[str, float]) -> Settings:
    """Set each wish, its automatic counterpart off, and read back what became of it.

    Parameters
    ----------
    capture : Capture
        An open camera.
    wishes : mapping of str to float
        "exposure", "white_balance" or "fps" and the value asked for.

    Returns
    -------
    dict
        Name -> (asked, got); got is None where the camera has no such setting.
    """
    settings: Settings = {}
    for name, asked in wishes.items():
        if name == "exposure":
            manual = V4L2_MANUAL_EXPOSURE if capture.getBackendName() == "V4L2" else 0.0
            capture.set(cv2.CAP_PROP_AUTO_EXPOSURE, manual)
        elif name == "white_balance":
            capture.set(cv2.CAP_PROP_AUTO_WB, 0.0)
        accepted = capture.set(PROPERTIES[name], asked)
        got = capture.get(PROPERTIES[name])
        absent = math.isnan(got) or (not accepted and got in (-1.0, 0.0))
        settings[name] = asked, None if absent else got
    return settings


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
