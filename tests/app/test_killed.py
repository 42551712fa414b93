"""kill -9: what was written before can be read, plays at its rate, and lacks a second at most.

`python -m benchmarks.lost.killed` does the same at 50 random moments.
"""

import re
import shutil
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from benchmarks.lost.content import Content, content_of
from benchmarks.lost.killed import kill_film, record_until_killed
from benchmarks.lost.runs import RUNS, write_clip

from chain_flight import Flown
from matchset.app.films.video_writer import FilmWriter
from matchset.flight.fly.output_files import FlightFiles
from matchset.flight.fly.outputs import FlightOutputs
from matchset.flight.recording.reader import RecordingReader
from matchset.flight.recording.writer import RecordingWriter

SIZE, FPS = (160, 120), 25.0


def test_a_killed_run_leaves_table_and_film(tmp_path: Path) -> None:
    pytest.importorskip("av")
    write_clip(tmp_path / "clip.avi", 600)
    for kind, killed in kill_film(RUNS["mp4"], tmp_path / "clip.avi", tmp_path, 150).items():
        assert killed.given >= 140
        assert not killed.wrong, kind


@pytest.mark.parametrize("suffix", [".mp4", ".webm", ".avi"])
def test_a_film_that_is_not_finished_can_be_read_at_its_rate(tmp_path: Path, suffix: str) -> None:
    pytest.importorskip("av")
    path, given = tmp_path / f"film{suffix}", 60
    with FilmWriter(path, FPS, SIZE) as film:
        content = _copied_while_open(film, path, given)
    assert content.number >= given - FPS
    assert content.rate == pytest.approx(FPS, rel=0.05)
    assert content_of(path).number == given


def test_without_pyav_a_webm_has_its_rate_as_soon_as_it_is_on_the_disk(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "av", None)
    path = tmp_path / "film.webm"
    with FilmWriter(path, FPS, (320, 240)) as film:
        content = _copied_while_open(film, path, 60, (320, 240))
    assert content.number > 5
    assert content.rate == pytest.approx(FPS, rel=0.05)


def _copied_while_open(film: FilmWriter, path: Path, count: int, size: tuple[int, int] = SIZE) -> Content:
    """Content of a film whose program would be killed now."""
    rng = np.random.default_rng(0)
    for _ in range(count):
        film.write(rng.integers(60, 190, (size[1], size[0], 3), np.uint8))
    until = time.monotonic() + 20.0
    while film.waiting and time.monotonic() < until:
        time.sleep(0.01)
    copy = path.with_name("copy" + path.suffix)
    shutil.copy(path, copy)
    return content_of(copy)


def test_a_killed_recording_is_replayed_to_the_last_moments(flown: Flown, tmp_path: Path) -> None:
    path = tmp_path / "a.mcap"
    writers: list[RecordingWriter] = []

    def write(number: int) -> None:
        if number == 0:
            writers.append(RecordingWriter(path, flown.setup))
        writers[0].write(flown.chain_steps[number % len(flown.chain_steps)], (True, True))

    given = record_until_killed(write, 1.2)
    recorded = RecordingReader(path)
    assert given - len(list(recorded)) <= 30
    assert recorded.cut_off


def test_a_recording_says_for_how_many_minutes_there_is_room(
    flown: Flown, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with FlightOutputs(flown.setup, FlightFiles(record=tmp_path / "a.mcap"), quiet=False):
        pass
    rate, minutes = map(
        float, re.findall(r"takes (\d+) MB a second: its disk has room for ([\d.e+]+)", capsys.readouterr().err)[0]
    )
    assert 20.0 < rate < 60.0
    assert minutes * 60.0 * rate == pytest.approx(shutil.disk_usage(tmp_path).free / 1e6, rel=0.05)
