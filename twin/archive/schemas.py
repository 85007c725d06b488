"""Topics of a run's file and the protobuf messages on them, as tables.

The descriptors are built from the tables below, so no protobuf compiler is needed, and every file carries them. The
``foxglove.*`` messages have the field numbers of the published schemas, so that viewers draw them; fields numbered
from 100 are additions of this program, skipped by viewers, from which a reader restores exactly what was written.
"""

from __future__ import annotations

from functools import cache
from typing import Any, TypeAlias

from google.protobuf import descriptor_pb2, descriptor_pool, message_factory, timestamp_pb2
from google.protobuf.message import Message

PROFILE = "twin"
#: A comparison of a run with a measured log.
COMPARISON_PROFILE = "twin-comparison"
#: Name of the writer in the header of a file, before the version.
LIBRARY = "machining-twin"
#: Its end, after the version, for files whose metadata have checksums.
WITH_CHECKSUMS = ", archive 2"
ENCODING = "protobuf"

#: Force samples of many steps in a message, and what viewers show of them.
PACKED_TOPIC = "/force/packed"
REVOLUTION_TOPIC = "/force/revolution"
#: Each force sample, in the files of versions up to 0.1.0.
FORCE_TOPIC = "/force"
ENGAGEMENT_TOPIC = "/engagement"
POSE_TOPIC = "/machine/tool"
TOOL_SHAPE_TOPIC = "/machine/tool/shape"
NC_TOPIC = "/nc"
COLLISION_TOPIC = "/collision"
COMPARISON_TOPIC = "/compare/force"
#: Every patch of the workpiece has its own topic, ``/workpiece/<patch>``, so that a viewer replaces only that patch.
WORKPIECE_PREFIX = "/workpiece/"

PACKED = "twin.PackedForces"
REVOLUTION = "twin.RevolutionForce"
FORCE = "twin.CuttingForce"
ENGAGEMENT = "twin.Engagement"
COMPARISON = "twin.ComparedForce"
TRANSFORM = "foxglove.FrameTransform"
CLOUD = "foxglove.PointCloud"
LOG = "foxglove.Log"

#: Message on each topic; a topic that is not listed is a patch of the workpiece and carries `CLOUD`.
TOPICS: dict[str, str] = {
    PACKED_TOPIC: PACKED,
    REVOLUTION_TOPIC: REVOLUTION,
    FORCE_TOPIC: FORCE,
    ENGAGEMENT_TOPIC: ENGAGEMENT,
    POSE_TOPIC: TRANSFORM,
    TOOL_SHAPE_TOPIC: CLOUD,
    NC_TOPIC: LOG,
    COLLISION_TOPIC: LOG,
    COMPARISON_TOPIC: COMPARISON,
}

WORKPIECE_FRAME = "workpiece"
TOOL_FRAME = "tool"

_TIMESTAMP = "google.protobuf.Timestamp"

Field: TypeAlias = tuple[str, int, str]

