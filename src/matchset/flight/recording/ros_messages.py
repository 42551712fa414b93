"""A step of a follower as messages of ROS 2: `RosMessages`. A replay reads the picture of them only.

Each follower has a namespace: ``/follower_1/ball/pose``. Its camera's frame of coordinates, ``follower_1/camera``, is
optical as REP 103 has it: x right, y down, z forward. Stamps are the times of capture.
"""

from collections.abc import Iterator
from typing import Any

from matchset.camera.camera_model import CameraModel
from matchset.flight.chain.pilot import PilotStep
from matchset.flight.recording.coded_camera import CodedFrame
from matchset.flight.recording.mcap_file import RecordedMessage, RosTopic
from matchset.flight.recording.messages import image_topic, namespace
from matchset.image.frame import Frame
from matchset.localization.pose import Pose
from matchset.shapes.circle import Circle
from matchset.sharing.ros2.ros_definitions import encoder, ros_schema
from matchset.sharing.ros2.ros_values import (
    CAMERA_INFO,
    DETECTIONS,
    IMAGE,
    NOWHERE,
    POSE,
    POSE_STAMPED,
    TRANSFORMS,
    camera_info,
    header_of,
    pose_with_covariance,
)
from matchset.tracking.track import Track

TF = "/tf"


class RosMessages:
    """Makes the messages of one follower.

    Parameters
    ----------
    number : int
        Of the follower, from 1.
    camera : CameraModel
    """

    def __init__(self, number: int, camera: CameraModel) -> None:
        self._space, self._camera = namespace(number), camera
        self._frame_id, self._child_id = f"{self._space[1:]}/camera", f"{self._space[1:]}/ball"
        self._image = image_topic(number)

    @property
    def topics(self) -> list[RosTopic]:
        """The topics, beside `/tf`, which all followers share."""
        kinds = {
            self._image: IMAGE,
            f"{self._space}/camera_info": CAMERA_INFO,
            f"{self._space}/ball/detections": DETECTIONS,
            f"{self._space}/ball/pose": POSE,
            f"{self._space}/ball/pose_stamped": POSE_STAMPED,
        }
        return [ros_topic(topic, kind) for topic, kind in kinds.items()]

    def picture(self, frame: Frame, data: bytes) -> RecordedMessage:
        """Make the message of a picture, coded as JPEG if it came so, and as PNG otherwise."""
        coding = "jpeg" if isinstance(frame, CodedFrame) else "png"
        return RecordedMessage(self._image, encoder(IMAGE).encode((self._header(frame.time), coding, data)))

    def results(self, step: PilotStep) -> Iterator[RecordedMessage]:
        """Make the messages of what was found in the picture of a step; none if there was no picture."""
        if step.frame is None:
            return
        header = self._header(step.frame.time)
        yield RecordedMessage(
            f"{self._space}/camera_info", encoder(CAMERA_INFO).encode(camera_info(header, self._camera))
        )
        pose = pose_with_covariance(step.pose) if isinstance(step.pose, Pose) else None
        found = detections(header, step, pose)
        yield RecordedMessage(f"{self._space}/ball/detections", encoder(DETECTIONS).encode((header, found)))
        if pose is None:
            return
        position, orientation = pose[0]
        transform = header, self._child_id, (position, orientation)
        yield RecordedMessage(f"{self._space}/ball/pose", encoder(POSE).encode((header, pose)))
        yield RecordedMessage(f"{self._space}/ball/pose_stamped", encoder(POSE_STAMPED).encode((header, pose[0])))
        yield RecordedMessage(TF, encoder(TRANSFORMS).encode(([transform],)))

    def _header(self, time: float) -> tuple[Any, ...]:
        """std_msgs/Header of a picture."""
        return header_of(time, self._frame_id)


def ros_topic(topic: str, kind: str) -> RosTopic:
    """Return a topic with the schema of its type."""
    return RosTopic(topic, *ros_schema(kind))


def detections(header: tuple[Any, ...], step: PilotStep, pose: tuple[Any, ...] | None) -> list[tuple[Any, ...]]:
    """vision_msgs/Detection2D of the ball and of its markers; none if it was lost."""
    found = [_detection(header, step.ball, "ball", pose or NOWHERE)] if isinstance(step.ball, Track) else []
    return found + [_detection(header, marker, "marker", NOWHERE) for marker in step.markers]


def _detection(header: tuple[Any, ...], track: Track[Circle], kind: str, pose: tuple[Any, ...]) -> tuple[Any, ...]:
    circle = track.shape
    box = ((circle.x, circle.y), 0.0), 2.0 * circle.radius, 2.0 * circle.radius
    return header, [((kind, track.support), pose)], box, ""
