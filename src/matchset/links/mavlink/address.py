"""Where an autopilot is reached, and who speaks to it: `Address`, read from a URI.

``mavlink:udpin:0.0.0.0:14550`` waits at a port of this computer for the autopilot to speak,
``mavlink:udpout:HOST:PORT`` speaks first, ``mavlink:serial:/dev/ttyACM0:57600`` is a serial port with its baud rate.
After a question mark come numbers, joined by ``&``: ``vehicle=2`` the vehicle that is meant, where several are heard;
``system=254`` the number of this ground station, 255 otherwise; ``mode=0`` the autopilot's own number of the mode that
is flown in, where it is another than `autopilots` says.
"""

from typing import Literal
from urllib.parse import parse_qsl

import msgspec

from matchset.links.datagrams import LAST_PORT

SCHEME = "mavlink:"
FORMS = "mavlink:udpin:0.0.0.0:14550, mavlink:udpout:10.0.0.2:14550 or mavlink:serial:/dev/ttyACM0:57600"
BAUD = 57_600  # format: baud rate of a serial port that names none: that of telemetry radios
GROUND_STATION = 255  # format: customary number of a ground station
LARGEST = {"vehicle": 255, "system": 255, "mode": 2**32 - 1}  # format: of the numbers after the question mark

Kind = Literal["udpin", "udpout", "serial"]


class Address(msgspec.Struct, frozen=True):
    """Where an autopilot is reached.

    Attributes
    ----------
    kind : str
    place : str
        Address of the computer, or name of the serial port.
    number : int
        Port, or baud rate.
    vehicle : int
        Number of the vehicle that is meant, 1 ... 255; 0: the only one that is heard.
    system : int
        Number of this ground station, 1 ... 255.
    mode : int or None
        Number of the mode that is flown in; None: as `autopilots` says.
    """

    kind: Kind
    place: str
    number: int
    vehicle: int = 0
    system: int = GROUND_STATION
    mode: int | None = None


def parse_address(uri: str) -> Address:
    """Read a URI.

    Raises
    ------
    ValueError
        If it has another form.
    """
    where, _, question = uri.removeprefix(SCHEME).partition("?")
    kind, _, rest = where.partition(":")
    place, _, digits = rest.rpartition(":")
    if kind == "serial" and not digits.isdecimal():
        place, digits = rest, str(BAUD)
    right = kind in ("udpin", "udpout", "serial") and place and digits.isascii() and digits.isdecimal()
    if not uri.startswith(SCHEME) or not right or not 0 < int(digits) <= (2**32 if kind == "serial" else LAST_PORT):
        raise ValueError(f"an autopilot is named like {FORMS}, got {uri!r}")
    numbers = {name: _number(uri, name, text) for name, text in parse_qsl(question, keep_blank_values=True)}
    return Address(kind, place, int(digits), **numbers)  # type: ignore[arg-type]


def _number(uri: str, name: str, text: str) -> int:
    if name not in LARGEST:
        raise ValueError(f"after the question mark come {', '.join(LARGEST)}, got {name!r} in {uri!r}")
    least = 0 if name == "mode" else 1
    if not (text.isascii() and text.isdecimal() and least <= int(text) <= LARGEST[name]):
        raise ValueError(f"{name} must be within {least} ... {LARGEST[name]}, got {text!r} in {uri!r}")
    return int(text)
