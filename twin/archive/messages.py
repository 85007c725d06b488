"""Records to protobuf payloads and back, one pair of functions per kind of record (forces: `twin.archive.samples`)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from twin.archive import schemas
from twin.archive.container.chunk import to_ns
from twin.archive.samples.columns import pack, unpack
from twin.record import Collision, Engagement, ForceSamples, NcEvent, Step, ToolRecord, WorkpiecePatch

_ENGAGEMENT_FIELDS = (
    "axial_depth_mm",
    "radial_width_mm",
    "arc_rad",
    "chip_thickness_mm",
    "removal_rate_mm3_s",
    "cutting",
)
_STEP_FIELDS = ("t_s", "duration_s", "nc_line", "tool", "rapid", "feed_mm_min", "spindle_rpm")
_LEVELS = {"notice": schemas.WARNING}
_UPRIGHT = {"w": 1.0}

_XYZ, _NORMAL = ("x", "y", "z"), ("nx", "ny", "nz")
_COLOR = [(c, "u1") for c in ("red", "green", "blue", "alpha")]
#: A point of a cloud as viewers read it: position and colour.
POINT = np.dtype([(name, "<f4") for name in _XYZ] + _COLOR)
#: A point in the files of versions up to 0.1.0, whose triangles are three uint32 each.
_POINT_WITH_NORMAL = np.dtype([(name, "<f4") for name in (*_XYZ, *_NORMAL)] + _COLOR)
#: Components of a normal are stored as whole multiples of 1 / 127; of the triangles' corners, differences.
_NORMAL_UNITS = 127.0
_TRIANGLE_ORDER = 1
_STEEL_RGB = (176, 184, 196)
_BRASS_RGB = (214, 176, 92)
#: Unit vector towards the light that shades the points, and the share of the light on the side away from it.
_LIGHT = (-0.36, -0.48, 0.8)
_AMBIENT = 0.35
#: Points around the axis, and their distance along the profile, of the drawn tool.
_TOOL_ANGLES = 24
_TOOL_PITCH_MM = 0.5


def engagement(step: Step, samples: int) -> bytes:
    """A step without its samples, as `twin.Engagement`.

    Args:
        samples: number of those that the file keeps.
    """
    values: dict[str, Any] = {name: getattr(step, name) for name in _STEP_FIELDS}
    values |= {name: getattr(step.engagement, name) for name in _ENGAGEMENT_FIELDS}
    for point, at in (("start", step.start_mm), ("end", step.end_mm)):
        values |= {f"{point}_{axis}_mm": value for axis, value in zip("xyz", at, strict=True)}
    return _payload(schemas.ENGAGEMENT, step=step.index, samples=samples, **values)


def to_step(message: Any, samples: ForceSamples) -> Step:
    """A step from its `twin.Engagement` and its samples."""
    return Step(
        index=message.step,
        start_mm=(message.start_x_mm, message.start_y_mm, message.start_z_mm),
        end_mm=(message.end_x_mm, message.end_y_mm, message.end_z_mm),
        engagement=Engagement(**{name: getattr(message, name) for name in _ENGAGEMENT_FIELDS}),
        samples=samples,
        **{name: getattr(message, name) for name in _STEP_FIELDS},
    )


def pose(t_s: float, tip_mm: tuple[float, float, float]) -> bytes:
    """Position of the tool tip, as a `foxglove.FrameTransform` from workpiece to tool."""
    return _payload(
        schemas.TRANSFORM,
        timestamp=_timestamp(t_s),
        parent_frame_id=schemas.WORKPIECE_FRAME,
        child_frame_id=schemas.TOOL_FRAME,
        translation=_vector(tip_mm),
        rotation=_UPRIGHT,
    )


def nc(event: NcEvent, program: str) -> bytes:
    """An event of the program as a `foxglove.Log` whose text begins with the line number."""
    return _payload(
        schemas.LOG,
        timestamp=_timestamp(event.t_s),
        level=_LEVELS.get(event.kind, schemas.INFO),
        message=f"{event.nc_line}: {event.text}",
        name=event.kind,
        file=program,
        line=event.nc_line,
        t_s=event.t_s,
    )


def to_nc(message: Any) -> NcEvent:
    """An event from its `foxglove.Log`."""
    text = message.message.removeprefix(f"{message.line}: ")
    return NcEvent(t_s=message.t_s, nc_line=message.line, kind=cast(Any, message.name), text=text)


def collision(record: Collision, program: str) -> bytes:
    """A collision as a `foxglove.Log` of level ERROR."""
    return _payload(
        schemas.LOG,
        timestamp=_timestamp(record.t_s),
        level=schemas.ERROR,
        message=record.message,
        name=record.kind,
        file=program,
        line=record.nc_line,
        t_s=record.t_s,
        tool=record.tool,
        point_mm=_vector(record.point_mm),
        volume_mm3=record.volume_mm3,
    )


def to_collision(message: Any) -> Collision:
    """A collision from its `foxglove.Log`."""
    point = message.point_mm
    return Collision(
        t_s=message.t_s,
        nc_line=message.line,
        tool=message.tool,
        kind=cast(Any, message.name),
        point_mm=(point.x, point.y, point.z),
        volume_mm3=message.volume_mm3,
        message=message.message,
    )


def patch(record: WorkpiecePatch) -> bytes:
    """A patch of the workpiece as a `foxglove.PointCloud` of its vertices; normals and triangles in further fields."""
    corners = record.triangles.reshape(-1).astype(np.int64)
    return _cloud_payload(
        record.t_s,
        schemas.WORKPIECE_FRAME,
        _cloud(record.vertices_mm, record.normals, _STEEL_RGB),
        patch=record.patch,
        triangle_count=len(record.triangles),
        packed_triangles=pack(corners, _TRIANGLE_ORDER),
        packed_normals=np.rint(record.normals * np.float32(_NORMAL_UNITS)).astype(np.int8).tobytes(),
    )


def to_patch(message: Any) -> WorkpiecePatch:
    """A patch from its `foxglove.PointCloud`.

    Raises:
        ValueError: the cloud's data are not in this program's layout.
    """
    earlier = message.point_stride == _POINT_WITH_NORMAL.itemsize
    cloud = np.frombuffer(message.data, _POINT_WITH_NORMAL if earlier else POINT)
    if earlier:
        normals, corners = _triples([cloud[c] for c in _NORMAL]), np.frombuffer(message.triangles, "<u4")
    else:
        normals, corners = _normals(message.packed_normals, len(cloud)), _corners(message)
    return WorkpiecePatch(
        t_s=message.t_s,
        patch=message.patch,
        vertices_mm=_triples([cloud[c] for c in _XYZ]),
        normals=normals,
        triangles=corners.reshape(-1, 3),
    )


def _normals(data: bytes, count: int) -> NDArray[np.float32]:
    """Unit normals of a patch, shape (count, 3).

    Raises:
        ValueError: another number of them.
    """
    normals = np.frombuffer(data, np.int8).reshape(count, 3).astype(np.float32)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), np.float32(1.0))
    normals.flags.writeable = False
    return normals


def _corners(message: Any) -> NDArray[np.uint32]:
    """Vertices of the triangles of a patch, three of each.

    Raises:
        ValueError: fewer than the message states.
    """
    if message.triangle_count > len(message.packed_triangles):
        raise ValueError(f"{message.triangle_count} triangles in {len(message.packed_triangles)} bytes")
    corners = unpack(message.packed_triangles, 3 * message.triangle_count, _TRIANGLE_ORDER).astype(np.uint32)
    corners.flags.writeable = False
    return corners


def tool_shape(t_s: float, tool: ToolRecord) -> bytes:
    """The tool's surface of revolution as a `foxglove.PointCloud` in the frame of the tool, for viewers only."""
    profile = _spread(np.asarray(tool.profile_mm, np.float64))
    angle = 2.0 * np.pi * np.arange(_TOOL_ANGLES) / _TOOL_ANGLES
    radius, height = np.repeat(profile, _TOOL_ANGLES, axis=0).T
    cos, sin = np.tile(np.cos(angle), len(profile)), np.tile(np.sin(angle), len(profile))
    points = np.column_stack([radius * cos, radius * sin, height]).astype(np.float32)
    normals = np.column_stack([cos, sin, np.zeros(len(points))]).astype(np.float32)
    return _cloud_payload(t_s, schemas.TOOL_FRAME, _cloud(points, normals, _BRASS_RGB))


