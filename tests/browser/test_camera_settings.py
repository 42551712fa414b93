"""The camera's settings in the page; the camera is a fake in the place of OpenCV's capture."""

import contextlib
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from live_pages import WAIT, wait_until

PROGRAM = Path(__file__).resolve().parents[1] / "fake_camera_live.py"


@pytest.fixture
def camera(tmp_path: Path, warm: None) -> Iterator[tuple[str, Path]]:
    """`matchset live 0` with a camera that is there while a file is: its address, that file."""
    (tmp_path / "plug").touch()
    with shown(tmp_path) as address:
        yield address, tmp_path / "plug"


@pytest.fixture
def taken(tmp_path: Path, warm: None) -> Iterator[tuple[str, Path]]:
    """The same with a camera that cannot be opened."""
    with shown(tmp_path) as address:
        yield address, tmp_path / "plug"


@contextlib.contextmanager
def shown(tmp_path: Path) -> Iterator[str]:
    """Run `matchset live 0`; returns its address."""
    plug = tmp_path / "plug"
    command = [sys.executable, str(PROGRAM), "live", "0", "--no-browser", "--port", "0"]
    environment = {**os.environ, "MATCHSET_FAKE_CAMERA": str(plug)}
    server = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=tmp_path, env=environment)
    assert server.stdout is not None
    yield server.stdout.readline().strip()
    server.terminate()
    server.wait(10)
    server.stdout.close()


def test_a_camera_that_cannot_be_opened_is_said_and_picked_up_when_it_can(taken: Any, page: Any) -> None:
    address, plug = taken
    page.goto(address)
    said = page.locator("#veil").get_by_text(re.compile("cannot open camera 0.*tried again every 1 s"))
    said.wait_for(timeout=WAIT)
    plug.touch()  # as when another program lets go of it
    wait_until(page, "veil.hidden && picture.width === 320")


def test_settings_are_shown_set_and_refused(camera: tuple[str, Path], page: Any) -> None:
    address, plug = camera
    page.goto(address)
    wait_until(page, "picture.width === 320")
    page.get_by_text("camera settings").click()
    exposure = page.locator("form[data-name=exposure]")
    exposure.get_by_text("the camera chooses: 156").wait_for(timeout=WAIT)
    page.get_by_text("no setting of its gain").wait_for(timeout=WAIT)
    for typed, said in (("500", "the camera says 500"), ("5000", "asked for 5000, the driver says 2047")):
        exposure.get_by_role("textbox").fill(typed)
        page.keyboard.press("Enter")
        exposure.get_by_text(said).wait_for(timeout=WAIT)
    exposure.get_by_role("textbox").fill("abc")
    page.keyboard.press("Enter")
    exposure.get_by_text("is no number").wait_for(timeout=WAIT)
    exposure.get_by_text("automatic").click()
    exposure.get_by_text("the camera chooses").wait_for(timeout=WAIT)
    size = page.locator("form[data-name=size]")
    size.get_by_role("combobox").select_option("640x480")
    wait_until(page, "picture.width === 640")
    size.get_by_role("combobox").select_option("1920x1080")
    size.get_by_text("asked for 1920, the driver says 640").wait_for(timeout=WAIT)
    plug.unlink()
    page.locator("#veil").get_by_text(re.compile("tried again")).wait_for(timeout=WAIT)
    plug.touch()
    page.locator("#veil").wait_for(state="hidden", timeout=WAIT)
