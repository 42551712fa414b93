"""Where things are on the live page."""

import time
from typing import Any


def on_screen(page: Any, x: float, y: float) -> tuple[float, float]:
    """Where a point of the picture is on the screen, CSS px."""
    box = page.locator("#view").bounding_box()
    width, height = page.evaluate("[picture.width, picture.height]")
    return box["x"] + (x + 0.5) / width * box["width"], box["y"] + (y + 0.5) / height * box["height"]


def wait_until(page: Any, condition: str, seconds: float = 20.0) -> None:
    """Wait for a condition in JavaScript; asked from outside, since the page evaluates no text by itself."""
    end = time.monotonic() + seconds
    while not page.evaluate(condition):
        assert time.monotonic() < end, f"not within {seconds} s: {condition}"
        page.wait_for_timeout(50)


def rows(page: Any) -> list[str]:
    """Names in the list of targets."""
    names: list[str] = page.locator("#targets .name").all_inner_texts()
    return [name.strip() for name in names]


def state_of(page: Any) -> Any:
    """What the server says of the first stream now."""
    return page.evaluate("fetch('state.json').then((answer) => answer.json())")["streams"][0]