def _spread(profile_mm: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points about `_TOOL_PITCH_MM` apart along an open polyline of shape (n, 2)."""
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(profile_mm, axis=0).T))])
    at = np.linspace(0.0, along[-1], max(2, int(along[-1] / _TOOL_PITCH_MM) + 1))
    return np.column_stack([np.interp(at, along, profile_mm[:, 0]), np.interp(at, along, profile_mm[:, 1])])


def _cloud(points: NDArray[np.float32], normals: NDArray[np.float32], rgb: tuple[int, int, int]) -> NDArray[np.void]:
    """Points of a cloud, shaded by their normals so that a viewer shows a surface."""
    cloud = np.zeros(len(points), POINT)
    for column, name in enumerate(_XYZ):
        cloud[name] = points[:, column]
    lit = np.clip(np.nan_to_num(normals @ np.array(_LIGHT, np.float32)), 0.0, 1.0)
    for name, value in zip(("red", "green", "blue"), rgb, strict=True):
        cloud[name] = (value * (_AMBIENT + (1.0 - _AMBIENT) * lit)).astype(np.uint8)
    cloud["alpha"] = 255
    return cloud


def _cloud_payload(t_s: float, frame: str, cloud: NDArray[np.void], **more: Any) -> bytes:
    """A `foxglove.PointCloud` of points of the type `POINT`."""
    return _payload(
        schemas.CLOUD,
        timestamp=_timestamp(t_s),
        frame_id=frame,
        pose={"position": {}, "orientation": _UPRIGHT},
        point_stride=POINT.itemsize,
        fields=_POINT_FIELDS,
        data=cloud.tobytes(),
        t_s=t_s,
        **more,
    )


def _point_fields() -> list[dict[str, Any]]:
    """The columns of `POINT` as `foxglove.PackedElementField`."""
    fields: Mapping[str, Any] = POINT.fields or {}
    kinds = {"f": schemas.FLOAT32, "u": schemas.UINT8}
    return [{"name": n, "offset": f[1], "type": kinds[f[0].kind]} for n, f in fields.items()]


_POINT_FIELDS = _point_fields()


def _triples(columns: list[NDArray[np.float32]]) -> NDArray[np.float32]:
    array = np.stack(columns, axis=1)
    array.flags.writeable = False
    return array


def _timestamp(t_s: float) -> dict[str, int]:
    """Machine time as a protobuf timestamp."""
    seconds, nanos = divmod(to_ns(t_s), 1_000_000_000)
    return {"seconds": seconds, "nanos": nanos}


def _vector(xyz: tuple[float, float, float]) -> dict[str, float]:
    return dict(zip("xyz", xyz, strict=True))


def _payload(schema: str, /, **values: Any) -> bytes:
    """Serialised message of a schema."""
    return cast(bytes, schemas.message_class(schema)(**values).SerializeToString())
