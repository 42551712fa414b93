"""Worse copies of real clips: their pictures, their truth, and what is measured on them."""

import csv
from pathlib import Path

import numpy as np
import pytest
from benchmarks.options import Options
from benchmarks.real.clips import Clip, find_clips
from benchmarks.real.copies import section
from benchmarks.real.copies.copy import Copy, write_copy

import matchset as ms
from matchset.app.films.clip_export import write_clip
from matchset.sim.clips.clip import Clip as RenderedClip

FRAMES = 24
LABELLED = range(0, FRAMES, 5)


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with one rendered clip, of which every fifth frame is labelled."""
    pytest.importorskip("av")
    folder = tmp_path_factory.mktemp("data")
    (folder / "rendered").mkdir()
    truth = folder / "rendered" / "truth.csv"
    clip = RenderedClip(preset="clean", seed=3, width=320, height=240, radii=(10.0, 40.0), frames=FRAMES)
    write_clip(clip, folder / "rendered" / "video.avi", truth)
    with truth.open(newline="") as file:
        head, *rows = csv.reader(file)
    frame = head.index("frame")
    with truth.open("w", newline="") as file:
        csv.writer(file).writerows([head, *(row for row in rows if int(row[frame]) in LABELLED)])
    return folder


def original(data: Path) -> Clip:
    (clip,), _ = find_clips(data, data / "labels")
    return clip


def test_a_copy_is_smaller_and_its_truth_goes_along(data: Path, tmp_path: Path) -> None:
    clip = original(data)
    copy = write_copy(Copy("rendered", 160, 20, every=3), clip, tmp_path)
    assert (copy.width, copy.height) == (160, 120)
    assert copy.name == "rendered, 160 px, crf 20, 1 of 3"
    kept = sorted({*range(0, FRAMES, 3), *LABELLED})
    assert [row.frame for row in copy.truths] == [kept.index(frame) for frame in LABELLED]
    with ms.Video(copy.video) as video:
        assert sum(1 for _ in video) == len(kept)
    for row, other in zip(copy.truths, clip.truths, strict=True):
        assert row.circle is not None
        assert other.circle is not None
        np.testing.assert_allclose(row.circle, 0.5 * np.array(other.circle), atol=0.26)
        assert row.lowconf == other.lowconf


def test_the_ball_of_a_good_copy_is_where_its_truth_says(data: Path, tmp_path: Path) -> None:
    copy = write_copy(Copy("rendered", 240, 12), original(data), tmp_path)
    x, y, radius = copy.tight[0].circle or (0.0, 0.0, 0.0)
    with ms.Video(copy.video) as video:
        first = next(iter(video))
    tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(first, x - 0.5 * radius, y), start=(x, y))
    track = tracker.update(first)
    assert isinstance(track, ms.Track)
    assert abs(track.shape.x - x) + abs(track.shape.y - y) + abs(track.shape.radius - radius) < 1.0


def test_the_same_copy_has_the_same_bytes(data: Path, tmp_path: Path) -> None:
    clip, films = original(data), set[bytes]()
    for name in ("first", "second"):
        (tmp_path / name).mkdir()
        films.add(write_copy(Copy("rendered", 160, 34, jumps=True), clip, tmp_path / name).video.read_bytes())
    assert len(films) == 1


def test_light_jumps_only_where_that_is_asked_for(data: Path, tmp_path: Path) -> None:
    def brightness(copy: Copy) -> list[float]:
        with ms.Video(write_copy(copy, original(data), tmp_path).video) as video:
            return [float(frame.image.mean()) for frame in video]

    even, jumping = brightness(Copy("rendered", 160, 20)), brightness(Copy("rendered", 160, 20, jumps=True))
    assert np.ptp(even) < 10.0
    assert np.abs(np.diff(jumping))[6::7].max() > 15.0


def test_the_section_measures_copies_and_says_what_is_missing(data: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(section, "CODED", (Copy("rendered", 240, 28), Copy("not_there", 240, 28)))
    monkeypatch.setattr(section, "LIT", ())
    found = section.run(Options(data=data, quick=True, jobs=1))
    starts, searched = found.findings
    assert (starts.name, searched.name) == ("real_copies_coded", "real_copies_coded_detection")
    figures = {figure.name: figure.value for figure in starts.figures}
    assert figures["mean valid by copy"] == 100.0
    assert figures["nothing"] == 0.0
    assert "rendered, 240 px, crf 28" in found.text
    (nothing,) = section.run(Options(data=None)).findings
    assert nothing.verdict == "-"
