"""Values of messages of ROS 2, member by member, for `CdrEncoder`: header, pose, camera."""

from typing import Any

from matchset.camera.camera_model import CameraModel
from matchset.localization.pose import Pose
from matchset.media.bags.packed_fields import NANO

POSE, POSE_STAMPED = "geometry_msgs/PoseWithCovarianceStamped", "geometry_msgs/PoseStamped"
DETECTIONS, CAMERA_INFO = "vision_msgs/Detection2DArray", "sensor_msgs/CameraInfo"
IMAGE, TRANSFORMS = "sensor_msgs/CompressedImage", "tf2_msgs/TFMessage"
UNTURNED = (0.0, 0.0, 0.0, 1.0)  # geometry: the quaternion of no rotation, x y z w
NOWHERE = (((0.0, 0.0, 0.0), UNTURNED), (0.0,) * 36)  # format: the pose of a detection that has none
IDENTITY = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)  # geometry: of a camera that is not rectified
WHOLE_PICTURE = (0, 0, 0, 0, False)  # format: the region of interest of a camera that shows all it sees


def header_of(time: float, frame_id: str) -> tuple[Any, ...]:
    """std_msgs/Header of a picture that was taken then, s."""
    return divmod(max(round(NANO * time), 0), NANO), frame_id


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
