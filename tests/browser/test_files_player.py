"""A recorded video in the page: scrubbed, stepped by keys, clicked in the middle, tracked whole, its table loaded."""

import math
import re
from pathlib import Path
from typing import Any

import pytest

from live_clips import FRAMES, LAST, PERIOD
from live_pages import WAIT, on_screen, wait_until
from matchset.app.locate.rows import read_poses
from matchset.app.track.rows import read_tracks
from matchset.sim.clips.ball_flight_clip import BallFlightClip

Clip = tuple[Path, BallFlightClip]
SHOWN = "Number(document.querySelector('#file .timeline').getAttribute('aria-valuenow'))"


def state_of(page: Any) -> Any:
    """What the server says is shown."""
    return page.evaluate("fetch('state.json').then((answer) => answer.json())")


def index_of(page: Any) -> int:
    """Index of the frame that the page says is shown."""
    return int(re.findall(r"frame (\d+)", page.locator("#file .time").inner_text())[0])


def go(page: Any, index: int) -> None:
    """Scrub to a frame by a click on the time line, then by keys."""
    line = page.locator("#file .timeline")
    box, (end,) = line.bounding_box(), re.findall(r"of (\d+)", page.locator("#file .time").inner_text())
    line.click(position={"x": (index + 0.5) / (int(end) + 1) * box["width"], "y": box["height"] / 2})
    wait_until(page, f"Math.abs({SHOWN} - {index}) < 3")
    while (left := index - index_of(page)) != 0:
        page.keyboard.press("ArrowRight" if left > 0 else "ArrowLeft")
        before = index - left
        wait_until(page, f"{SHOWN} !== {before}")
    wait_until(page, f"fetch('state.json').then((a) => a.json()).then((s) => s.streams[0].index === {index})")


def click_ball(page: Any, clip: BallFlightClip) -> None:
    shown = state_of(page)["streams"][0]["time"]
    (pixel,) = clip.camera.project(clip.place(shown)[None])
    page.mouse.click(*on_screen(page, *pixel))


def distance_to(page: Any, pixel: Any) -> float:
    """How far from a pixel the target is that is shown, px; infinite where none is found."""
    (target,) = state_of(page)["streams"][0]["targets"]
    if not target["found"]:
        return math.inf
    return math.dist((target["values"]["x"][0], target["values"]["y"][0]), pixel)


def file_of(page: Any) -> Any:
    """What the server says of the file."""
    return state_of(page)["session"]["panels"]["file"]


def line_of(page: Any) -> Any:
    """What the server says of the target on the time line."""
    (line,) = file_of(page)["targets"]
    return line


def pause(page: Any) -> None:
    """Stop at the frame that is shown; on a busy computer it has come to the end by itself."""
    if file_of(page).get("playing"):
        page.keyboard.press("Space")
    wait_until(page, lambda: not file_of(page).get("playing"))


@pytest.fixture
def opened(show: Any, page: Any, clip: Clip) -> Any:
    """A page that shows the clip, read to its end."""
    page.goto(show(str(clip[0])))
    page.locator("#file .time").get_by_text(f"of {LAST}").wait_for(timeout=WAIT)
    wait_until(page, "picture.width === 320")
    page.locator("#file-results .work").get_by_text("Click the ball in any frame").wait_for(timeout=WAIT)
    return page


def test_scrubbing_keys_and_space(opened: Any) -> None:
    page = opened
    go(page, 120)
    for key, index in (("ArrowRight", 121), ("ArrowLeft", 120), (".", 121), (",", 120), ("Shift+ArrowRight", 130)):
        page.keyboard.press(key)
        wait_until(page, f"document.querySelector('#file .timeline').getAttribute('aria-valuenow') === '{index}'")
    page.keyboard.press("End")
    page.get_by_text(f"frame {LAST} of {LAST}").wait_for(timeout=WAIT)
    page.keyboard.press("Home")
    page.get_by_text(f"frame 0 of {LAST}").wait_for(timeout=WAIT)
    page.locator("#file button.forward").click()
    page.get_by_text(f"frame 1 of {LAST}").wait_for(timeout=WAIT)
    page.locator("#file button.back").click()
    page.get_by_text(f"frame 0 of {LAST}").wait_for(timeout=WAIT)
    page.locator("#file .speed").select_option("4")
    page.locator("#view").focus()
    page.keyboard.press("Space")
    page.get_by_role("button", name="pause (space)").wait_for(timeout=WAIT)
    wait_until(page, "Number(document.querySelector('#file .timeline').getAttribute('aria-valuenow')) > 30")
    page.keyboard.press("Space")
    page.get_by_role("button", name="play (space)").wait_for(timeout=WAIT)
    before = state_of(page)["streams"][0]["index"]
    page.get_by_text(f"frame {before} of {LAST}").wait_for(timeout=WAIT)
    page.wait_for_timeout(600)
    assert index_of(page) == before
    assert page.locator("#veil").is_hidden()  # a picture that stands is no fault


