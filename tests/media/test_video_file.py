"""Video files: every frame, broken ones counted, time forward."""

import os
import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt
import pytest

from matchset.media.video import Video

FRAMES, FPS, WIDTH, HEIGHT = 20, 25.0, 160, 120
Picture = npt.NDArray[np.uint8]


def shade(index: int) -> int:
    """Gray value by which a test knows its frame again."""
    return 10 + index * 10


def picture(index: int) -> Picture:
    noise = np.random.default_rng(index).integers(-6, 7, (HEIGHT, WIDTH, 3))
    return (shade(index) + noise).astype(np.uint8)


def index_of(image: Picture) -> int:
    return round((float(image.mean()) - 10) / 10)


def written(path: Path, codec: str) -> Path:
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*codec), FPS, (WIDTH, HEIGHT))
    assert writer.isOpened()
    for index in range(FRAMES):
        writer.write(picture(index))
    writer.release()
    return path


def spoiled(path: Path, broken: list[int]) -> Path:
    """Motion-JPEG file with the pictures of these frames overwritten by zeros."""
    data = bytearray(path.read_bytes())
    starts, at = [], data.find(b"\xff\xd8\xff")
    while at >= 0:
        starts.append(at)
        at = data.find(b"\xff\xd8\xff", at + 1)
    assert len(starts) == FRAMES
    for frame in broken:
        size = int.from_bytes(data[starts[frame] - 4 : starts[frame]], "little")
        data[starts[frame] : starts[frame] + size] = bytes(size)
    result = path.with_name("spoiled.avi")
    result.write_bytes(data)
    return result


