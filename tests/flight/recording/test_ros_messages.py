"""A recording is a bag of ROS 2: the package rosbags reads every message, each member as it was flown."""

import math
from pathlib import Path
from typing import Any

import cv2
import msgspec
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import bags
from chain_flight import Flown, lost, with_step
from matchset.flight.chain.chain_step import ChainStep
from matchset.flight.chain.pilot import PilotStep
from matchset.flight.recording.messages import StepMessage
from matchset.flight.recording.writer import RecordingWriter
from matchset.image.frame import Frame
from matchset.localization.pose import Pose
from matchset.media.video import Video
from matchset.tracking.track import Track

SPACE = "/follower_2"


@pytest.fixture(scope="module")
def steps(flown: Flown) -> tuple[ChainStep, ...]:
    """A flight with everything: located, lost, without rotation, without picture."""
    changed = list(flown.chain_steps)
    changed[3] = with_step(changed[3], 1, lost(changed[3].steps[1]))
    step = changed[4].steps[1]
    assert isinstance(step.pose, Pose)
    covariance = step.pose.covariance.copy()
    covariance[3:] = covariance[:, 3:] = 0.0
    covariance[3:, 3:] = np.eye(3) * math.pi**2 / 3.0
    still = msgspec.structs.replace(step.pose, rotation_matrix=None, covariance=covariance, observed="position")
    changed[4] = with_step(changed[4], 1, msgspec.structs.replace(step, pose=still, markers=()))
    return tuple(changed)


@pytest.fixture(scope="module")
def recording(flown: Flown, steps: tuple[ChainStep, ...], tmp_path_factory: pytest.TempPathFactory) -> Path:
    bags.need_rosbags()
    path = tmp_path_factory.mktemp("ros") / "flight.mcap"
    with RecordingWriter(path, flown.setup) as out:
        for chain_step in steps:
            out.write(chain_step, [True] * len(chain_step.steps))
    return path


@pytest.fixture(scope="module")
def read(recording: Path) -> dict[str, list[Any]]:
    """All messages by topic, as rosbags understands them from the definitions in the file alone."""
    from rosbags.highlevel import AnyReader

    found: dict[str, list[Any]] = {}
    with AnyReader([recording]) as reader:
        for connection, _, data in reader.messages():
            found.setdefault(connection.topic, []).append(reader.deserialize(data, connection.msgtype))
    return found


def pictured(steps: tuple[ChainStep, ...]) -> list[tuple[PilotStep, Frame]]:
    """Steps of follower 2 with a picture."""
    chosen = [chain_step.steps[1] for chain_step in steps]
    return [(step, step.frame) for step in chosen if step.frame is not None]


def located(steps: tuple[ChainStep, ...]) -> list[Pose]:
    return [step.pose for step, _ in pictured(steps) if isinstance(step.pose, Pose)]


def check_header(header: Any, time: float) -> None:
    assert header.stamp.sec * bags.NANO + header.stamp.nanosec == round(time * bags.NANO)
    assert header.frame_id == "follower_2/camera"


def vector(point: Any) -> list[float]:
    return [point.x, point.y, point.z]


def check_orientation(quaternion: Any, pose: Pose) -> None:
    found = Rotation.from_quat([quaternion.x, quaternion.y, quaternion.z, quaternion.w])
    meant = Rotation.identity() if pose.rotation is None else pose.rotation
    assert (found.inv() * meant).magnitude() < 1e-9


def test_the_file_is_a_bag_of_ros_2(recording: Path) -> None:
    from mcap.reader import make_reader
    from rosbags.rosbag2 import Reader

    with recording.open("rb") as file:
        reader = make_reader(file)
        assert reader.get_header().profile == "ros2"
        summary = reader.get_summary()
    assert summary is not None
    assert {channel.message_encoding for channel in summary.channels.values()} == {"cdr"}
    assert {schema.encoding for schema in summary.schemas.values()} == {"ros2msg"}
    with Reader(recording) as bag:
        kinds = {topic: info.msgtype for topic, info in bag.topics.items()}
    assert {topic: kind for topic, kind in kinds.items() if topic.startswith((SPACE, "/tf"))} == {
        "/tf": "tf2_msgs/msg/TFMessage",
        f"{SPACE}/ball/detections": "vision_msgs/msg/Detection2DArray",
        f"{SPACE}/ball/pose": "geometry_msgs/msg/PoseWithCovarianceStamped",
        f"{SPACE}/ball/pose_stamped": "geometry_msgs/msg/PoseStamped",
        f"{SPACE}/camera_info": "sensor_msgs/msg/CameraInfo",
        f"{SPACE}/image/compressed": "sensor_msgs/msg/CompressedImage",
        f"{SPACE}/sample": "matchset_msgs/msg/Picture",
        f"{SPACE}/step": "matchset_msgs/msg/StepMessage",
    }