def test_a_click_in_the_middle_is_tracked_to_both_ends_and_loaded(opened: Any, clip: Clip, tmp_path: Path) -> None:
    page, (_, truth) = opened, clip
    go(page, FRAMES)
    click_ball(page, truth)
    page.locator("#file-results .work").get_by_text("100 % tracked").wait_for(timeout=WAIT)
    page.locator("#file-results .work").get_by_text(f"found in {LAST + 1}, lost in 0").wait_for(timeout=WAIT)
    page.fill("#fov", "60")
    page.keyboard.press("Enter")
    page.fill(".diameter", "28 cm")
    page.keyboard.press("Enter")
    page.locator("#reading [data-name=distance]").wait_for(timeout=WAIT)
    wait_until(page, "fetch('course.json?target=1').then((a) => a.json()).then((c) => c.whole && c.placed)")
    curve = page.locator("#file-curves canvas").first

    def click_leads_there() -> bool:
        """The curves become narrower when meters come: each click takes their place anew."""
        curve.scroll_into_view_if_needed()
        box = curve.bounding_box()
        page.mouse.click(box["x"] + 0.75 * box["width"], box["y"] + 0.5 * box["height"])
        place = page.locator("#file .timeline").get_attribute("aria-valuenow")
        return abs(float(place) - 168) < 24

    wait_until(page, click_leads_there)

    def value_is_there() -> bool:
        """Values stand above the curve while the pointer is on it."""
        box = curve.bounding_box()
        page.mouse.move(box["x"] + 0.75 * box["width"], box["y"] + 0.4 * box["height"])
        words = page.locator("#file-curves figure.curve output").first.inner_text()
        return re.match(r"\d\.\d\d s: x -?0\.\d+ ±0\.\d+ m$", words) is not None

    wait_until(page, value_is_there)
    page.get_by_role("button", name="CSV tables").click()
    files = {}
    for name in ("tracks-1.csv", "poses-1.csv"):
        with page.expect_download(timeout=WAIT) as download:
            page.get_by_role("link", name=name).click(timeout=WAIT)
        files[name] = tmp_path / name
        download.value.save_as(files[name])
    tracks, poses = read_tracks(files["tracks-1.csv"]), read_poses(files["poses-1.csv"])
    assert [row.frame for row in tracks] == [row.frame for row in poses] == list(range(LAST + 1))
    for row in poses:
        right = truth.place(row.time)
        assert row.values is not None
        distance = math.dist([row.values[name] for name in "xyz"], right.tolist())
        assert distance < 0.01 * float(math.hypot(*right)), row
    page.get_by_role("button", name="annotated video").click()
    link = page.get_by_role("link", name=re.compile(r"annotated-1\.(mp4|webm)"))
    link.wait_for(timeout=3 * WAIT)
    with page.expect_download(timeout=WAIT) as download:
        link.click()
    assert download.value.path().stat().st_size > 10_000


def test_a_thumb_scrubs_on_a_phone(show: Any, new_page: Any, clip: Clip) -> None:
    page = new_page(viewport={"width": 390, "height": 844}, has_touch=True)
    page.goto(show(str(clip[0])))
    page.locator("#file .time").get_by_text(f"of {LAST}").wait_for(timeout=WAIT)
    line = page.locator("#file .timeline")
    line.scroll_into_view_if_needed()
    box = line.bounding_box()
    assert box["x"] >= 0
    assert box["x"] + box["width"] <= 390
    page.touchscreen.tap(box["x"] + 0.25 * box["width"], box["y"] + 0.5 * box["height"])
    wait_until(page, "Math.abs(document.querySelector('#file .timeline').getAttribute('aria-valuenow') - 60) < 3")
    page.locator("#file button.forward").tap()
    assert page.evaluate("document.documentElement.scrollWidth") <= 390


