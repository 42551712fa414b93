"""Where things are on the live page."""

from typing import Any


def on_screen(page: Any, x: float, y: float) -> tuple[float, float]:
    """Where a point of the picture is on the screen, CSS px."""
    box = page.locator("#view").bounding_box()
    width, height = page.evaluate("[picture.width, picture.height]")
    return box["x"] + (x + 0.5) / width * box["width"], box["y"] + (y + 0.5) / height * box["height"]
