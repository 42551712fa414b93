"""A recording: replayed it gives every step again, bit for bit; whatever is wrong with it is said."""

import math
import re
import signal
from pathlib import Path
from typing import Any

import cv2
import msgspec
import numpy as np
import pytest

from blue_ball import Matchset
from chain_flight import Flown
from matchset.control.command import Command
from matchset.flight.chain.chain_step import ChainStep
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.chain.pilot import PilotStep
from matchset.flight.fly.output_files import FlightFiles
from matchset.flight.fly.outputs import FlightOutputs
from matchset.flight.recording.encoding import encode, outcome_of, step_message
from matchset.flight.recording.mcap_file import McapReader, McapWriter, RecordedMessage, Topic
from matchset.flight.recording.messages import CONFIGURATION, OLDER_NAMES, WITHOUT_GAINS
from matchset.flight.recording.reader import RecordingReader
from matchset.flight.recording.replay import Replay, first_difference
from matchset.flight.recording.writer import RecordingWriter
from matchset.links.link import REFUSALS
from older_names import with_older_keys

ROS = {"/tf"} | {
    f"/follower_{number}/{name}"
    for number in (1, 2)
    for name in ("image/compressed", "camera_info", "ball/pose", "ball/pose_stamped", "ball/detections")
}
OF_THEN = ("ball", "markers", "pose", "answer", "memory", "command", "age")
"""What an outcome held up to format 3, in its order."""