def test_poses(steps: tuple[ChainStep, ...], read: dict[str, list[Any]]) -> None:
    poses = located(steps)
    assert any(pose.rotation is None for pose in poses)
    assert len(poses) < len(pictured(steps))
    for pose, full, plain in zip(poses, read[f"{SPACE}/ball/pose"], read[f"{SPACE}/ball/pose_stamped"], strict=True):
        for message, inner in ((full, full.pose.pose), (plain, plain.pose)):
            check_header(message.header, pose.time)
            assert vector(inner.position) == pose.position.tolist()
            check_orientation(inner.orientation, pose)
        np.testing.assert_array_equal(full.pose.covariance, pose.covariance.ravel())
        if pose.rotation is None:
            assert full.pose.covariance[[21, 28, 35]] == pytest.approx(math.pi**2 / 3.0)


def test_transforms(steps: tuple[ChainStep, ...], read: dict[str, list[Any]]) -> None:
    sent = [each for message in read["/tf"] for each in message.transforms]
    ours = [each for each in sent if each.child_frame_id == "follower_2/ball"]
    assert {each.child_frame_id for each in sent} == {"follower_1/ball", "follower_2/ball"}
    for pose, each in zip(located(steps), ours, strict=True):
        check_header(each.header, pose.time)
        assert vector(each.transform.translation) == pose.position.tolist()
        check_orientation(each.transform.rotation, pose)


def test_detections(steps: tuple[ChainStep, ...], read: dict[str, list[Any]]) -> None:
    counts = []
    for (step, frame), message in zip(pictured(steps), read[f"{SPACE}/ball/detections"], strict=True):
        check_header(message.header, frame.time)
        tracks = [*([step.ball] if isinstance(step.ball, Track) else []), *step.markers]
        counts.append(len(tracks))
        for track, found in zip(tracks, message.detections, strict=True):
            center, shape = found.bbox.center, track.shape
            assert (center.position.x, center.position.y, center.theta) == (shape.x, shape.y, 0.0)
            assert found.bbox.size_x == found.bbox.size_y == 2.0 * shape.radius
            (result,) = found.results
            is_ball = track is step.ball
            assert result.hypothesis.class_id == ("ball" if is_ball else "marker")
            assert (result.hypothesis.score, found.id) == (track.support, "")
            check_header(found.header, frame.time)
            if is_ball and isinstance(step.pose, Pose):
                assert vector(result.pose.pose.position) == step.pose.position.tolist()
                np.testing.assert_array_equal(result.pose.covariance, step.pose.covariance.ravel())
    assert {0, 1, 2} <= set(counts)


def test_cameras(flown: Flown, steps: tuple[ChainStep, ...], read: dict[str, list[Any]]) -> None:
    camera = flown.setup.cameras[1]
    for (_, frame), info in zip(pictured(steps), read[f"{SPACE}/camera_info"], strict=True):
        check_header(info.header, frame.time)
        assert (info.width, info.height, info.distortion_model) == (camera.width, camera.height, "plumb_bob")
        assert tuple(info.d) == camera.distortion
        k = info.k.reshape(3, 3)
        assert (k[0, 0], k[1, 1], k[0, 2], k[1, 2], k[2, 2]) == (camera.fx, camera.fy, camera.cx, camera.cy, 1.0)
        np.testing.assert_array_equal(info.p.reshape(3, 4), np.column_stack([k, np.zeros(3)]))
        np.testing.assert_array_equal(info.r.reshape(3, 3), np.eye(3))
        roi = info.roi
        assert (info.binning_x, info.binning_y, roi.x_offset, roi.y_offset, roi.height, roi.width) == (0,) * 6
        assert not roi.do_rectify


def test_pictures(steps: tuple[ChainStep, ...], read: dict[str, list[Any]], recording: Path) -> None:
    for (_, frame), message in zip(pictured(steps), read[f"{SPACE}/image/compressed"], strict=True):
        check_header(message.header, frame.time)
        assert message.format == "png"
        np.testing.assert_array_equal(cv2.imdecode(message.data, cv2.IMREAD_UNCHANGED), frame.image)
    with Video(recording, topic=f"{SPACE}/image/compressed") as video:
        for (_, frame), ours in zip(pictured(steps), video, strict=True):
            assert ours.time == pytest.approx(frame.time, abs=1e-9)
            np.testing.assert_array_equal(ours.image, frame.image)
    with pytest.raises(ValueError, match=r"/follower_1/image/compressed .*/follower_2/image/compressed"):
        Video(recording)


def test_what_a_replay_needs_is_packed(steps: tuple[ChainStep, ...], read: dict[str, list[Any]]) -> None:
    messages = [msgspec.msgpack.decode(bytes(each.msgpack), type=StepMessage) for each in read[f"{SPACE}/step"]]
    assert [each.tick for each in messages] == [chain_step.index for chain_step in steps]
    assert [each.taken for each in messages] == [
        None if chain_step.steps[1].frame is None else chain_step.steps[1].frame.time for chain_step in steps
    ]
