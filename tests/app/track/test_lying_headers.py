"""Every command before a header that lies, and before a video of which every second picture is damaged."""

from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import pytest

from blue_ball import Matchset
from matchset.app.locate.rows import read_poses
from matchset.app.track.rows import read_tracks
from matchset.live.files.file_feed import FileFeed
from matchset.live.sources.found_sources import Source
from matchset.live.sources.opening import Opening, open_feed
from shown_clips import access_units, ball_picture, with_matrix, with_ratio, write_clip

PICTURES = [ball_picture((240, 180), (60.0 + 2 * k, 90.0, 30.0)) for k in range(6)]


def ratio(wide: int, high: int) -> Callable[[Path], Path]:
    def made(folder: Path) -> Path:
        return with_ratio(write_clip(folder / "clip.mp4", [PICTURES], ratio=Fraction(1001, 1000)), wide, high)

    return made


def no_matrix(folder: Path) -> Path:
    return with_matrix(write_clip(folder / "clip.mp4", [PICTURES]), (0, 0, 0, 0))


def half_damaged(folder: Path) -> Path:
    """Raw H.264; of every second picture the second half is missing."""
    units = access_units(PICTURES)
    path = folder / "clip.h264"
    path.write_bytes(b"".join(unit[: len(unit) // 2] if k % 2 else unit for k, unit in enumerate(units)))
    return path


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (ratio(0, 1), "pixels of 0:1 are not credible: ignored"),
        (ratio(10_000, 1), "pixels of 10000:1 are not credible: ignored"),
        (no_matrix, "display matrix is zero"),
        (half_damaged, "the file's time stamps say nothing"),
    ],
)
def test_each_command_says_it_once_and_its_tables_are_whole(
    matchset: Matchset,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    make: Callable[[Path], Path],
    words: str,
) -> None:
    clip, pick = make(tmp_path), ("--pick", "60,90", "--no-video")
    known = "--fov", "60", "--diameter", "0.28"
    for command in (("learn",), ("track", *pick, "-o", "t"), ("locate", *pick, *known, "-o", "l")):
        assert matchset(command[0], clip, *command[1:]) == 0
        assert capsys.readouterr().err.count(words) == 1
    tracks, poses = read_tracks("t/tracks.csv"), read_poses("l/poses.csv")
    assert [row.frame for row in tracks] == [row.frame for row in poses]
    assert tracks[0].shape is not None
    assert tracks[0].shape["radius"] == pytest.approx(30.0, abs=1.0)
    notes: list[str] = []
    with open_feed(Source("given", str(clip), "a clip"), Opening(lambda _: None, notes.append)) as feed:
        assert isinstance(feed, FileFeed)
        feed._thread.join()
    assert sum(words in note for note in notes) == 1