@pytest.fixture(scope="module")
def recording(flown: Flown, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("recording") / "flight.mcap"
    record(flown, path)
    return path


def record(flown: Flown, path: Path) -> None:
    with RecordingWriter(path, flown.setup) as out:
        for chain_step in flown.chain_steps:
            out.write(chain_step, [True] * len(chain_step.steps))


def test_every_step_comes_out_bit_for_bit(flown: Flown, recording: Path) -> None:
    recorded = RecordingReader(recording)
    replayed = Replay(recorded)
    chain_steps = list(replayed)
    assert replayed.differences == []
    assert replayed.steps == 2 * len(flown.chain_steps)
    assert not recorded.cut_off
    assert recorded.setup.parameters == flown.setup.parameters
    assert recorded.setup.cameras == flown.setup.cameras
    for before, after in zip(flown.chain_steps, chain_steps, strict=True):
        assert (before.index, before.time, before.in_view, before.crashes) == (
            after.index,
            after.time,
            after.in_view,
            after.crashes,
        )
        np.testing.assert_array_equal(before.true_positions, after.true_positions)
        np.testing.assert_array_equal(before.truth_at_exposure[1].rotation, after.truth_at_exposure[1].rotation)
        for one, other in zip(before.steps, after.steps, strict=True):
            assert outcome_of(one) == outcome_of(other)
            assert (one.stage_times, one.now) == (other.stage_times, other.now)
            assert (one.frame is None) == (other.frame is None)
            if one.frame is not None and other.frame is not None:
                np.testing.assert_array_equal(one.frame.image, other.frame.image)


def test_the_names_in_a_recording_are_the_format(flown: Flown, recording: Path) -> None:
    messages: dict[str, dict[str, Any]] = {}
    for topic, data in McapReader(recording):
        if topic in ROS:
            continue
        messages.setdefault(topic, msgspec.msgpack.decode(data))
    step, truth = messages["/follower_1/step"], messages["/truth"]
    real = ["kind", "colors", "countdown", "fps", "devices"]
    assert list(messages["/configuration"]) == ["format", "matchset", "parameters", "cameras", *real]
    waiting = ["together", "stagger", "stagger_delays", "sight_ahead", "sight_margin"]
    parameters = ["duration", *waiting, "world", "pilot", "long_chain", "linked"]
    assert list(messages["/configuration"]["parameters"]) == parameters
    assert list(messages["/follower_1/sample"]) == ["index", "time", "png"]
    first = ["tick", "armed", "frame", "taken", "now", "command", "spent", "outcome"]
    assert list(step) == [*first, "stopped", "landing", "rows"]
    assert list(step["outcome"]) == ["ball", "markers", "pose", "control", "safety", "command", "age"]
    assert list(step["outcome"]["pose"]) == ["position", "rotation_matrix", "covariance", "observed", "time"]
    ball = ["shape", "covariance", "support", "match_set", "time", "acquired", "field_offset", "pixel_aspect"]
    assert list(step["outcome"]["ball"]) == ball
    assert (len(step["outcome"]["control"]), len(step["outcome"]["safety"])) == (11, 10)
    assert list(truth) == ["index", "time", "truth", "shown", "places", "inside", "crashes"]
    assert list(truth["truth"][0]) == ["place", "turn", "ball"]


def test_a_pixel_that_changed_is_noticed(flown: Flown, tmp_path: Path) -> None:
    chain_steps = list(flown.chain_steps[:8])
    frame = chain_steps[5].steps[1].frame
    assert frame is not None
    image = frame.image.copy()
    image[200:280, 280:360] //= 2
    altered = msgspec.structs.replace(chain_steps[5].steps[1], frame=msgspec.structs.replace(frame, image=image))
    chain_steps[5] = msgspec.structs.replace(chain_steps[5], steps=(chain_steps[5].steps[0], altered))
    record(Flown(flown.setup, tuple(chain_steps)), tmp_path / "altered.mcap")
    replayed = Replay(RecordingReader(tmp_path / "altered.mcap"))
    list(replayed)
    first = replayed.differences[0]
    assert (first.tick, first.follower) == (6, 2)
    assert first.text.startswith("ball.")
    assert " was " in first.text
    assert all(each.follower == 2 for each in replayed.differences)


def test_a_pilot_that_was_not_armed_stays_so(flown: Flown, tmp_path: Path) -> None:
    with RecordingWriter(tmp_path / "a.mcap", flown.setup) as out:
        for chain_step in flown.chain_steps[:3]:
            out.write(chain_step, (True, False))
    replayed = Replay(RecordingReader(tmp_path / "a.mcap"))
    chain_steps = list(replayed)
    assert {chain_step.steps[1].safety.reason for chain_step in chain_steps} == {"not armed"}
    assert {each.follower for each in replayed.differences} == {2}


def test_a_refusal_is_recorded_with_its_reason_and_replayed(
    matchset: Matchset, capsys: pytest.CaptureFixture[str]
) -> None:
    uri = "sim://chain?vehicles=2&seed=5&silent=0.4&width=320&height=240"
    assert matchset("fly", uri, "--duration", "1", "--record", "a.mcap", "--report", "a.html") == 1
    said = capsys.readouterr()
    assert "vehicle 1 was cut: the transmitter stopped the motors" in said.out
    steps = [chain_step.steps[0] for chain_step in RecordingReader(Path("a.mcap"))]
    assert [step.stopped for step in steps if step.stopped] == [REFUSALS["failsafe"]]
    assert "cut: the transmitter stopped the motors" in Path("a.html").read_text(encoding="utf-8")
    assert matchset("replay", "a.mcap") == 0
    said = capsys.readouterr()
    assert "bit for bit" in said.out


def test_a_recording_that_was_cut_off_is_replayed_as_far_as_it_goes(recording: Path, tmp_path: Path) -> None:
    data = recording.read_bytes()
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(data[: len(data) // 2])
    recorded = RecordingReader(cut)
    replayed = Replay(recorded)
    chain_steps = list(replayed)
    assert recorded.cut_off
    assert len(chain_steps) >= 3
    assert replayed.differences == []


def test_what_is_written_is_on_disk_before_the_end(flown: Flown, tmp_path: Path) -> None:
    """As if the program were killed: nothing is closed, and yet most of it can be replayed."""
    path = tmp_path / "killed.mcap"
    recording = RecordingWriter(path, flown.setup)
    for chain_step in flown.chain_steps[:12]:
        recording.write(chain_step, (True, True))
    copy = tmp_path / "copy.mcap"
    copy.write_bytes(path.read_bytes())
    recording.close()
    chain_steps = list(RecordingReader(copy))
    assert 2 <= len(chain_steps) <= 12


def test_damage_is_said_and_never_anything_else(flown: Flown, tmp_path: Path) -> None:
    short = tmp_path / "short.mcap"
    record(Flown(flown.setup, flown.chain_steps[:2]), short)
    data, rng = short.read_bytes(), np.random.default_rng(7)
    places = [*rng.integers(0, 3000, 15).tolist(), *rng.integers(0, len(data), 15).tolist()]
    said = []
    for place in places:
        broken = bytearray(data)
        for k in range(3):
            broken[(place + 7 * k) % len(data)] ^= int(rng.integers(1, 256))
        short.write_bytes(broken)
        try:
            list(RecordingReader(short))
        except ValueError as error:
            said.append(str(error))
    assert len(said) > len(places) // 2
    for words in said:
        assert str(short) in words
        assert any(word in words for word in ("damaged", "MCAP", "recording"))


def test_parameters_of_another_version_are_refused_by_name(flown: Flown, tmp_path: Path, recording: Path) -> None:
    first = next(iter(McapReader(recording)))
    content = msgspec.msgpack.decode(first.data)
    content["parameters"]["world"]["gravity"] = 1.6
    with McapWriter(tmp_path / "moon.mcap", [Topic(CONFIGURATION, "c", b"{}")]) as out:
        out.write(RecordedMessage(CONFIGURATION, msgspec.msgpack.encode(content)), 0.0, 0)
    with pytest.raises(ValueError, match="gravity"):
        RecordingReader(tmp_path / "moon.mcap")


def test_a_missing_picture_is_named(flown: Flown, recording: Path, tmp_path: Path) -> None:
    messages = [each for each in McapReader(recording) if each.topic != "/follower_2/image/compressed"]
    kinds = [Topic(topic, "x", b"{}") for topic in sorted({each.topic for each in messages})]
    with McapWriter(tmp_path / "less.mcap", kinds) as out:
        for number, each in enumerate(messages):
            out.write(each, 0.0, number)
    with pytest.raises(ValueError, match="tick 1 lacks the picture of follower 2"):
        list(RecordingReader(tmp_path / "less.mcap"))


@pytest.mark.parametrize("form", [WITHOUT_GAINS, OLDER_NAMES])
def test_a_recording_of_a_format_before_is_replayed_as_it_was_flown(
    flown: Flown, recording: Path, tmp_path: Path, form: int
) -> None:
    def before(each: RecordedMessage) -> RecordedMessage:
        """Write a message as that format had it."""
        content = msgspec.msgpack.decode(each.data) if each.topic not in ROS else {}
        if each.topic == CONFIGURATION:
            content["format"] = form
            content["parameters"] = with_older_keys(content["parameters"], FlightParameters)
            if form == WITHOUT_GAINS:
                del content["parameters"]["pilot"]["follower"]["steady"]
        elif "outcome" in content:
            pose, control, safety = (content["outcome"][name] for name in ("pose", "control", "safety"))
            pose = {"turn" if name == "rotation_matrix" else name: value for name, value in pose.items()}
            control = control[:-1] if control and form == WITHOUT_GAINS else control
            others = {name: content["outcome"][name] for name in ("ball", "markers", "command", "age")}
            for seen in (others["ball"], *others["markers"]):
                seen.pop("pixel_aspect", None)  # which no format before had
            of_then = {**others, "pose": pose, "answer": control, "memory": safety}
            content["outcome"] = {name: of_then[name] for name in OF_THEN}
        else:
            return each
        return RecordedMessage(each.topic, msgspec.msgpack.encode(content))

    messages = [before(each) for each in McapReader(recording)]
    kinds = [Topic(topic, "x", b"{}") for topic in sorted({each.topic for each in messages})]
    with McapWriter(tmp_path / "old.mcap", kinds) as out:
        for number, each in enumerate(messages):
            out.write(each, 0.0, number)
    recorded = RecordingReader(tmp_path / "old.mcap")
    parameters = recorded.setup.parameters
    assert parameters.pilot.follower.stability.enabled == (form == OLDER_NAMES)
    assert form == WITHOUT_GAINS or parameters == flown.setup.parameters
    replayed = Replay(recorded)
    assert len(list(replayed)) == len(flown.chain_steps)
    assert replayed.differences == []


def test_the_first_difference_is_named(flown: Flown) -> None:
    step: PilotStep = flown.chain_steps[5].steps[0]
    other = msgspec.structs.replace(step, safety=step.safety._replace(command=Command(throttle=0.5)))
    words = first_difference(outcome_of(step), outcome_of(other))
    assert words.startswith("safety.7.")
    assert first_difference(outcome_of(step), outcome_of(step)) == "the bytes differ"
    minus = msgspec.structs.replace(step, age=-0.0)
    assert first_difference(outcome_of(msgspec.structs.replace(step, age=0.0)), outcome_of(minus)) == (
        "age was 0.0, is -0.0"
    )
    assert first_difference(b"\xc1", outcome_of(step)) == "what was recorded is no message"
    assert math.isnan(msgspec.msgpack.decode(encode(float("nan"))))
    assert step_message(6, step, True).frame == 6


def test_the_command_replays_films_and_reports(
    matchset: Matchset, recording: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    assert matchset("replay", recording, "--video", "a.avi", "--report", "a.html", "--quiet") == 0
    out, err = capfd.readouterr()
    assert "every one came out bit for bit as recorded" in out
    assert err == ""
    assert Path("a.avi").stat().st_size > 100_000
    assert "1 watches 2" in Path("a.html").read_text(encoding="utf-8")
    assert matchset("replay", recording, "--report", "a.html") == 2
    assert "a.html exists" in capfd.readouterr().err
    assert matchset("replay", recording, "--report", recording, "--force") == 2
    assert matchset("replay", "nothing.mcap") == 2
    assert "nothing.mcap: No such file" in capfd.readouterr().err


def test_the_command_fails_where_steps_differ(
    matchset: Matchset, flown: Flown, capfd: pytest.CaptureFixture[str]
) -> None:
    step = msgspec.structs.replace(flown.chain_steps[2].steps[0], age=0.5)
    chain_steps = [
        *flown.chain_steps[:2],
        msgspec.structs.replace(flown.chain_steps[2], steps=(step, flown.chain_steps[2].steps[1])),
    ]
    record(Flown(flown.setup, tuple(chain_steps)), Path("wrong.mcap"))
    assert matchset("replay", "wrong.mcap", "--quiet") == 1
    out = capfd.readouterr().out
    assert "replayed 6 steps: 1 differ" in out
    assert "tick 3, follower 1: age was 0.5, is 0.0" in out


def test_a_signal_ends_the_replay_with_whole_files(
    matchset: Matchset, recording: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    show = FlightOutputs.add

    def interrupted(outputs: FlightOutputs, chain_step: ChainStep) -> None:
        show(outputs, chain_step)
        if chain_step.index == 3:
            signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(FlightOutputs, "add", interrupted)
    assert matchset("replay", recording, "--video", "a.avi", "--quiet") == 130
    out, err = capfd.readouterr()
    assert "replayed 6 steps: every one" in out
    assert "stopped" in err
    video = cv2.VideoCapture("a.avi")
    assert video.get(cv2.CAP_PROP_FRAME_COUNT) == 3


def test_the_python_of_the_page_runs(recording: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = (Path(__file__).resolve().parents[3] / "docs" / "recording.md").read_text(encoding="utf-8")
    (code,) = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    monkeypatch.chdir(recording.parent)
    scope: dict[str, Any] = {}
    exec(compile(code, "recording.md", "exec"), scope)
    assert scope["frame"].image.shape == (480, 640, 3)
    assert scope["step"]["armed"] is True


def test_a_video_that_cannot_be_written_leaves_nothing_behind(flown: Flown, tmp_path: Path) -> None:
    files = FlightFiles(video=tmp_path / "no" / "a.avi", report=tmp_path / "a.html")
    with pytest.raises(ValueError, match="cannot write"):
        FlightOutputs(flown.setup, files, quiet=True)
    assert list(tmp_path.iterdir()) == []


def test_whatever_happens_the_files_are_whole(flown: Flown, tmp_path: Path) -> None:
    files = FlightFiles(video=tmp_path / "a.avi", record=tmp_path / "a.mcap")
    files.check()

    def fly() -> None:
        with FlightOutputs(flown.setup, files, quiet=True) as outputs:
            for chain_step in flown.chain_steps[:6]:
                outputs.add(chain_step)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fly()
    recorded = RecordingReader(tmp_path / "a.mcap")
    assert len(list(recorded)) == 6
    assert not recorded.cut_off
    assert (tmp_path / "a.avi").stat().st_size > 50_000


def chunks_of(path: Path) -> list[tuple[int, int]]:
    """Where the chunks of a file begin and end."""
    data, at, found = path.read_bytes(), 8, []
    while at + 9 <= len(data) - 8:
        length = int.from_bytes(data[at + 1 : at + 9], "little")
        if data[at] == 6:
            found.append((at + 9, at + 9 + length))
        at += 9 + length
    return found


@pytest.mark.parametrize("where", [0.3, 0.9])
def test_one_flipped_bit_costs_one_chunk_and_what_follows_is_salvaged(
    flown: Flown,
    recording: Path,
    matchset: Matchset,
    capsys: pytest.CaptureFixture[str],
    where: float,
) -> None:
    chunks = chunks_of(recording)
    assert len(chunks) > 3
    begin, end = chunks[int(where * len(chunks))]
    data = bytearray(recording.read_bytes())
    data[(begin + end) // 2] ^= 4
    Path("flipped.mcap").write_bytes(data)
    recorded = RecordingReader(Path("flipped.mcap"))
    ticks = [chain_step.truth.index for chain_step in recorded]
    whole = [chain_step.index for chain_step in flown.chain_steps]
    assert len(recorded.damaged) == 1
    assert set(ticks) < set(whole)
    assert ticks == sorted(ticks)
    assert len(whole) - len(ticks) <= len(whole) // len(chunks) + 3
    assert ticks[-1] == whole[-1] or where == 0.9
    assert matchset("replay", "flipped.mcap", "--quiet") == 1
    printed = capsys.readouterr()
    assert "s are missing" in printed.err
    assert "every one came out bit for bit" in printed.out
