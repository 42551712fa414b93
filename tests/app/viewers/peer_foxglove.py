"""Reads a file of `--mcap` with the package mcap and Foxglove's own messages; prints what it found as JSON.

Run by the Python of .viewers. Each schema is compared with the one of Foxglove's package; each message is decoded by
that, built again from Foxglove's classes, and encoded by them: the bytes must be the same.
"""

import json
import sys
from typing import Any

import foxglove.messages
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from google.protobuf.descriptor import FieldDescriptor
from mcap.reader import make_reader


def described(data: bytes) -> dict[str, Any]:
    """What a set of descriptors says, without the order of its members."""
    found: dict[str, Any] = {}
    for file in descriptor_pb2.FileDescriptorSet.FromString(data).file:
        for message in file.message_type:
            fields = sorted(
                (each.number, each.name, each.type, each.label, each.type_name, each.json_name)
                for each in message.field
            )
            enums = [(each.name, [(value.name, value.number) for value in each.value]) for each in message.enum_type]
            found[f"{file.package}.{message.name}"] = file.name, file.syntax, list(file.dependency), fields, enums
    return found


def message_class(data: bytes, name: str) -> Any:
    """Class of Google's package for a message, by Foxglove's schema."""
    pool = descriptor_pool.DescriptorPool()
    for file in descriptor_pb2.FileDescriptorSet.FromString(data).file:
        pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName(name))


def built(message: Any) -> Any:
    """The same message as an object of Foxglove's package."""
    name = message.DESCRIPTOR.name
    if name in ("Timestamp", "Duration"):
        return getattr(foxglove.messages, name)(message.seconds, message.nanos)
    values: dict[str, Any] = {}
    for field, value in message.ListFields():
        if field.type == FieldDescriptor.TYPE_ENUM:
            kind = {"PointsAnnotation": "PointsAnnotationType", "SceneEntityDeletion": "SceneEntityDeletionType"}[name]
            word = field.enum_type.values_by_number[value].name.title().replace("_", "")
            values[field.name] = getattr(getattr(foxglove.messages, kind), word)
        elif field.type != FieldDescriptor.TYPE_MESSAGE:
            values[field.name] = value if isinstance(value, (str, bytes, float, int)) else list(value)
        elif isinstance(value, type(message)) or hasattr(value, "DESCRIPTOR"):
            values[field.name] = built(value)
        else:
            values[field.name] = [built(each) for each in value]
    return getattr(foxglove.messages, name)(**values)


def looked_at(path: str) -> dict[str, Any]:
    topics: dict[str, list[Any]] = {}
    equal_schemas, equal_bytes, count = True, 0, 0
    with open(path, "rb") as file:  # noqa: PTH123
        reader = make_reader(file, validate_crcs=True)
        summary = reader.get_summary()
        for schema, channel, message in reader.iter_messages():
            assert schema is not None
            own = getattr(foxglove.messages, schema.name.partition(".")[2]).get_schema()
            equal_schemas &= (own.name, own.encoding) == (schema.name, channel.message_encoding)
            equal_schemas &= described(own.data) == described(schema.data)
            decoded = message_class(own.data, schema.name).FromString(message.data)
            count += 1
            equal_bytes += built(decoded).encode() == message.data
            kept = topics.setdefault(channel.topic, [])
            kept.append([message.log_time, _numbers(decoded)])
    return {
        "topics": topics,
        "schemas equal": equal_schemas,
        "messages": count,
        "bytes equal": equal_bytes,
        "indexed": summary is not None and summary.statistics is not None and summary.statistics.message_count,
    }


def _numbers(message: Any) -> Any:
    """What the test compares."""
    name = message.DESCRIPTOR.name
    if name == "PoseInFrame":
        position = message.pose.position
        return [position.x, position.y, position.z]
    if name == "ImageAnnotations":
        return [[text.text, len(line.points)] for text, line in zip(message.texts, message.points, strict=True)]
    if name == "SceneUpdate":
        return [[entity.id, entity.spheres[0].size.x] for entity in message.entities]
    if name == "CompressedImage":
        return [message.format, message.data[:2].hex()]
    return [message.width, message.height, *message.K]


if __name__ == "__main__":
    print(json.dumps(looked_at(sys.argv[1])))
