"""Colors of vehicles and of the phases of the safety filter, told apart also by people who see no red or green."""

# format: RGB, in the order of the chain, then again from the first (Okabe & Ito)
VEHICLE_COLORS = ((213, 94, 0), (0, 114, 178), (0, 158, 115), (204, 121, 167), (230, 159, 0), (86, 180, 233))

# format: RGB, by phase of the safety filter
PHASE_COLORS = {
    "locked": (150, 150, 150),
    "flying": (70, 190, 110),
    "holding": (255, 190, 60),
    "descending": (255, 110, 60),
    "cut": (230, 50, 60),
}


def vehicle_rgb(number: int) -> tuple[int, int, int]:
    """Color of a vehicle, counted from 0, as red, green, blue."""
    return VEHICLE_COLORS[number % len(VEHICLE_COLORS)]


def bgr(rgb: tuple[int, int, int]) -> tuple[int, int, int]:
    """Reverse the order of the channels, for OpenCV."""
    return rgb[2], rgb[1], rgb[0]


def as_hex(rgb: tuple[int, int, int]) -> str:
    """Write a color as ``#d55e00``."""
    return "#" + "".join(f"{part:02x}" for part in rgb)