#: Fields (name, number, type) of every message; ``repeated`` precedes the type, as in a .proto file.
MESSAGES: dict[str, tuple[Field, ...]] = {
    PACKED: (
        ("samples", 1, "repeated uint32"),
        ("nc_line", 2, "repeated uint32"),
        ("tool", 3, "repeated uint32"),
        ("t_s", 4, "bytes"),
        ("spindle_angle_rad", 5, "bytes"),
        ("force_exponent", 6, "repeated sint32"),
        ("fx_n", 7, "bytes"),
        ("fy_n", 8, "bytes"),
        ("fz_n", 9, "bytes"),
        ("torque_exponent", 10, "repeated sint32"),
        ("torque_nm", 11, "bytes"),
        ("power_exponent", 12, "repeated sint32"),
        ("power_w", 13, "bytes"),
    ),
    REVOLUTION: (
        ("t_s", 1, "double"),
        ("fx_lowest_n", 2, "float"),
        ("fx_highest_n", 3, "float"),
        ("fx_mean_n", 4, "float"),
        ("fy_lowest_n", 5, "float"),
        ("fy_highest_n", 6, "float"),
        ("fy_mean_n", 7, "float"),
        ("fz_lowest_n", 8, "float"),
        ("fz_highest_n", 9, "float"),
        ("fz_mean_n", 10, "float"),
        ("resultant_highest_n", 11, "float"),
        ("resultant_mean_n", 12, "float"),
        ("torque_highest_nm", 13, "float"),
        ("torque_mean_nm", 14, "float"),
        ("nc_line", 15, "fixed32"),
    ),
    FORCE: (
        ("t_s", 1, "double"),
        ("spindle_angle_rad", 2, "double"),
        ("fx_n", 3, "double"),
        ("fy_n", 4, "double"),
        ("fz_n", 5, "double"),
        ("torque_nm", 6, "double"),
        ("power_w", 7, "double"),
        ("nc_line", 8, "fixed32"),
        ("tool", 9, "fixed32"),
    ),
    COMPARISON: (
        ("t_s", 1, "double"),
        ("spindle_angle_rad", 2, "double"),
        ("measured_x_n", 3, "double"),
        ("measured_y_n", 4, "double"),
        ("measured_z_n", 5, "double"),
        ("simulated_x_n", 6, "double"),
        ("simulated_y_n", 7, "double"),
        ("simulated_z_n", 8, "double"),
    ),
    ENGAGEMENT: (
        ("step", 1, "uint64"),
        ("t_s", 2, "double"),
        ("duration_s", 3, "double"),
        ("start_x_mm", 4, "double"),
        ("start_y_mm", 5, "double"),
        ("start_z_mm", 6, "double"),
        ("end_x_mm", 7, "double"),
        ("end_y_mm", 8, "double"),
        ("end_z_mm", 9, "double"),
        ("nc_line", 10, "uint32"),
        ("tool", 11, "uint32"),
        ("rapid", 12, "bool"),
        ("feed_mm_min", 13, "double"),
        ("spindle_rpm", 14, "double"),
        ("axial_depth_mm", 15, "double"),
        ("radial_width_mm", 16, "double"),
        ("arc_rad", 17, "double"),
        ("chip_thickness_mm", 18, "double"),
        ("removal_rate_mm3_s", 19, "double"),
        ("cutting", 20, "bool"),
        ("samples", 21, "uint64"),
    ),
    "foxglove.Vector3": (("x", 1, "double"), ("y", 2, "double"), ("z", 3, "double")),
    "foxglove.Quaternion": (("x", 1, "double"), ("y", 2, "double"), ("z", 3, "double"), ("w", 4, "double")),
    "foxglove.Pose": (("position", 1, "foxglove.Vector3"), ("orientation", 2, "foxglove.Quaternion")),
    TRANSFORM: (
        ("timestamp", 1, _TIMESTAMP),
        ("parent_frame_id", 2, "string"),
        ("child_frame_id", 3, "string"),
        ("translation", 4, "foxglove.Vector3"),
        ("rotation", 5, "foxglove.Quaternion"),
    ),
    "foxglove.PackedElementField": (
        ("name", 1, "string"),
        ("offset", 2, "fixed32"),
        ("type", 3, "foxglove.PackedElementField.NumericType"),
    ),
    CLOUD: (
        ("timestamp", 1, _TIMESTAMP),
        ("frame_id", 2, "string"),
        ("pose", 3, "foxglove.Pose"),
        ("point_stride", 4, "fixed32"),
        ("fields", 5, "repeated foxglove.PackedElementField"),
        ("data", 6, "bytes"),
        ("t_s", 100, "double"),
        ("patch", 101, "string"),
        ("triangles", 102, "bytes"),
        ("triangle_count", 103, "uint32"),
        ("packed_triangles", 104, "bytes"),
        ("packed_normals", 105, "bytes"),
    ),
    LOG: (
        ("timestamp", 1, _TIMESTAMP),
        ("level", 2, "foxglove.Log.Level"),
        ("message", 3, "string"),
        ("name", 4, "string"),
        ("file", 5, "string"),
        ("line", 6, "fixed32"),
        ("t_s", 100, "double"),
        ("tool", 101, "uint32"),
        ("point_mm", 102, "foxglove.Vector3"),
        ("volume_mm3", 103, "double"),
    ),
}

#: Values of the enumerations, numbered from 0; an enumeration belongs to the message that its name begins with.
ENUMS: dict[str, tuple[str, ...]] = {
    "foxglove.Log.Level": ("UNKNOWN", "DEBUG", "INFO", "WARNING", "ERROR", "FATAL"),
    "foxglove.PackedElementField.NumericType": (
        *("UNKNOWN", "UINT8", "INT8", "UINT16", "INT16", "UINT32", "INT32", "FLOAT32", "FLOAT64"),
    ),
}

INFO, WARNING, ERROR = 2, 3, 4
UINT8, FLOAT32 = 1, 7

_Proto = descriptor_pb2.FieldDescriptorProto
_SCALARS: dict[str, Any] = {
    "double": _Proto.TYPE_DOUBLE,
    "float": _Proto.TYPE_FLOAT,
    "fixed32": _Proto.TYPE_FIXED32,
    "uint32": _Proto.TYPE_UINT32,
    "uint64": _Proto.TYPE_UINT64,
    "sint32": _Proto.TYPE_SINT32,
    "bool": _Proto.TYPE_BOOL,
    "string": _Proto.TYPE_STRING,
    "bytes": _Proto.TYPE_BYTES,
}


