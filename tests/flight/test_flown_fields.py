"""A chain that flies by half-frames: it does, its recording is replayed, and live pictures keep their rows."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cameras import PATIENCE, Camera
from interlaced_videos import ball_clip, pictures_of
from matchset.camera.camera_model import CameraModel
from matchset.flight.chain.flight import Flight
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.linked.live_camera import LiveCamera
from matchset.flight.linked.options import LinkedOptions
from matchset.flight.recording.encoding import outcome_of
from matchset.flight.recording.reader import RecordingReader
from matchset.flight.recording.replay import Replay
from matchset.flight.recording.writer import RecordingWriter
from matchset.links.simulation_parameters import SimulationParameters
from matchset.media.video import Video
from matchset.tracking.track import Track


def test_a_flight_by_half_frames_is_replayed_bit_for_bit(tmp_path: Path) -> None:
    world = SimulationParameters(vehicles=2, seed=12, latency_ms=133.0, fields="top")
    with Flight(FlightParameters(duration=0.7, world=world)) as flight:
        assert (flight.length, flight.setup.fps) == (42, 60)
        steps, setup = list(flight), flight.setup
    frames = [step.steps[0].frame for step in steps]
    assert [frame.rows for frame in frames[:4] if frame is not None] == ["top", "bottom", "top", "bottom"]
    assert sum(isinstance(step.steps[0].ball, Track) for step in steps) > 38
    assert steps[-1].steps[0].age == pytest.approx(0.125, abs=1 / 480)
    path = tmp_path / "flight.mcap"
    with RecordingWriter(path, setup) as out:
        for step in steps:
            out.write(step, [True])
    replayed = Replay(RecordingReader(path))
    again = list(replayed)
    assert replayed.differences == []
    for one, other in zip(steps, again, strict=True):
        assert outcome_of(one.steps[0]) == outcome_of(other.steps[0])
        before, after = one.steps[0].frame, other.steps[0].frame
        assert before is not None
        assert after is not None
        assert before.rows == after.rows
        np.testing.assert_array_equal(before.image, after.image)


def test_a_pilots_camera_hands_on_which_rows_are_new(monkeypatch: pytest.MonkeyPatch) -> None:
    fake, pictures = Camera(), pictures_of(ball_clip())
    fake._pictures.append(pictures[0])
    monkeypatch.setattr("matchset.media.camera_stream.open_capture", lambda *_: fake)
    video = Video(0, timeout=PATIENCE, fields="top")
    camera = LiveCamera("camera 0", video, CameraModel.from_fov(320, 240, 1.0))
    camera.begin(-1.0)
    frame = camera.read()
    assert frame is not None
    assert frame.rows == "bottom"  # it waited, so the older field is left out
    fake.unplug()
    camera.close()


@pytest.mark.parametrize(("typed", "expected"), [(None, "frames"), ("top", "top"), ("auto", "auto")])
def test_a_real_followers_camera_is_opened_so(typed: Any, expected: str) -> None:
    options = LinkedOptions(camera="0", link="serial:///dev/null", fields=typed)
    (follower,) = options.followers(None, None)
    assert follower.fields == expected
    with pytest.raises(ValueError, match="fields must be one of"):
        LinkedOptions(camera="0", link="serial:///dev/null", fields="odd").followers(None, None)
