"""What a replay says: the records that sinks, archives and comparisons see, and all that they see.

Lengths mm, time s (machine time from program start), forces N, torque N·m, power W, angles rad. Coordinates are the
workpiece frame: the work offset that the job's stock is given in. Arrays are read-only.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

from twin.arrays import FloatArray
from twin.settings.force_on import ForceOn

CollisionKind: TypeAlias = Literal["rapid", "shank", "holder", "spindle-stopped"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Attachment:
    """A file that belongs to the run: NC program, job file, stock STL."""

    name: str
    media_type: str
    data: bytes


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolRecord:
    """A tool as a viewer needs it: its name and its profile of revolution.

    Attributes:
        description: e.g. ``ball D8 z2``.
        profile_mm: shape (n, 2): radius and height above the tip, upwards from (0, 0), shank and holder included.
    """

    number: int
    description: str
    profile_mm: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class RunHeader:
    """First record of a run.

    Attributes:
        stock_bounds_mm: shape (2, 3), lower and upper corner of the stock.
        slice_pitch_mm: pitch of the slices along x, y and z.
        force_on: always ``"tool"`` in records; readers turn the sign for the workpiece.
        planned_time_s: machine time of the whole program.
        parameters: every setting that shaped the result, by job-file key path, as text.
    """

    twin_version: str
    program: str
    stock_bounds_mm: FloatArray
    slice_pitch_mm: tuple[float, float, float]
    tools: tuple[ToolRecord, ...]
    planned_time_s: float
    force_on: ForceOn = "tool"
    parameters: dict[str, str]
    attachments: tuple[Attachment, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Engagement:
    """Summary of the tool's contact with the stock in one step; all zero in air.

    Attributes:
        axial_depth_mm: height from the lowest to the highest engaged edge element.
        radial_width_mm: width of the engaged part of the tool's front across the feed direction.
        arc_rad: engaged angle about the tool axis, over all heights.
        chip_thickness_mm: largest uncut chip thickness on an engaged element.
        removal_rate_mm3_s: engaged front area projected on the feed direction times the feed.
        cutting: whether anything is engaged.
    """

    axial_depth_mm: float = 0.0
    radial_width_mm: float = 0.0
    arc_rad: float = 0.0
    chip_thickness_mm: float = 0.0
    removal_rate_mm3_s: float = 0.0
    cutting: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceSamples:
    """Forces at the spindle-angle steps inside one step; ``n`` may be 0.

    Attributes:
        t_s: shape (n,), machine time of each sample, increasing.
        spindle_angle_rad: shape (n,), angle of the spindle since program start, continuous through the program;
            negative rates under M4. Angle 0 has the tip of tooth 0 at +x.
        force_n: shape (n, 3), force on the tool in machine axes x, y, z.
        torque_nm: shape (n,), torque of the cutting forces about the tool axis that the spindle must supply, >= 0.
        power_w: shape (n,), torque times spindle speed.
    """

    t_s: FloatArray
    spindle_angle_rad: FloatArray
    force_n: FloatArray
    torque_nm: FloatArray
    power_w: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """One small tool motion of the replay.

    Attributes:
        index: counts the steps from 0.
        t_s, duration_s: start of the step and how long it takes.
        start_mm, end_mm: tool tip in the workpiece frame.
        nc_line: line of the NC program.
        tool: tool number.
        rapid: True for positioning motions.
        feed_mm_min: speed along the path (the rapid rate for rapids), 0 in a dwell.
        spindle_rpm: signed, positive for M3, negative for M4, 0 stopped.
    """

    index: int
    t_s: float
    duration_s: float
    start_mm: tuple[float, float, float]
    end_mm: tuple[float, float, float]
    nc_line: int
    tool: int
    rapid: bool
    feed_mm_min: float
    spindle_rpm: float
    engagement: Engagement
    samples: ForceSamples


@dataclass(frozen=True, slots=True, kw_only=True)
class NcEvent:
    """Something the program said.

    Attributes:
        kind: ``block`` (a block begins), ``tool`` (tool change), ``spindle``, ``coolant``, ``stop``, ``dwell``,
            ``notice`` (a word without effect here).
        text: the block's text, or what happened, e.g. ``T2 ball D8``, ``M3 S3600``.
    """

    t_s: float
    nc_line: int
    kind: Literal["block", "tool", "spindle", "coolant", "stop", "dwell", "notice"]
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Collision:
    """Something touched the stock that must not, or cut when it must not.

    Attributes:
        kind: ``rapid`` (positioning motion through the stock), ``shank``, ``holder``, ``spindle-stopped``.
        point_mm: tool tip where it began.
        volume_mm3: material swept by the offending body in this motion.
        message: one line for people, with NC line and place.
    """

    t_s: float
    nc_line: int
    tool: int
    kind: CollisionKind
    point_mm: tuple[float, float, float]
    volume_mm3: float
    message: str


@dataclass(frozen=True, slots=True, kw_only=True)
class WorkpiecePatch:
    """The surface of one block of the workpiece as it is from ``t_s`` on; replaces the patch of the same name.

    Attributes:
        patch: name of the block, stable through a run, e.g. ``x0_y2``.
        vertices_mm: shape (n, 3) float32; n may be 0 where nothing is left.
        normals: shape (n, 3) float32, outward unit normals.
        triangles: shape (m, 3) uint32, counter-clockwise seen from outside.
    """

    t_s: float
    patch: str
    vertices_mm: NDArray[np.float32]
    normals: NDArray[np.float32]
    triangles: NDArray[np.uint32]


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolSummary:
    """What one tool did; peaks with the NC line where they occurred. Force order: x, y, z, resultant."""

    number: int
    description: str
    cutting_time_s: float
    air_time_s: float
    rapid_time_s: float
    removed_volume_mm3: float
    peak_force_n: tuple[float, float, float, float]
    mean_force_n: tuple[float, float, float, float]
    peak_torque_nm: float
    mean_torque_nm: float
    peak_power_w: float
    peak_line: int


@dataclass(frozen=True, slots=True, kw_only=True)
class RunSummary:
    """Last record of a run that came to its end (or was ended by the user: ``complete`` is False).

    Attributes:
        mean_force_n: mean of x, y, z and resultant over cutting time.
        peak_force_n: largest absolute x, y, z and largest resultant.
        top_lines: NC line, its text, and its highest resultant force, highest first, at most 10.
        digest: hash of every force sample and of the final slices' areas: equal runs have equal digests.
    """

    complete: bool
    machine_time_s: float
    cutting_time_s: float
    removed_volume_mm3: float
    steps: int
    samples: int
    peak_force_n: tuple[float, float, float, float]
    mean_force_n: tuple[float, float, float, float]
    collisions: int
    tools: tuple[ToolSummary, ...]
    top_lines: tuple[tuple[int, str, float], ...]
    digest: str


Record: TypeAlias = RunHeader | NcEvent | Step | Collision | WorkpiecePatch | RunSummary
