"""The settings of a camera in the page, with what was asked and what the camera says it does: `SettingsPanel`."""

from collections.abc import Callable

import msgspec

from matchset.live.camera.device import CameraDevice
from matchset.live.camera.messages import SETTINGS, SetCameraSetting, SettingWish
from matchset.live.feed import Panel
from matchset.media.streams.camera_settings import AUTOMATIC, Control, differences

UNITS = {"exposure": "× 0.1 ms on Linux", "white_balance": "K", "fps": "frames/s", "size": "px"}
# format: sizes that cameras have, px. One that has no such size takes the nearest, and says so.
SIZES = ((320, 240), (640, 480), (800, 600), (1024, 768), (1280, 720), (1920, 1080), (2560, 1440), (3840, 2160))


class SettingState(msgspec.Struct, frozen=True, omit_defaults=True):
    """A setting that the camera has.

    Parameters
    ----------
    name : str
    value : float
        What the camera says.
    unit : str
    automatic : bool or None
        Whether the camera chooses it itself; None if it cannot.
    asked : float or None
        What was asked for.
    words : str
        What of it was not granted.
    """

    name: str
    value: float
    unit: str = ""
    automatic: bool | None = None
    asked: float | None = None
    words: str = ""


class SettingsState(msgspec.Struct, frozen=True, omit_defaults=True):
    """The camera's settings.

    Parameters
    ----------
    settings : list of SettingState
        Exposure, gain, white balance, rate, as far as the camera has them.
    size : tuple of two int, optional
        Of the pictures, px; None if the camera has but one.
    asked_size : tuple of two int, optional
    size_words : str
        What of it was not granted.
    sizes : list of tuple of two int
        Those that can be asked for.
    missing : list of str
        Settings that the camera does not have.
    opened : bool
        Whether it was opened yet.
    """

    settings: list[SettingState] = []
    size: tuple[int, int] | None = None
    asked_size: tuple[int, int] | None = None
    size_words: str = ""
    sizes: list[tuple[int, int]] = []
    missing: list[str] = []
    opened: bool = False


class SettingsPanel(Panel):
    """Asks a camera for settings.

    Parameters
    ----------
    device : CameraDevice
    reopen : callable
        Has the camera opened again; does not wait.
    """

    name = "settings"
    messages = SETTINGS

    def __init__(self, device: CameraDevice, reopen: Callable[[], None]) -> None:
        self._device, self._reopen = device, reopen

    def take(self, message: SettingWish, page: str) -> None:  # noqa: ARG002
        """Ask for a setting.

        Raises
        ------
        ValueError
            If the camera has no such setting.
        """
        wishes: dict[str, float | None]
        if isinstance(message, SetCameraSetting):
            wishes = {message.name: message.value}
        else:
            wishes = {"width": message.width, "height": message.height}
        if self._device.ask(wishes):
            self._reopen()

    def state(self) -> SettingsState:
        """Return the settings."""
        controls, settings = self._device.controls, self._device.settings
        size = _pair(controls, "width", "height")
        asked = self._device.wishes
        names = ("exposure", "gain", "white_balance", "fps")
        refused = differences({name: settings[name] for name in ("width", "height") if name in settings})
        return SettingsState(
            settings=[self._setting(name, controls[name]) for name in names if name in controls],
            size=size,
            asked_size=(int(asked["width"]), int(asked["height"])) if "width" in asked else None,
            size_words="; ".join(refused),
            sizes=list(SIZES) if size is None or size in SIZES else [size, *SIZES],
            missing=[name.replace("_", " ") for name in names if name not in controls] if controls else [],
            opened=bool(controls),
        )

    def _setting(self, name: str, control: Control) -> SettingState:
        settings = self._device.settings
        return SettingState(
            name=name,
            value=round(control.value, 3),
            unit=UNITS.get(name, ""),
            automatic=control.automatic if name in AUTOMATIC else None,
            asked=self._device.wishes.get(name),
            words="; ".join(differences({name: settings[name]})) if name in settings else "",
        )


def _pair(controls: dict[str, Control], *names: str) -> tuple[int, int] | None:
    if any(name not in controls or controls[name].value <= 0 for name in names):
        return None
    width, height = (int(controls[name].value) for name in names)
    return width, height
