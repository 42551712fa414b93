"""What is shown and written never makes a flight wait, and never ends it."""

import errno
import threading
from pathlib import Path

import pytest

from blue_ball import Matchset
from chain_flight import Flown
from matchset.app.films.video_writer import FilmWriter
from matchset.flight.fly.live_view import LiveView
from matchset.flight.fly.output_files import FlightFiles
from matchset.flight.fly.outputs import FlightOutputs
from matchset.flight.real_time.background import Background, BackgroundParameters
from matchset.flight.recording.mcap_file import McapWriter
from matchset.flight.recording.reader import RecordingReader
from matchset.flight.recording.writer import RecordingWriter

FULL = OSError(errno.ENOSPC, "No space left on device", "flight.mcap")
Out = pytest.CaptureFixture[str]


def fly(outputs: FlightOutputs, flown: Flown, times: int) -> None:
    """Give all steps to the outputs, so many times."""
    for _ in range(times):
        for chain_step in flown.chain_steps:
            outputs.add(chain_step)


def test_items_come_in_their_order_and_the_rest_is_counted() -> None:
    seen: list[int] = []
    begun, free = threading.Event(), threading.Event()

    def work(item: int) -> None:
        begun.set()
        free.wait()
        seen.append(item)

    with Background("the test", work, BackgroundParameters(waiting=4)) as background:
        for k in range(10):
            background.add(k)
            begun.wait()
        assert (background.added, background.dropped) == (10, 5)
        assert background.note == "the test lacks 5 of 10 steps"
        free.set()
    assert seen == [0, 1, 2, 3, 4]


def test_without_a_clock_nothing_is_dropped() -> None:
    seen: list[int] = []
    free = threading.Event()

    def work(item: int) -> None:
        free.wait()
        seen.append(item)

    with Background("the test", work, BackgroundParameters(waiting=2, drops=False)) as background:

        def add() -> None:
            for k in range(50):
                background.add(k)

        adder = threading.Thread(target=add)
        adder.start()
        while background.added < 4:
            adder.join(0.001)
        assert (background.added, seen) == (4, [])  # one is worked on, two wait, and the fourth is waited with
        free.set()
        adder.join()
    assert seen == list(range(50))
    assert background.note == ""


def test_an_error_ends_the_work_and_is_raised_at_the_end() -> None:
    said: list[str] = []

    def work(item: int) -> None:
        if item == 3:
            raise FULL

    background = Background("the recording", work, BackgroundParameters(drops=False), said.append)
    for k in range(10):
        background.add(k)
    with pytest.raises(OSError, match="No space"):
        background.close()
    background.close()
    assert len(said) == 1
    assert said[0].startswith("the recording stopped: [Errno 28] No space left on device")
    assert background.dropped == 7


def test_a_work_that_hangs_is_given_up() -> None:
    hang = threading.Event()

    def work(_item: int) -> None:
        hang.wait()

    background = Background("the recording", work, BackgroundParameters(patience=0.1))
    background.add(1)
    background.add(2)
    with pytest.raises(OSError, match="the recording hangs"):
        background.close()
    hang.set()


@pytest.mark.parametrize("blocked", ["recording", "video", "screen"])
def test_a_blocked_output_is_no_pause_of_the_loop(
    flown: Flown, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, blocked: str
) -> None:
    free = threading.Event()
    kind = {"recording": RecordingWriter.write, "video": FilmWriter.write, "screen": LiveView.show}[blocked]
    owner = {"recording": RecordingWriter, "video": FilmWriter, "screen": LiveView}[blocked]

    def wait(self: object, *items: object) -> None:
        free.wait()
        kind(self, *items)  # type: ignore[operator]

    monkeypatch.setattr(owner, kind.__name__, wait)
    files = FlightFiles(record=tmp_path / "a.mcap", video=tmp_path / "a.avi")
    with FlightOutputs(flown.setup, files, quiet=True, real_time=True) as outputs:
        fly(outputs, flown, 4 if blocked == "recording" else 1)  # to the end, although no write comes to its own
        free.set()
    if blocked != "screen":
        assert any(note.startswith(f"the {blocked} lacks") for note in outputs.notes)


def test_a_full_disk_does_not_end_a_flight(matchset: Matchset, capsys: Out, monkeypatch: pytest.MonkeyPatch) -> None:
    write, written = RecordingWriter.write, []

    def full(self: RecordingWriter, *items: object) -> None:
        written.append(items)
        if len(written) == 5:
            raise FULL
        write(self, *items)  # type: ignore[arg-type]

    monkeypatch.setattr(RecordingWriter, "write", full)
    uri = "sim://chain?vehicles=2&seed=5&width=320&height=240&pal=clean"
    assert matchset("fly", uri, "--duration", "1", "--record", "a.mcap", "--report", "a.html") == 2
    err = capsys.readouterr().err.splitlines()
    assert [line for line in err if line.startswith("the recording stopped: ")]
    assert err[-1] == "error: flight.mcap: No space left on device"
    assert len(list(RecordingReader(Path("a.mcap")))) == 4
    assert Path("a.html").stat().st_size > 10_000


def test_a_flight_in_real_time_says_its_longest_pause(matchset: Matchset, capsys: Out) -> None:
    uri = "sim://chain?vehicles=2&seed=5&width=320&height=240&pal=clean"
    matchset("fly", uri, "--duration", "0.3", "--real-time", "--record", "a.mcap")
    assert "longest pause of the loop: " in capsys.readouterr().out


def test_a_recording_that_meets_a_full_disk_says_so_while_it_flies(
    matchset: Matchset, capsys: Out, monkeypatch: pytest.MonkeyPatch
) -> None:
    write, written = McapWriter.write, []

    def full(self: McapWriter, *items: object) -> None:
        written.append(items)
        if len(written) > 60:
            raise FULL
        write(self, *items)  # type: ignore[arg-type]

    monkeypatch.setattr(McapWriter, "write", full)
    uri = "sim://chain?vehicles=2&seed=5&width=320&height=240&pal=clean"
    assert matchset("fly", uri, "--duration", "1", "--record", "a.mcap") == 2
    err = capsys.readouterr().err.splitlines()
    assert [line for line in err if line.startswith("the recording stopped: ")]
    assert "a.mcap" in err[-1]
