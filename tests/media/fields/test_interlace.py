"""Whether pictures are interlaced, and which field is first, is told by what moves in them."""

from collections.abc import Callable, Iterable
from pathlib import Path

import cv2
import msgspec
import numpy as np
import numpy.typing as npt
import pytest

from interlaced_videos import Pictures, ball_clip, pictures_of, upside_down
from matchset.media.fields.interlace import FieldEvidence, Fields
from matchset.sim.analog_link import BAD, CLEAN, TYPICAL

DATA = Path(__file__).resolve().parents[4] / "shared" / "data"
PROGRESSIVE = msgspec.structs.replace(TYPICAL, interlaced=False)


def verdict_of(pictures: Iterable[npt.NDArray[np.uint8]]) -> Fields | None:
    evidence = FieldEvidence()
    for picture in pictures:
        evidence.add(picture)
    return evidence.verdict


def packed(pictures: Pictures, quality: int) -> Pictures:
    coded = [cv2.imencode(".jpg", picture, [cv2.IMWRITE_JPEG_QUALITY, quality])[1] for picture in pictures]
    return tuple(np.asarray(cv2.imdecode(each, cv2.IMREAD_COLOR), np.uint8) for each in coded)


def gray(pictures: Pictures) -> Pictures:
    return tuple(np.ascontiguousarray(picture[..., 1]) for picture in pictures)


@pytest.mark.parametrize("seed", [41, 42, 43])
def test_the_order_of_the_fields_is_found(seed: int) -> None:
    pictures = pictures_of(ball_clip(seed=seed))
    assert verdict_of(pictures) == "top"
    assert verdict_of(upside_down(pictures)) == "bottom"
    assert verdict_of(gray(pictures)) == "top"


def test_a_bad_link_takes_more_frames() -> None:
    pictures = pictures_of(ball_clip(BAD, frames=60, speed=4.0))
    assert verdict_of(pictures) == "top"
    assert verdict_of(upside_down(pictures)) == "bottom"


def test_the_order_is_found_behind_a_codec() -> None:
    pictures = packed(pictures_of(ball_clip()), 50)
    assert verdict_of(pictures) == "top"
    assert verdict_of(upside_down(pictures)) == "bottom"


@pytest.mark.parametrize("link", [CLEAN, PROGRESSIVE])
@pytest.mark.parametrize("change", [upside_down, gray, lambda pictures: packed(pictures, 20)])
def test_progressive_pictures_are_not_interlaced(link: object, change: Callable[[Pictures], Pictures]) -> None:
    assert verdict_of(change(pictures_of(ball_clip(link)))) == "frames"  # type: ignore[arg-type]


def test_one_field_on_both_is_not_interlaced() -> None:
    doubled = [np.repeat(picture[0::2], 2, axis=0) for picture in pictures_of(ball_clip())]
    assert verdict_of(doubled) in ("frames", None)


@pytest.mark.parametrize("blur", [2.0, 5.0, 12.0])
def test_blurred_pictures_of_a_camera_in_a_hand_are_not_interlaced(blur: float) -> None:
    room = ball_clip(CLEAN, frames=1).background()
    soft = cv2.GaussianBlur(room, (0, 0), blur)
    rng, place, pictures = np.random.default_rng(5), np.zeros(2), list[npt.NDArray[np.uint8]]()
    for _ in range(20):
        place += 5.0 * rng.standard_normal(2)
        move = np.array(((1.0, 0.0, place[0]), (0.0, 1.0, place[1])))
        shaken = cv2.warpAffine(soft, move, (320, 240), borderMode=cv2.BORDER_REFLECT)
        pictures.append(np.clip(shaken + 2.0 * rng.standard_normal(shaken.shape), 0, 255).astype(np.uint8))
    assert verdict_of(pictures) in ("frames", None)


def test_still_pictures_tell_nothing() -> None:
    picture = pictures_of(ball_clip())[0]
    rng = np.random.default_rng(1)
    noisy = [np.clip(picture + 4.0 * rng.standard_normal(picture.shape), 0, 255).astype(np.uint8) for _ in range(20)]
    assert verdict_of([picture] * 20) is None
    assert verdict_of(noisy) is None


def test_pictures_that_are_too_small_or_change_tell_nothing() -> None:
    rng = np.random.default_rng(1)
    assert verdict_of(rng.integers(0, 256, (10, 12, 12, 3), np.uint8)) is None
    sizes = [(120, 160), (240, 320)] * 8
    assert verdict_of([rng.integers(0, 256, size, np.uint8) for size in sizes]) is None


@pytest.mark.parametrize(
    "name",
    [
        "green_ball_hand/video.mp4",
        "yellow_occlusion/video.avi",
        "unlabelled/green_hand_a.mp4",
        "unlabelled/green_hand_b.mp4",
        "unlabelled/green_thrown.mp4",
        "unlabelled/green_throw.mp4",
        "unlabelled/red_pendulum.mp4",
        "stills/box.mp4",
    ],
)
def test_real_clips_are_progressive(name: str) -> None:
    path = DATA / name
    if not path.exists():
        pytest.skip(f"{path} is not there")
    capture, evidence = cv2.VideoCapture(str(path)), FieldEvidence()
    while evidence.verdict is None and capture.grab():
        evidence.add(np.asarray(capture.retrieve()[1], np.uint8))
    capture.release()
    assert evidence.verdict == "frames"
