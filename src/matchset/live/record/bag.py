"""The pictures, detections and poses of a stream as a bag of ROS 2: `BagWriter` writes an MCAP file."""

from pathlib import Path
from typing import Any

import cv2

from matchset.flight.recording.mcap_file import McapWriter, RecordedMessage
from matchset.flight.recording.ros_messages import TF, ros_topic
from matchset.image.frame import Frame
from matchset.live.feed import StreamPicture
from matchset.live.record.target_tables import plain_name
from matchset.live.wire.state import TargetState
from matchset.localization.pose import Pose
from matchset.media.closing import Closing
from matchset.sharing.ros2.ros_definitions import encoder
from matchset.sharing.ros2.ros_values import (
    CAMERA_INFO,
    DETECTIONS,
    IMAGE,
    NOWHERE,
    POSE,
    TRANSFORMS,
    camera_info,
    header_of,
    pose_with_covariance,
)


class BagWriter(Closing):
    """Writes the topics of a camera: `/camera_1/image/compressed`, `camera_info`, `detections`, a pose for each target.

    What came before is on the disk if the program is killed.

    Parameters
    ----------
    path : Path
    space : str
        Namespace: ``/camera_1``.
    quality : int
        Of the JPEGs, 1 ... 100.

    Raises
    ------
    ValueError, OSError
        As those of `McapWriter`.
    """

    def __init__(self, path: Path, space: str, quality: int) -> None:
        self._space, self._frame_id, self._quality = space, space[1:], quality
        kinds = {"image/compressed": IMAGE, "camera_info": CAMERA_INFO, "detections": DETECTIONS}
        topics = [ros_topic(f"{space}/{name}", kind) for name, kind in kinds.items()]
        self._writer = McapWriter(path, [*topics, ros_topic(TF, TRANSFORMS)])
        self._poses: dict[int, str] = {}

    def write(self, number: int, frame: Frame, seen: StreamPicture) -> None:
        """Append a picture with what was found in it.

        Raises
        ------
        OSError
            If it does not fit on the disk.
        """
        header = header_of(frame.time, self._frame_id)
        done, jpeg = cv2.imencode(".jpg", frame.image, [cv2.IMWRITE_JPEG_QUALITY, self._quality])
        if not done:
            raise ValueError(f"a picture of {frame.image.shape} cannot be encoded as JPEG")
        messages = [self._message("image/compressed", IMAGE, (header, "jpeg", jpeg.tobytes()))]
        if seen.camera is not None:
            messages.append(self._message("camera_info", CAMERA_INFO, camera_info(header, seen.camera)))
        found = [target for target in seen.state.targets if target.found]
        poses = {target.id: pose for target in found if isinstance(pose := seen.poses.get(target.id), Pose)}
        detections = [_detection(header, target, poses.get(target.id)) for target in found]
        messages.append(self._message("detections", DETECTIONS, (header, detections)))
        for target in found:
            if target.id in poses:
                messages += self._pose(header, target, poses[target.id])
        for message in messages:
            self._writer.write(message, frame.time, number)
        self._writer.flush()

    def close(self) -> None:
        """Finish the file."""
        self._writer.close()

    def _message(self, name: str, kind: str, content: tuple[Any, ...]) -> RecordedMessage:
        return RecordedMessage(f"{self._space}/{name}", encoder(kind).encode(content))

    def _pose(self, header: tuple[Any, ...], target: TargetState, pose: Pose) -> list[RecordedMessage]:
        name = self._poses.get(target.id)
        if name is None:  # that of the first pose, whatever it is called later
            name = plain_name(target)
            name = f"{name}_{target.id}" if name in self._poses.values() else name
            self._poses[target.id] = name
            self._writer.add_topic(ros_topic(f"{self._space}/{name}/pose", POSE))
        placed = pose_with_covariance(pose)
        transform = header, f"{self._frame_id}/{name}", placed[0]
        return [
            self._message(f"{name}/pose", POSE, (header, placed)),
            RecordedMessage(TF, encoder(TRANSFORMS).encode(([transform],))),
        ]


def _detection(header: tuple[Any, ...], target: TargetState, pose: Pose | None) -> tuple[Any, ...]:
    """vision_msgs/Detection2D of a target: the box around its outline."""
    x, y = target.outline[::2], target.outline[1::2]
    center = ((min(x) + max(x)) / 2.0, (min(y) + max(y)) / 2.0) if x else (0.0, 0.0)
    sides = (max(x) - min(x), max(y) - min(y)) if x else (0.0, 0.0)
    result = (target.name, target.support or 0.0), NOWHERE if pose is None else pose_with_covariance(pose)
    return header, [result], ((center, 0.0), *sides), str(target.id)
