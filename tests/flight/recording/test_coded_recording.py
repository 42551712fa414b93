"""Flown by JPEG: what is recorded is what was flown by, so its replay is exact, in a tenth of the bytes."""

from pathlib import Path

import cv2
import numpy as np
import pytest

import matchset as ms
from blue_ball import Matchset
from matchset.flight.chain.flight import Flight
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.fly.output_files import FlightFiles
from matchset.flight.recording.coded_camera import CodedCamera, CodedFrame, coded_frame
from matchset.flight.recording.mcap_file import McapReader
from matchset.flight.recording.reader import RecordingReader
from matchset.flight.recording.replay import Replay
from matchset.flight.recording.writer import RecordingWriter
from matchset.links.simulation_parameters import SimulationParameters

QUALITY = 70
PICTURES = "/follower_1/image/compressed"
WORLD = SimulationParameters(vehicles=2, seed=11, cable=0.4)  # some steps lack a picture


@pytest.fixture(scope="module")
def recordings(tmp_path_factory: pytest.TempPathFactory) -> dict[int | None, Path]:
    """The same short flight, flown by the pictures as they are, and by JPEG."""
    folder, made = tmp_path_factory.mktemp("coded"), dict[int | None, Path]()
    for quality in (None, QUALITY):
        made[quality] = folder / f"{quality}.mcap"
        with Flight(FlightParameters(duration=0.5, world=WORLD)) as flight:
            if quality is not None:
                (pilot,) = flight.pilots
                pilot.camera = CodedCamera(pilot.camera, quality)
            with RecordingWriter(made[quality], flight.setup, jpeg=quality) as out:
                for chain_step in flight:
                    out.write(chain_step, [True])
    return made


def test_the_replay_of_a_flight_by_jpeg_is_exact(recordings: dict[int | None, Path]) -> None:
    replayed = Replay(RecordingReader(recordings[QUALITY]))
    frames = [step.steps[0].frame for step in replayed]
    assert replayed.differences == []
    assert replayed.steps == len(frames) == 15
    assert 0 < sum(frame is None for frame in frames) < 15


def test_its_pictures_are_those_that_were_flown_by_and_any_tool_reads_them(recordings: dict[int | None, Path]) -> None:
    with ms.Video(recordings[QUALITY], topic=PICTURES) as video:
        read = [frame.image for frame in video]
    messages = [data for topic, data in McapReader(recordings[QUALITY]) if topic == PICTURES]
    assert len(messages) == len(read) > 5
    for data, image in zip(messages, read, strict=True):
        assert b"jpeg\0" in data[:60]
        jpeg = data[data.index(b"\xff\xd8") :]
        assert np.array_equal(np.asarray(cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_COLOR)), image)


def test_it_takes_a_fraction_of_the_room(recordings: dict[int | None, Path]) -> None:
    sizes = {
        quality: sum(len(data) for topic, data in McapReader(path) if topic == PICTURES)
        for quality, path in recordings.items()
    }
    assert sizes[QUALITY] < 0.15 * sizes[None]


@pytest.mark.parametrize("channels", [1, 3])
def test_a_coded_frame_keeps_time_number_and_kind(channels: int) -> None:
    image = np.full((48, 64, 3) if channels == 3 else (48, 64), 90, np.uint8)
    frame = coded_frame(ms.Frame(image, 1.5, 7), QUALITY)
    assert isinstance(frame, CodedFrame)
    assert (frame.time, frame.index, frame.image.shape) == (1.5, 7, image.shape)
    assert len(frame.jpeg) < 2000


def test_the_command_records_jpeg_and_replays_it(matchset: Matchset, capsys: pytest.CaptureFixture[str]) -> None:
    chain = "sim://chain?vehicles=2&seed=5"
    assert matchset("fly", chain, "--duration", 0.2, "--record", "a.mcap", "--record-jpeg", 80, "--quiet") == 0
    assert matchset("replay", "a.mcap", "--quiet") == 0
    assert "every one came out bit for bit" in capsys.readouterr().out
    assert all(b"jpeg\0" in data[:60] for topic, data in McapReader(Path("a.mcap")) if topic == PICTURES)


def test_how_a_recording_is_written_needs_a_recording(
    matchset: Matchset, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert matchset("fly", "sim://chain", "--record-jpeg", "80") == 2
    assert "give --record FILE too" in capsys.readouterr().err
    FlightFiles(record=tmp_path / "a.mcap", jpeg=80).check()
