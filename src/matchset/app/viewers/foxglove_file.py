"""A result as messages of Foxglove in an MCAP file: `FoxgloveFile`. Coordinates are Foxglove's, see decision 150."""

from pathlib import Path
from typing import Any

from matchset.app.viewers.foxglove_definitions import foxglove_encoder, foxglove_schema
from matchset.app.viewers.mcap_writer import Channel, ChannelWriter
from matchset.app.viewers.viewed_frame import CORNER, Points, ViewedFrame, ViewedTarget
from matchset.camera.camera_model import CameraModel
from matchset.localization.pose import Pose
from matchset.media.closing import Closing
from matchset.numeric.words import measured

IMAGE, CALIBRATION = "foxglove.CompressedImage", "foxglove.CameraCalibration"
ANNOTATIONS, SCENE, POSE = "foxglove.ImageAnnotations", "foxglove.SceneUpdate", "foxglove.PoseInFrame"
CAMERA = "camera"  # format: name of the frame of coordinates, x right, y down, z forward
TOPICS = {
    "/camera/image": IMAGE,
    "/camera/outlines": ANNOTATIONS,
    "/camera/calibration": CALIBRATION,
    "/targets/scene": SCENE,
}
LINE_LOOP, LINE_LIST = 2, 4  # format: kinds of PointsAnnotation
ALL = 1  # format: kind of SceneEntityDeletion
NANO = 10**9  # format: nanoseconds in a second
IDENTITY = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)  # geometry: of a camera that is not rectified
UNTURNED = (0.0, 0.0, 0.0, 1.0)  # geometry: the quaternion of no rotation, x y z w
# format: widths of lines, size of letters, px; darkness of the ground of a name, opacity of a sphere
SEEN_WIDTH, PREDICTED_WIDTH, LETTERS, GROUND, OPACITY = 2.0, 1.0, 14.0, 0.7, 0.6

Message = dict[str, Any]


class FoxgloveFile(Closing):
    """Writes frames as they come; what came before is on the disk if the program is killed.

    Parameters
    ----------
    path : Path
    camera : CameraModel or None
        Where targets are located.
    diameter : float
        Of the balls, m.

    Raises
    ------
    ValueError, OSError
        As those of `ChannelWriter`.
    """

    def __init__(self, path: Path, camera: CameraModel | None = None, diameter: float = 0.0) -> None:
        self._camera, self._diameter = camera, diameter
        self._writer = ChannelWriter(path)

    def write(self, seen: ViewedFrame) -> None:
        """Append a frame; one that could not be decoded has no picture, and no message.

        Raises
        ------
        OSError
            If it does not fit on the disk.
        """
        if not seen.jpeg:
            return
        stamp = _stamp(seen.time)
        header = {"timestamp": stamp, "frame_id": CAMERA}
        messages: dict[str, Message] = {"/camera/image": header | {"data": seen.jpeg, "format": "jpeg"}}
        messages["/camera/outlines"] = annotations(seen.targets, stamp)
        if self._camera is not None:
            messages["/camera/calibration"] = header | calibration(self._camera)
            entities = [self._entity(each, each.pose, stamp) for each in seen.targets if each.pose is not None]
            messages["/targets/scene"] = {"deletions": [{"timestamp": stamp, "type": ALL}], "entities": entities}
        for each in seen.targets:
            if each.pose is not None:
                messages[f"/targets/{each.target.identity}/pose"] = header | {"pose": _placed(each.pose)}
        for topic, message in messages.items():
            kind = TOPICS.get(topic, POSE)
            self._writer.add_channel(Channel(topic, kind, foxglove_schema(kind), "protobuf", "protobuf"))
            self._writer.append(topic, foxglove_encoder(kind).encode(message), seen.time, seen.number)
        self._writer.flush()

    def close(self) -> None:
        """Finish the file."""
        self._writer.close()

    def discard(self) -> None:
        """Delete what was written; what was there before stays."""
        self._writer.discard()

    def _entity(self, seen: ViewedTarget, pose: Pose, stamp: Message) -> Message:
        """SceneEntity of a ball: a sphere, and its numbers."""
        told = {"identity": str(seen.target.identity), "label": seen.target.label}
        for name, (value, sigma) in seen.measured().items():
            told[name] = f"{measured(value, sigma)} {'rad' if name == 'yaw' else 'm'}"
        size = dict.fromkeys("xyz", self._diameter)
        return {
            "timestamp": stamp,
            "frame_id": CAMERA,
            "id": str(seen.target.identity),
            "metadata": [{"key": key, "value": value} for key, value in told.items()],
            "spheres": [{"pose": _placed(pose), "size": size, "color": _color(seen, OPACITY)}],
        }


def annotations(targets: tuple[ViewedTarget, ...], stamp: Message) -> Message:
    """ImageAnnotations of the targets in a frame: outlines, dashed where one should be, with their names.

    Parameters
    ----------
    targets : tuple of ViewedTarget
    stamp : dict
        A timestamp.
    """
    lines, texts = [], []
    for each in targets:
        ring, dashes = each.outline, each.predicted
        if ring is not None:
            lines.append(_line(LINE_LOOP, ring, each, SEEN_WIDTH, stamp))
        elif dashes is not None and len(dashes):
            lines.append(_line(LINE_LIST, dashes.reshape(-1, 2), each, PREDICTED_WIDTH, stamp))
        else:
            continue
        points = dashes.reshape(-1, 2) if ring is None and dashes is not None else ring
        if points is not None:
            texts.append(_name(points, each, stamp))
    return {"timestamp": stamp, "points": lines, "texts": texts}


def calibration(camera: CameraModel) -> Message:
    """Members of CameraCalibration; "plumb_bob" is ROS's name of the lens with five coefficients."""
    cx, cy = camera.cx + CORNER, camera.cy + CORNER
    k = (camera.fx, 0.0, cx, 0.0, camera.fy, cy, 0.0, 0.0, 1.0)
    return {
        "width": camera.width,
        "height": camera.height,
        "distortion_model": "plumb_bob",
        "D": camera.distortion,
        "K": k,
        "R": IDENTITY,
        "P": (*k[0:3], 0.0, *k[3:6], 0.0, *k[6:9], 0.0),
    }


def _stamp(time: float) -> Message:
    seconds, nanos = divmod(max(round(NANO * time), 0), NANO)
    return {"seconds": seconds, "nanos": nanos}


def _placed(pose: Pose) -> Message:
    """Pose of a ball; one whose rotation is not observed is not turned."""
    turn = UNTURNED if pose.rotation is None else pose.rotation.as_quat().tolist()
    position = dict(zip("xyz", pose.position.tolist(), strict=True))
    return {"position": position, "orientation": dict(zip("xyzw", turn, strict=True))}


def _color(seen: ViewedTarget, opacity: float = 1.0) -> Message:
    return dict(zip("rgba", (*(part / 255.0 for part in seen.color), opacity), strict=True))


def _line(kind: int, points: Points, seen: ViewedTarget, width: float, stamp: Message) -> Message:
    return {
        "timestamp": stamp,
        "type": kind,
        "points": [{"x": x, "y": y} for x, y in points.tolist()],
        "outline_color": _color(seen),
        "thickness": width,
    }


def _name(points: Points, seen: ViewedTarget, stamp: Message) -> Message:
    """TextAnnotation at the upper right of an outline."""
    return {
        "timestamp": stamp,
        "position": {"x": float(points[:, 0].max()), "y": float(points[:, 1].min())},
        "text": seen.words,
        "font_size": LETTERS,
        "text_color": _color(seen),
        "background_color": {"a": GROUND},
    }
