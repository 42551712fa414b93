"""The autopilots by name, and the mode of each in which sticks are angles and the throttle is the thrust: `Autopilot`.

The numbers are ArduPilot's (`Mode::Number` of ArduCopter) and PX4's (`px4_custom_mode.h`).
"""

from collections.abc import Mapping

import msgspec

COPTERS = frozenset((2, 3, 4, 13, 14, 15, 29, 35))  # format: MAV_TYPE of vehicles with several rotors
PX4_MAIN, PX4_SUB = 16, 24  # format: bits below the main mode and the sub-mode in PX4's number of a mode
PX4_AUTO = 4 << PX4_MAIN  # format: PX4's number of its automatic modes, without the sub-mode


class SilenceSetting(msgspec.Struct, frozen=True):
    """A parameter of an autopilot that decides what silence does.

    Attributes
    ----------
    name : str
    least, most : float
        Between these it does what it should.
    otherwise : str
        What it means when it is not, in words.
    """

    name: str
    least: float
    most: float
    otherwise: str

    def complaint(self, value: float) -> str:
        """Say what a value means; empty if it does what it should."""
        return "" if self.least <= value <= self.most else f"{self.name} is {value:g}: {self.otherwise}"


class Autopilot(msgspec.Struct, frozen=True):
    """An autopilot and its modes.

    Attributes
    ----------
    name : str
    modes : mapping of int to str
        Names of its modes by its own numbers.
    stick_mode : int or None
        The mode that is flown in; None where nobody knows.
    packed : bool
        Its number of a mode holds a main mode and a sub-mode.
    silence : tuple of SilenceSetting
        What decides what it does when nothing is heard from us.
    """

    name: str
    modes: Mapping[int, str]
    stick_mode: int | None
    packed: bool = False
    silence: tuple[SilenceSetting, ...] = ()

    def mode_name(self, mode: int) -> str:
        """Return the name of a mode, or its number in words."""
        return self.modes.get(mode, f"mode {mode}")

    def mode_parameters(self, mode: int) -> tuple[float, float, float]:
        """Return the three parameters of MAV_CMD_DO_SET_MODE: that the mode is the autopilot's own, mode, sub-mode."""
        if self.packed:
            return 1.0, float(mode >> PX4_MAIN & 0xFF), float(mode >> PX4_SUB)
        return 1.0, float(mode), 0.0


_ARDUPILOT_MODES = {  # format: ArduCopter's numbers of its modes
    0: "Stabilize",
    1: "Acro",
    2: "AltHold",
    3: "Auto",
    4: "Guided",
    5: "Loiter",
    6: "RTL",
    7: "Circle",
    9: "Land",
    11: "Drift",
    13: "Sport",
    14: "Flip",
    15: "AutoTune",
    16: "PosHold",
    17: "Brake",
    18: "Throw",
    20: "Guided_NoGPS",
    21: "SmartRTL",
    22: "FlowHold",
    23: "Follow",
    24: "ZigZag",
    27: "Auto RTL",
    28: "Turtle",
}

_PX4_MODES = {  # format: PX4's numbers of its modes
    **{
        main << PX4_MAIN: name
        for main, name in enumerate(("Manual", "Altitude", "Position", "Auto", "Acro", "Offboard", "Stabilized"), 1)
    },
    **{
        PX4_AUTO | sub << PX4_SUB: name
        for sub, name in enumerate(("Ready", "Takeoff", "Hold", "Mission", "Return", "Land"), 1)
    },
}

_MANY = 1e9  # format: larger than any value of a parameter that counts kinds
_FOR_LONG = "when sticks stop it flies on by the last ones for so long, s; set 0.5 (0: it takes none from here)"
_NO_STICKS = "it does nothing when sticks stop"

# format: their names and meanings in ArduPilot's and PX4's lists of parameters; half a second and a bit is soon enough
_ARDUPILOT_SILENCE = (
    SilenceSetting("RC_OVERRIDE_TIME", 0.1, 1.0, _FOR_LONG),
    SilenceSetting("FS_THR_ENABLE", 1.0, _MANY, _NO_STICKS),
    SilenceSetting("FS_GCS_ENABLE", 1.0, _MANY, "it does nothing when this program is silent"),
)
_PX4_SILENCE = (
    SilenceSetting("COM_RC_LOSS_T", 0.0, 1.0, _FOR_LONG),
    SilenceSetting("NAV_RCL_ACT", 1.0, _MANY, _NO_STICKS),
)

AUTOPILOTS = {  # format: MAV_AUTOPILOT
    3: Autopilot("ArduPilot", _ARDUPILOT_MODES, 0, silence=_ARDUPILOT_SILENCE),
    12: Autopilot("PX4", _PX4_MODES, 7 << PX4_MAIN, packed=True, silence=_PX4_SILENCE),
}


def autopilot_of(number: int) -> Autopilot:
    """Return the autopilot of a number of MAV_AUTOPILOT; one without modes if it is not known."""
    return AUTOPILOTS.get(number, Autopilot(f"autopilot {number}", {}, None))
