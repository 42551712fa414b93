"""A person records a stretch of a video, and loads its table."""

import re
from pathlib import Path
from typing import Any

import pytest

from live_pages import WAIT, on_screen, wait_until
from matchset.app.track.rows import read_tracks
from matchset.sim.clips.ball_flight_clip import BallFlightClip


def test_a_recording_is_loaded_when_it_has_ended(
    serve: Any, page: Any, clip: tuple[Path, BallFlightClip], tmp_path: Path
) -> None:
    path, truth = clip
    page.goto(serve(str(path)))
    wait_until(page, "picture.width === 320")
    shown = page.evaluate("fetch('state.json').then((answer) => answer.json())")["streams"][0]["time"]
    (pixel,) = truth.camera.project(truth.place(shown)[None])
    page.mouse.click(*on_screen(page, *pixel))
    page.locator("#reading [data-name=x]").wait_for(timeout=WAIT)
    button = page.locator("#record button")
    button.click()
    page.locator("#record").get_by_text(re.compile(r"^0:0[1-9] · \d+\.\d MB")).wait_for(timeout=WAIT)
    assert button.inner_text() == "Stop recording"
    button.click()
    link = page.get_by_role("link", name="tracks.csv", exact=True)
    link.wait_for(timeout=WAIT)
    assert button.inner_text() == "Record"
    with page.expect_download() as download:
        link.click()
    assert download.value.suggested_filename == "0001-live-tracks.csv"
    rows = read_tracks(download.value.path())
    assert len(rows) > 10
    for row in rows:
        assert row.shape is not None
        (pixel,) = truth.camera.project(truth.place(row.time)[None])
        assert (row.shape["x"], row.shape["y"]) == pytest.approx(tuple(pixel), abs=2.0)
    names = {each.name for each in (tmp_path / "runs" / "0001-live").iterdir()}
    assert {"tracks.csv", "recording.json"} < names


def test_elsewhere_the_page_says_that_others_can_listen(serve: Any, page: Any) -> None:
    address = serve("--lan")
    page.goto(address)
    assert "token" not in page.url
    here = re.match(r"http://(127\.0\.0\.1|localhost)", page.url) is not None
    assert page.locator("#plain").is_hidden() == here