@pytest.fixture(scope="module")
def avi(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return written(tmp_path_factory.mktemp("avi") / "clip.avi", "MJPG")


@pytest.mark.parametrize(("name", "codec"), [("clip.avi", "MJPG"), ("clip.mp4", "mp4v"), ("clip.mp4", "vp09")])
def test_a_file_delivers_every_frame_in_order(tmp_path: Path, name: str, codec: str) -> None:
    with Video(written(tmp_path / name, codec)) as video:
        assert (video.width, video.height, video.channels) == (WIDTH, HEIGHT, 3)
        assert (video.fps, video.length, video.live) == (FPS, FRAMES, False)
        frames = list(video)
    assert [frame.index for frame in frames] == list(range(FRAMES))
    assert [index_of(frame.image) for frame in frames] == list(range(FRAMES))
    np.testing.assert_allclose([frame.time for frame in frames], np.arange(FRAMES) / FPS, atol=1e-6)
    assert (video.broken, video.dropped, video.warnings, video.settings) == (0, 0, [], {})


@pytest.mark.parametrize("broken", [[7], [0], [3, 4, 5], list(range(1, 12))])
def test_broken_frames_are_skipped_counted_and_keep_their_number(avi: Path, broken: list[int]) -> None:
    with Video(spoiled(avi, broken)) as video:
        frames = list(video)
        assert video.length == FRAMES
    expected = [index for index in range(FRAMES) if index not in broken]
    assert [frame.index for frame in frames] == expected
    assert [index_of(frame.image) for frame in frames] == expected
    np.testing.assert_allclose([frame.time for frame in frames], np.array(expected) / FPS, atol=1e-6)
    assert video.broken == len(broken)
    assert video.warnings == [f"{len(broken)} broken frame{'s' * (len(broken) > 1)} skipped"]


def test_a_file_cut_short_says_so(avi: Path, tmp_path: Path) -> None:
    cut = tmp_path / "cut.avi"
    cut.write_bytes(avi.read_bytes()[: avi.stat().st_size * 6 // 10])
    with Video(cut) as video:
        count = len(list(video))
    assert 5 < count < FRAMES
    assert video.warnings == [f"the file announces {FRAMES} frames, it ends after {count}"]


class Stamps:
    """Capture of eight pictures with the time stamps of a test, ms."""

    def __init__(self, stamps: list[float], fps: float = 10.0, failures: int = 0) -> None:
        self.stamps, self.fps, self.at, self.failures = stamps, fps, -1, failures

    def isOpened(self) -> bool:  # noqa: N802 - OpenCV's name
        return True

    def grab(self) -> bool:
        self.at += 1
        return self.at < len(self.stamps)

    def retrieve(self) -> tuple[bool, Picture | None]:
        if self.at < self.failures:
            return False, None
        return True, np.zeros((4, 6, 1), np.uint8)

    def get(self, name: int) -> float:
        values = {cv2.CAP_PROP_FRAME_COUNT: -9.2e18, cv2.CAP_PROP_FPS: self.fps}
        if name in (cv2.CAP_PROP_ORIENTATION_META, cv2.CAP_PROP_SAR_NUM, cv2.CAP_PROP_SAR_DEN):
            return 0.0
        return values.get(name, self.stamps[min(self.at, len(self.stamps) - 1)])

    def set(self, *_: float) -> bool:
        return False

    def release(self) -> None:
        self.stamps = [0.0]


@pytest.mark.parametrize(
    ("stamps", "fps", "expected", "warnings"),
    [
        ([0, 90, 210, 300], 10.0, [0.0, 0.09, 0.21, 0.3], 0),
        (
            [0, 300, 100, 200],
            10.0,
            [0.0, 0.1, 0.2, 0.3],
            1,
        ),  # the order in which packets came, not the pictures
        ([0, 0, 0, 0], 10.0, [0.0, 0.1, 0.2, 0.3], 1),
        ([0, 1, 2, 3], 90000.0, [0.0, 0.001, 0.002, 0.003], 1),  # a time base given for a rate
        ([0, 0, 0, 0], 0.0, [0.0, 1 / 30, 2 / 30, 3 / 30], 1),
        ([float("nan")] * 4, 10.0, [0.0, 0.1, 0.2, 0.3], 1),
        ([100.0 * i for i in range(17)] + [500.0, 2000.0], 10.0, [*(0.1 * i for i in range(18)), 2.0], 1),
    ],
)
def test_time_runs_forward_whatever_the_file_says(
    avi: Path,
    monkeypatch: pytest.MonkeyPatch,
    stamps: list[float],
    fps: float,
    expected: list[float],
    warnings: int,
) -> None:
    monkeypatch.setattr("matchset.media.video_files.video_file.open_capture", lambda _: Stamps(list(stamps), fps))
    with Video(avi) as video:
        frames = list(video)
    np.testing.assert_allclose([frame.time for frame in frames], expected)
    assert len(video.warnings) == warnings
    assert video.length is None
    assert frames[0].image.shape == (4, 6)


def test_a_picture_that_was_grabbed_but_does_not_unpack_is_broken(avi: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        "matchset.media.video_files.video_file.open_capture", lambda _: Stamps([0, 100, 200, 300], failures=2)
    )
    with Video(avi) as video:
        assert [(frame.index, frame.time) for frame in video] == [(2, 0.2), (3, 0.3)]
    assert video.broken == 2


def test_frames_do_not_share_memory(avi: Path) -> None:
    with Video(avi) as video:
        frames = list(video)
    frames[3].image[:] = 0
    assert index_of(frames[2].image) == 2
    assert index_of(frames[4].image) == 4


def test_a_file_without_one_good_frame_is_refused(avi: Path) -> None:
    with pytest.raises(ValueError, match=r"no frame of .*spoiled\.avi could be decoded"):
        Video(spoiled(avi, list(range(FRAMES))))


SILENT = """
import sys
from matchset.image.errors import LinkError
from matchset.media.video import Video
for source in sys.argv[1:]:
    try:
        with Video(source) as video:
            print(len(list(video)), video.broken)
    except (ValueError, LinkError) as error:
        print(type(error).__name__)
"""


def test_opencv_and_ffmpeg_say_nothing_on_the_terminal(avi: Path, tmp_path: Path) -> None:
    (tmp_path / "text.mp4").write_text("hello\n" * 1000)
    sources = [str(spoiled(avi, [4, 9])), str(tmp_path / "text.mp4"), str(tmp_path / "none.mp4"), "97"]
    quiet = {name: value for name, value in os.environ.items() if not name.startswith("OPENCV_")}
    # in a process of its own: FFmpeg takes its level from the first video that the process opens
    run = subprocess.run(
        [sys.executable, "-c", SILENT, *sources], capture_output=True, text=True, env=quiet, check=True
    )
    assert run.stdout.split("\n")[:4] == ["18 2", "ValueError", "MissingFileError", "LinkError"]
    assert run.stderr == ""
