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
from matchset.flight.recording.ros_definitions import encoder, ros_schema
from matchset.image.frame import Frame
from matchset.localization.pose import Pose
from matchset.shapes.circle import Circle
from matchset.tracking.track import Track

POSE, POSE_STAMPED = "geometry_msgs/PoseWithCovarianceStamped", "geometry_msgs/PoseStamped"
DETECTIONS, CAMERA_INFO = "vision_msgs/Detection2DArray", "sensor_msgs/CameraInfo"
IMAGE, TRANSFORMS, TF = "sensor_msgs/CompressedImage", "tf2_msgs/TFMessage", "/tf"
UNTURNED = (0.0, 0.0, 0.0, 1.0)  # geometry: the quaternion of no rotation, x y z w
NOWHERE = (((0.0, 0.0, 0.0), UNTURNED), (0.0,) * 36)  # format: the pose of a detection that has none
IDENTITY = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)  # geometry: of a camera that is not rectified
WHOLE_PICTURE = (0, 0, 0, 0, False)  # format: the region of interest of a camera that shows all it sees
NANO = 10**9  # format: nanoseconds in a second


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
        return divmod(max(round(NANO * time), 0), NANO), self._frame_id


def ros_topic(topic: str, kind: str) -> RosTopic:
    """Return a topic with the schema of its type."""
    return RosTopic(topic, *ros_schema(kind))


def camera_info(header: tuple[Any, ...], camera: CameraModel) -> tuple[Any, ...]:
    """sensor_msgs/CameraInfo of a camera; "plumb_bob" is ROS's name of the lens with five coefficients."""
    k = (camera.fx, 0.0, camera.cx, 0.0, camera.fy, camera.cy, 0.0, 0.0, 1.0)
    p = (*k[0:3], 0.0, *k[3:6], 0.0, *k[6:9], 0.0)
    sizes = camera.height, camera.width
    return (header, *sizes, "plumb_bob", camera.distortion, k, IDENTITY, p, 0, 0, WHOLE_PICTURE)


def pose_with_covariance(pose: Pose) -> tuple[Any, ...]:
    """geometry_msgs/PoseWithCovariance of a pose: its rotation vector is about the fixed axes, as ROS has it."""
    orientation = UNTURNED if pose.rotation is None else tuple(pose.rotation.as_quat().tolist())
    return (tuple(pose.position.tolist()), orientation), pose.covariance.ravel().tolist()


def detections(header: tuple[Any, ...], step: PilotStep, pose: tuple[Any, ...] | None) -> list[tuple[Any, ...]]:
    """vision_msgs/Detection2D of the ball and of its markers; none if it was lost."""
    found = [_detection(header, step.ball, "ball", pose or NOWHERE)] if isinstance(step.ball, Track) else []
    return found + [_detection(header, marker, "marker", NOWHERE) for marker in step.markers]


def _detection(header: tuple[Any, ...], track: Track[Circle], kind: str, pose: tuple[Any, ...]) -> tuple[Any, ...]:
    circle = track.shape
    box = ((circle.x, circle.y), 0.0), 2.0 * circle.radius, 2.0 * circle.radius
    return header, [((kind, track.support), pose)], box, ""
