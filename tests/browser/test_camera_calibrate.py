"""Calibrating in the page: a board is held before a camera in the network; the file is saved, used and loaded."""

import math
import re
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt
import pytest

import matchset as ms
from boards import BoardCamera, poses
from live_pages import WAIT, on_screen, wait_until, wait_until_compiled
from matchset.camera.board import Board

CAMERA = ms.CameraModel.from_fov(320, 240, math.radians(60.0))
BOARD = Board(columns=7, rows=5, square=0.03)
RATE = 8.0  # pictures per second: in each the board is held otherwise


@pytest.fixture(scope="session")
def board_pictures() -> list[npt.NDArray[np.uint8]]:
    """A board, held all over the picture."""
    camera = BoardCamera(CAMERA, BOARD)
    return [camera.picture(*pose, seed=seed) for seed, pose in enumerate(poses(CAMERA, BOARD, 30, 4))]


def test_a_board_calibrates_the_camera(film: Any, serve: Any, page: Any, board_pictures: Any, tmp_path: Path) -> None:
    def picture(number: int) -> npt.NDArray[np.uint8]:
        return np.repeat(board_pictures[number % len(board_pictures)][:, :, None], 3, axis=2)

    camera = film(picture, RATE)
    page.goto(serve(camera.url))
    wait_until(page, "picture.width === 320")
    page.get_by_text("calibrate now, with a board").click()
    with page.expect_download() as loading:
        page.get_by_role("link", name="Letter").click()
    assert Path(loading.value.path()).read_bytes().startswith(b"%PDF")
    assert page.get_by_label("side of a square").input_value() == "24.5 mm"
    page.get_by_label("inner corners across").fill("nine")
    page.get_by_role("button", name="start").click()
    page.get_by_text("is no number of corners").wait_for()
    page.get_by_label("inner corners across").fill("7")
    page.get_by_label("inner corners down").fill("5")
    page.get_by_label("side of a square").fill("30 mm")
    page.get_by_role("button", name="start").click()
    page.locator("#board img").wait_for(timeout=WAIT)
    wait_until(page, "parseInt(document.querySelector('#board .soft.count').textContent) >= 9")
    page.get_by_role("button", name="that is all").click(timeout=WAIT)
    page.get_by_text(re.compile("The calibration is (good|usable|poor)")).wait_for(timeout=WAIT)
    assert page.locator("#board .verdict div").count() == 5
    with page.expect_download() as loading:
        page.get_by_role("link", name="camera.toml").click()
    loading.value.save_as(tmp_path / "loaded.toml")
    loaded = ms.CameraModel.load(tmp_path / "loaded.toml")
    assert loaded.fx == pytest.approx(CAMERA.fx, rel=0.03)
    assert (tmp_path / "runs" / "0001-calibrate" / "camera.toml").read_text() == (tmp_path / "loaded.toml").read_text()
    page.locator(".known").get_by_text(f"{loaded.fx:.1f}").wait_for(timeout=WAIT)


def test_a_camera_file_is_uploaded_and_another_is_refused(film: Any, serve: Any, page: Any, tmp_path: Path) -> None:
    CAMERA.save(tmp_path / "other.toml")
    (tmp_path / "camera-of-640.toml").touch()
    ms.CameraModel.from_fov(640, 480, 1.0).save(tmp_path / "camera-of-640.toml")
    (tmp_path / "broken.yaml").write_text("no camera")
    camera = film(lambda _: np.full((240, 320, 3), 80, np.uint8))
    page.goto(serve(camera.url))
    wait_until(page, "picture.width === 320")
    page.get_by_text("camera file", exact=True).click()
    page.locator("#camera-panel input[type=file]").set_input_files(tmp_path / "broken.yaml")
    page.locator("#camera-panel output").get_by_text("broken.yaml").wait_for(timeout=WAIT)
    page.get_by_role("button", name="camera-of-640.toml").click(timeout=WAIT)
    page.get_by_text("calibrate at the size").wait_for(timeout=WAIT)
    page.locator("#camera-panel input[type=file]").set_input_files(tmp_path / "other.toml")
    page.locator(".known").get_by_text("60.0° wide").wait_for(timeout=WAIT)


def test_a_ball_at_a_known_distance_tells_the_focal_length(film: Any, serve: Any, page: Any) -> None:
    image = np.full((240, 320, 3), 80, np.uint8)
    cv2.circle(image, (160 * 16, 120 * 16), 40 * 16, (200, 80, 30), cv2.FILLED, cv2.LINE_AA, 4)
    camera = film(lambda _: image)
    page.goto(serve(camera.url))
    wait_until(page, "picture.width === 320")
    page.get_by_text("the ball is at a known distance").click()
    distance = page.get_by_label("distance from the lens")
    distance.fill("1 m")
    page.keyboard.press("Enter")
    page.get_by_text("click the ball first").wait_for(timeout=WAIT)
    wait_until_compiled(page)
    page.mouse.click(*on_screen(page, 160, 120))
    page.fill(".diameter", "28 cm", timeout=WAIT)
    page.keyboard.press("Enter")
    page.get_by_text("positions in meters need it").wait_for(timeout=WAIT)
    distance.fill("86 cm")
    page.keyboard.press("Enter")
    page.get_by_text("px by the ball").wait_for(timeout=WAIT)
    page.locator("#reading [data-name=distance]").get_by_text("1.00").wait_for(timeout=WAIT)