def message_on(topic: str) -> str:
    """Full name of the message on a topic."""
    return TOPICS.get(topic, CLOUD)


@cache
def message_class(name: str) -> type[Any]:
    """Generated class of a message, by full name, e.g. ``twin.CuttingForce``."""
    return message_factory.GetMessageClass(_pool().FindMessageTypeByName(name))


@cache
def descriptor_set(name: str) -> bytes:
    """Serialised ``FileDescriptorSet`` of a message and all messages in it: the data of an MCAP schema record."""
    files = descriptor_pb2.FileDescriptorSet()
    if _TIMESTAMP in {t.removeprefix("repeated ") for m in _closure(name) for _, _, t in MESSAGES[m]}:
        timestamp_pb2.DESCRIPTOR.CopyToProto(files.file.add())
    files.file.append(_file(name))
    return files.SerializeToString(deterministic=True)


def embedded_class(schema: bytes, name: str) -> type[Message]:
    """Class of a message described by a file's own schema, e.g. one written by another program.

    Raises:
        TypeError, KeyError, google.protobuf.message.DecodeError: the bytes are not a schema of that message.
    """
    pool = descriptor_pool.DescriptorPool()
    for file in descriptor_pb2.FileDescriptorSet.FromString(schema).file:
        pool.Add(file)
    return message_factory.GetMessageClass(pool.FindMessageTypeByName(name))


def proto_text(name: str) -> str:
    """A message as the human-readable text of a .proto file."""
    lines = [f"message {name.rpartition('.')[2]} {{"]
    for enum, values in _enums_of(name):
        body = " ".join(f"{value} = {number};" for number, value in enumerate(values))
        lines.append(f"  enum {enum} {{ {body} }}")
    lines += [f"  {kind} {field} = {number};" for field, number, kind in MESSAGES[name]]
    return "\n".join([*lines, "}"])


def _enums_of(name: str) -> list[tuple[str, tuple[str, ...]]]:
    """Short names and values of the enumerations inside a message."""
    return [(e.rpartition(".")[2], v) for e, v in ENUMS.items() if e.rpartition(".")[0] == name]


def _closure(name: str) -> list[str]:
    """A message and the messages that it contains, contained ones first."""
    inner = [t.removeprefix("repeated ") for _, _, t in MESSAGES[name]]
    found = [m for t in inner if t in MESSAGES for m in _closure(t)]
    return list(dict.fromkeys([*found, name]))


def _file(name: str) -> descriptor_pb2.FileDescriptorProto:
    """The file of one schema: the message with the messages in it."""
    file = descriptor_pb2.FileDescriptorProto(name=f"{name}.proto", package=name.partition(".")[0], syntax="proto3")
    for message in _closure(name):
        if any(kind == _TIMESTAMP for _, _, kind in MESSAGES[message]):
            file.dependency[:] = [timestamp_pb2.DESCRIPTOR.name]
        _fill(file.message_type.add(), message)
    return file


def _fill(proto: descriptor_pb2.DescriptorProto, name: str) -> None:
    """Write the table of one message into its descriptor."""
    proto.name = name.rpartition(".")[2]
    for enum, values in _enums_of(name):
        nested = proto.enum_type.add(name=enum)
        for number, value in enumerate(values):
            nested.value.add(name=value, number=number)
    for field, number, kind in MESSAGES[name]:
        bare = kind.removeprefix("repeated ")
        label = _Proto.LABEL_OPTIONAL if bare == kind else _Proto.LABEL_REPEATED
        made = proto.field.add(name=field, number=number, label=label)
        if bare in _SCALARS:
            made.type = _SCALARS[bare]
        else:
            made.type = _Proto.TYPE_ENUM if bare in ENUMS else _Proto.TYPE_MESSAGE
            made.type_name = f".{bare}"


@cache
def _pool() -> descriptor_pool.DescriptorPool:
    """A pool of this program's own, without other definitions of the same names."""
    pool = descriptor_pool.DescriptorPool()
    timestamp = descriptor_pb2.FileDescriptorProto()
    timestamp_pb2.DESCRIPTOR.CopyToProto(timestamp)
    pool.Add(timestamp)
    for package in ("twin", "foxglove"):
        file = descriptor_pb2.FileDescriptorProto(name=f"{package}.proto", package=package, syntax="proto3")
        if package == "foxglove":
            file.dependency.append(timestamp.name)
        for message in MESSAGES:
            if message.startswith(package + "."):
                _fill(file.message_type.add(), message)
        pool.Add(file)
    return pool