def test_lost_stretches_are_told_and_the_reading_follows_the_frame(
    show: Any, page: Any, leaving_clip: Clip, tmp_path: Path
) -> None:
    path, truth = leaving_clip
    page.goto(show(str(path)))
    page.locator("#file .time").get_by_text(f"of {LAST}").wait_for(timeout=WAIT)
    wait_until(page, "picture.width === 320")
    click_ball(page, truth)
    page.locator("#file-results .work").get_by_text("100 % tracked").wait_for(timeout=3 * WAIT)
    pause(page)
    lost = int(re.findall(r"lost in (\d+)", page.locator("#file-results .work").inner_text())[0])
    assert 60 < lost < 160
    go(page, 180)  # 2 s after the path has begun anew: the ball is far outside
    page.locator("#reading").get_by_text(re.compile("^Lost")).wait_for(timeout=WAIT)
    go(page, FRAMES + 5)
    page.locator("#reading [data-name=radius], #reading [data-name=r]").wait_for(timeout=WAIT)
    page.get_by_role("button", name="correct …").click()
    page.get_by_text("Click the middle of circle 1").wait_for(timeout=WAIT)
    before = line_of(page)["version"]
    click_ball(page, truth)
    wait_until(page, lambda: line_of(page)["version"] > before and line_of(page)["percent"] == 100.0)
    (pixel,) = truth.camera.project(truth.place((FRAMES + 5) * PERIOD / FRAMES)[None])
    wait_until(page, lambda: distance_to(page, pixel) < 1.0)


def test_the_color_is_shown_while_it_plays_and_where_it_stands(opened: Any, clip: Clip) -> None:
    page = opened
    answers: list[int] = []
    page.on("response", lambda answer: answers.append(answer.status) if "mask.png" in answer.url else None)
    go(page, FRAMES)
    click_ball(page, clip[1])
    page.locator("#file-results .work").get_by_text("100 % tracked").wait_for(timeout=WAIT)
    page.get_by_label("color", exact=True).check()  # it stands: no new picture comes
    page.locator("#mask").wait_for(state="visible", timeout=WAIT)
    answers.clear()
    page.keyboard.press("Space") if page.evaluate("document.activeElement.id") == "view" else page.locator(
        ".play"
    ).click()
    wait_until(page, lambda: len(answers) > 20)
    assert answers.count(200) >= 0.95 * len(answers)
    assert page.locator("#mask").is_visible()
    page.get_by_label("color", exact=True).uncheck()
    page.locator("#mask").wait_for(state="hidden", timeout=WAIT)


def test_the_trail_is_of_pictures_that_follow_each_other(opened: Any, clip: Clip) -> None:
    page = opened
    trail = "document.querySelector('#drawing .trail')?.getAttribute('d') || ''"
    go(page, FRAMES)
    click_ball(page, clip[1])
    page.locator("#file-results .work").get_by_text("100 % tracked").wait_for(timeout=WAIT)
    pause(page)
    for index in (20, 26, 33):  # less than the length of a trail apart
        go(page, index + 4)
        page.keyboard.press("Shift+ArrowLeft")
        wait_until(page, f"{SHOWN} === {index - 6}")
    assert page.evaluate(f"({trail}).split('L').length") == 1  # one point: nothing is drawn between the places
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowRight")
    wait_until(page, f"({trail}).split('L').length > 1")


def test_a_file_has_a_header_of_its_own_and_a_part_says_which(show: Any, page: Any, clip: Clip) -> None:
    page.goto(show(str(clip[0])))
    wait_until(page, "picture.width === 320")
    wait_until(page, "document.querySelector('#of-rate').textContent === 'video'")
    assert page.locator("#age").is_hidden()
    assert page.locator("#dropped").is_hidden()
    page.evaluate(
        """() => import('/file/files.js').then(({ FilePanel }) => {
          const places = [0, 1, 2].map(() => document.body.appendChild(document.createElement('div')));
          const panel = new FilePanel(...places, () => {}, () => 1, () => {});
          const line = { id: 1, name: 'circle 1', line: [1, 10], percent: 57.3, part: 'frames 3 to 12', version: 1 };
          panel.update({ last: 20, end: 99, index: 0, time: 0, duration: 0.7, targets: [line], written: [] });
          window.made = places.map((place) => place.innerText);
        })"""
    )
    transport, results, _ = page.evaluate("window.made")
    assert "21 % read" in transport
    assert "CSV of this part" in results
    assert "frames 3 to 12 alone, 57 % of the video" in results
