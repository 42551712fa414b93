"""Photograph the live page in Chromium: `python docs/pictures/live.py`, from the root of the repository."""

import io
import math
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from PIL import Image
from playwright.sync_api import Page, sync_playwright

import matchset as ms
from matchset.sim.clips.ball_flight_clip import BallFlightClip
from matchset.sim.clips.balloon import Balloon

CAMERA = ms.CameraModel.from_fov(640, 480, math.radians(60.0))
FRAMES, RATE = 300, 30.0
PLAYED = 5.0  # s of the video before the picture is taken
LARGEST = 200_000  # bytes
VIEWS: dict[str, dict[str, Any]] = {
    "live": {"viewport": {"width": 1280, "height": 900}, "color_scheme": "light"},
    "live_dark": {"viewport": {"width": 1280, "height": 900}, "color_scheme": "dark"},
    "live_phone": {"viewport": {"width": 390, "height": 844}, "color_scheme": "light", "device_scale_factor": 2},
}


def place(time: float) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Where the ball is, m: it swings and comes nearer."""
    return np.array((0.35 * math.sin(1.7 * time), 0.12 * math.cos(3.4 * time), 1.5 + 0.3 * math.cos(0.8 * time)))


def film(path: Path) -> None:
    """Render the video."""
    balloon = Balloon(marker_radius=0.0)
    clip = BallFlightClip(camera=CAMERA, place=place, balloon=balloon, frames=FRAMES, fps=RATE, preset="typical")
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), RATE, (640, 480))
    for frame in clip:
        writer.write(frame.image)
    writer.release()


def click_and_type(page: Page) -> None:
    """Do what a new user does: click the ball, type the field of view and its diameter."""
    page.locator("#file .play").wait_for()
    page.wait_for_timeout(3000)
    box = page.locator("#view").bounding_box()
    assert box is not None
    x, y = CAMERA.project(place(0.0)[None])[0]
    page.mouse.click(box["x"] + (x + 0.5) / 640 * box["width"], box["y"] + (y + 0.5) / 480 * box["height"])
    page.locator(".diameter").wait_for()
    page.fill("#fov", "60")
    page.keyboard.press("Enter")
    page.fill(".diameter", "28 cm")
    page.keyboard.press("Enter")
    page.locator("#reading [data-name=distance]").wait_for()


def photograph(page: Page, target: Path) -> None:
    """Play some seconds, stop, and write what is on the screen."""
    page.locator("#file .play").click()
    page.wait_for_timeout(1000.0 * PLAYED)
    page.locator("#file .play").click()
    page.wait_for_timeout(1500)
    page.evaluate("scrollTo(0, 0)")
    picture = Image.open(io.BytesIO(page.screenshot()))
    picture.convert("RGB").save(target, quality=82, method=6)
    print(f"{target.name}: {target.stat().st_size / 1e3:.0f} KB")
    if target.stat().st_size > LARGEST:
        raise SystemExit(f"{target.name} is larger than {LARGEST / 1e3:g} KB")


def main() -> None:
    """Write the pictures beside this file."""
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as driver:
        film(Path(folder) / "ball.avi")
        command = [sys.executable, "-m", "matchset.cli", "live", "ball.avi", "--no-browser", "--port", "0"]
        with subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, text=True) as server:
            assert server.stdout is not None
            address = server.stdout.readline().strip()
            browser = driver.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
            for name, view in VIEWS.items():
                page = browser.new_context(**view).new_page()
                page.goto(address)
                if name == "live":
                    click_and_type(page)
                photograph(page, Path(__file__).parent / f"{name}.webp")
                page.context.close()
            browser.close()
            server.terminate()


if __name__ == "__main__":
    main()
