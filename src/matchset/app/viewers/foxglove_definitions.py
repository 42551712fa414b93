"""Foxglove's messages that a result is written in, member by member, and the encoder of each.

These are foxglove.CompressedImage, CameraCalibration, ImageAnnotations, PoseInFrame and SceneUpdate of foxglove-sdk
(MIT), with all members that they have there, and Timestamp and Duration of Protocol Buffers (BSD).
"""

import functools

from matchset.app.viewers.protobuf import ProtobufEncoder, descriptor_set

_PLACE = "double x = 1\ndouble y = 2\ndouble z = 3"
_PRIMITIVE = "foxglove.Pose pose = 1\nfoxglove.Vector3 size = 2\nfoxglove.Color color = 3"
_ANNOTATION = "google.protobuf.Timestamp timestamp = 1\nfoxglove.Point2 position = 2"
DEFINITIONS = {
    "google.protobuf.Timestamp": "int64 seconds = 1\nint32 nanos = 2",
    "google.protobuf.Duration": "int64 seconds = 1\nint32 nanos = 2",
    "foxglove.Color": "double r = 1\ndouble g = 2\ndouble b = 3\ndouble a = 4",
    "foxglove.KeyValuePair": "string key = 1\nstring value = 2",
    "foxglove.Point2": "double x = 1\ndouble y = 2",
    "foxglove.Point3": _PLACE,
    "foxglove.Vector3": _PLACE,
    "foxglove.Quaternion": f"{_PLACE}\ndouble w = 4",
    "foxglove.Pose": "foxglove.Vector3 position = 1\nfoxglove.Quaternion orientation = 2",
    "foxglove.PoseInFrame": ("google.protobuf.Timestamp timestamp = 1\nstring frame_id = 2\nfoxglove.Pose pose = 3"),
    "foxglove.CompressedImage": (
        "google.protobuf.Timestamp timestamp = 1\nbytes data = 2\nstring format = 3\nstring frame_id = 4"
    ),
    "foxglove.CameraCalibration": (
        "google.protobuf.Timestamp timestamp = 1\nfixed32 width = 2\nfixed32 height = 3\nstring distortion_model = 4\n"
        "repeated double D = 5\nrepeated double K = 6\nrepeated double R = 7\nrepeated double P = 8\n"
        "string frame_id = 9"
    ),
    "foxglove.CircleAnnotation": (
        f"{_ANNOTATION}\ndouble diameter = 3\ndouble thickness = 4\nfoxglove.Color fill_color = 5\n"
        "foxglove.Color outline_color = 6\nrepeated foxglove.KeyValuePair metadata = 7"
    ),
    "foxglove.PointsAnnotation.Type": "enum UNKNOWN POINTS LINE_LOOP LINE_STRIP LINE_LIST",
    "foxglove.PointsAnnotation": (
        "google.protobuf.Timestamp timestamp = 1\nfoxglove.PointsAnnotation.Type type = 2\n"
        "repeated foxglove.Point2 points = 3\nfoxglove.Color outline_color = 4\n"
        "repeated foxglove.Color outline_colors = 5\nfoxglove.Color fill_color = 6\ndouble thickness = 7\n"
        "repeated foxglove.KeyValuePair metadata = 8"
    ),
    "foxglove.TextAnnotation": (
        f"{_ANNOTATION}\nstring text = 3\ndouble font_size = 4\nfoxglove.Color text_color = 5\n"
        "foxglove.Color background_color = 6\nrepeated foxglove.KeyValuePair metadata = 7"
    ),
    "foxglove.ImageAnnotations": (
        "repeated foxglove.CircleAnnotation circles = 1\nrepeated foxglove.PointsAnnotation points = 2\n"
        "repeated foxglove.TextAnnotation texts = 3\nrepeated foxglove.KeyValuePair metadata = 4\n"
        "google.protobuf.Timestamp timestamp = 5"
    ),
    "foxglove.ArrowPrimitive": (
        "foxglove.Pose pose = 1\ndouble shaft_length = 2\ndouble shaft_diameter = 3\ndouble head_length = 4\n"
        "double head_diameter = 5\nfoxglove.Color color = 6"
    ),
    "foxglove.CubePrimitive": _PRIMITIVE,
    "foxglove.SpherePrimitive": _PRIMITIVE,
    "foxglove.CylinderPrimitive": (
        "foxglove.Pose pose = 1\nfoxglove.Vector3 size = 2\ndouble bottom_scale = 3\ndouble top_scale = 4\n"
        "foxglove.Color color = 5"
    ),
    "foxglove.LinePrimitive.Type": "enum LINE_STRIP LINE_LOOP LINE_LIST",
    "foxglove.LinePrimitive": (
        "foxglove.LinePrimitive.Type type = 1\nfoxglove.Pose pose = 2\ndouble thickness = 3\n"
        "bool scale_invariant = 4\nrepeated foxglove.Point3 points = 5\nfoxglove.Color color = 6\n"
        "repeated foxglove.Color colors = 7\nrepeated fixed32 indices = 8"
    ),
    "foxglove.TriangleListPrimitive": (
        "foxglove.Pose pose = 1\nrepeated foxglove.Point3 points = 2\nfoxglove.Color color = 3\n"
        "repeated foxglove.Color colors = 4\nrepeated fixed32 indices = 5"
    ),
    "foxglove.TextPrimitive": (
        "foxglove.Pose pose = 1\nbool billboard = 2\ndouble font_size = 3\nbool scale_invariant = 4\n"
        "foxglove.Color color = 5\nstring text = 6"
    ),
    "foxglove.ModelPrimitive": (
        "foxglove.Pose pose = 1\nfoxglove.Vector3 scale = 2\nfoxglove.Color color = 3\nbool override_color = 4\n"
        "string url = 5\nstring media_type = 6\nbytes data = 7"
    ),
    "foxglove.SceneEntityDeletion.Type": "enum MATCHING_ID ALL",
    "foxglove.SceneEntityDeletion": (
        "google.protobuf.Timestamp timestamp = 1\nfoxglove.SceneEntityDeletion.Type type = 2\nstring id = 3"
    ),
    "foxglove.SceneEntity": (
        "google.protobuf.Timestamp timestamp = 1\nstring frame_id = 2\nstring id = 3\n"
        "google.protobuf.Duration lifetime = 4\nbool frame_locked = 5\nrepeated foxglove.KeyValuePair metadata = 6\n"
        "repeated foxglove.ArrowPrimitive arrows = 7\nrepeated foxglove.CubePrimitive cubes = 8\n"
        "repeated foxglove.SpherePrimitive spheres = 9\nrepeated foxglove.CylinderPrimitive cylinders = 10\n"
        "repeated foxglove.LinePrimitive lines = 11\nrepeated foxglove.TriangleListPrimitive triangles = 12\n"
        "repeated foxglove.TextPrimitive texts = 13\nrepeated foxglove.ModelPrimitive models = 14"
    ),
    "foxglove.SceneUpdate": (
        "repeated foxglove.SceneEntityDeletion deletions = 1\nrepeated foxglove.SceneEntity entities = 2"
    ),
}


@functools.cache
def foxglove_encoder(kind: str) -> ProtobufEncoder:
    """Return the encoder of a type: ``foxglove.SceneUpdate``."""
    return ProtobufEncoder(kind, DEFINITIONS)


@functools.cache
def foxglove_schema(kind: str) -> bytes:
    """Return what an MCAP schema of a type holds."""
    return descriptor_set(kind, DEFINITIONS)
