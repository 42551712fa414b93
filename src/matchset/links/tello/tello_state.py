"""What a Tello says ten times a second: `TelloState`, read from its text."""

import math

import msgspec


class TelloState(msgspec.Struct, frozen=True, kw_only=True):
    """The last state.

    Attributes
    ----------
    roll, pitch, yaw : float
        rad: right side down, nose up, clockwise from where it was switched on.
    height : float
        Above where it took off, m, in steps of 0.1.
    distance : float
        To what is below it, m; 0.1 on the floor, 65 or so where it sees nothing.
    battery : float
        0 ... 1.
    temperature : float
        Of its warmest part, degrees Celsius.
    motor_time : float
        How long the motors have run since it was switched on, s.
    """

    roll: float
    pitch: float
    yaw: float
    height: float
    distance: float
    battery: float
    temperature: float
    motor_time: float


def parse_state(data: bytes) -> TelloState | None:
    """Read a state: ``pitch:0;roll:0;yaw:-12;vgx:0; ... ;tof:10;h:0;bat:87; ... ;time:0; ... ;`` and a line end.

    Parameters
    ----------
    data : bytes
        A UDP packet.

    Returns
    -------
    TelloState or None
        None if it is no state, or one of its numbers is none.
    """
    parts = (part.partition(":") for part in data.decode("ascii", "replace").strip().split(";"))
    texts = {name.strip(): text for name, _, text in parts}
    try:
        values = {name: float(texts[name]) for name in ("pitch", "roll", "yaw", "h", "tof", "bat", "temph", "time")}
    except (KeyError, ValueError):
        return None
    if not all(map(math.isfinite, values.values())):
        return None
    return TelloState(
        roll=math.radians(values["roll"]),
        pitch=math.radians(values["pitch"]),
        yaw=math.radians(values["yaw"]),
        height=values["h"] / 100.0,
        distance=values["tof"] / 100.0,
        battery=values["bat"] / 100.0,
        temperature=values["temph"],
        motor_time=values["time"],
    )
