"""A camera that goes and comes back while a person looks: said in the page, and picked up by itself."""

import re
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from live_pages import WAIT, on_screen, wait_until, wait_until_compiled


def picture(number: int) -> npt.NDArray[np.uint8]:
    """A blue ball that moves a little."""
    image = np.full((240, 320, 3), 70, np.uint8)
    cv2.circle(image, (160 + number % 20, 120), 40, (200, 80, 30), cv2.FILLED, cv2.LINE_AA)
    return image


def test_a_camera_goes_and_comes_back(film: Any, serve: Any, page: Any) -> None:
    camera = film(picture)
    page.goto(serve(camera.url))
    wait_until(page, "picture.width === 320")
    wait_until_compiled(page)
    page.mouse.click(*on_screen(page, 165, 120))
    page.locator("#reading [data-name=x]").wait_for(timeout=WAIT)
    camera.stop()
    page.locator("#veil").get_by_text(re.compile("it is opened again")).wait_for(timeout=WAIT)
    page.locator("#reading").get_by_text(re.compile("^Lost")).wait_for(timeout=WAIT)
    assert page.locator("#targets li").count() == 1
    camera.start()
    page.locator("#veil").wait_for(state="hidden", timeout=WAIT)
    page.locator("#reading [data-name=x]").wait_for(timeout=WAIT)
