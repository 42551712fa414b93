"""Colors that tell vehicles and states apart, also for people who do not tell red from green."""

VEHICLES = ((213, 94, 0), (0, 114, 178), (0, 158, 115), (204, 121, 167), (230, 159, 0), (86, 180, 233))
"""RGB, in the order of the chain, then again from the first (Okabe & Ito)."""

PHASES = {
    "locked": (150, 150, 150),
    "flying": (70, 190, 110),
    "holding": (255, 190, 60),
    "descending": (255, 110, 60),
    "cut": (230, 50, 60),
}
"""RGB, by the phase of the safety."""


def vehicle_rgb(number: int) -> tuple[int, int, int]:
    """Color of a vehicle, counted from 0, as red, green, blue."""
    return VEHICLES[number % len(VEHICLES)]


def bgr(rgb: tuple[int, int, int]) -> tuple[int, int, int]:
    """Turn a color around, for OpenCV."""
    return rgb[2], rgb[1], rgb[0]


def as_hex(rgb: tuple[int, int, int]) -> str:
    """Write a color as ``#d55e00``."""
    return "#" + "".join(f"{part:02x}" for part in rgb)
