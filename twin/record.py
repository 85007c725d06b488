"""Records of a run: everything that a replay gives to sinks, archives and comparisons.

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
    """A file attached to the run: NC program, job file, stock STL."""

    name: str
    media_type: str
    data: bytes


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolRecord:
    """A tool as viewers need it: its name and the profile of its surface of revolution.

    Attributes:
        number: tool number.
        description: e.g. ``ball D8 z2``.
        profile_mm: shape (n, 2): radius and height above the tip, upwards from (0, 0), shank and holder included.
    """

    number: int
    description: str
    profile_mm: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class RunHeader:
    """First record of a run: stock, tools, settings and attached files.

    Attributes:
        twin_version: version of the program that computed the run.
        program: file name of the NC program.
        stock_bounds_mm: shape (2, 3), lower and upper corner of the stock.
        slice_pitch_mm: pitch of the slices along x, y and z.
        tools: the tools of the job.
        planned_time_s: machine time of the whole program.
        work_bounds_mm: shape (2, 3), corners of the box of the tool tip in feed motions below the top of the stock;
            None without any, and in runs of earlier versions.
        force_on: always ``"tool"`` in records; readers change the sign for the workpiece.
        parameters: every setting that affects the result, as text by job-file key path.
        attachments: job file, sizes of tools from libraries, NC program, and stock STL if there is one.
        job: key of the job file's path (`twin.archive.same_job.job_key`), empty if it is not known.
    """

    twin_version: str
    program: str
    stock_bounds_mm: FloatArray
    slice_pitch_mm: tuple[float, float, float]
    tools: tuple[ToolRecord, ...]
    planned_time_s: float
    work_bounds_mm: FloatArray | None = None
    force_on: ForceOn = "tool"
    parameters: dict[str, str]
    attachments: tuple[Attachment, ...] = ()
    job: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Engagement:
    """Engagement of the tool with the stock in one step; all zero in air.

    Attributes:
        axial_depth_mm: axial depth of cut, from the lowest to the highest engaged edge element.
        radial_width_mm: radial depth of cut, the width of the engaged tool surface across the feed direction.
        arc_rad: engaged angle about the tool axis, over all heights.
        chip_thickness_mm: largest uncut chip thickness of the engaged elements.
        removal_rate_mm3_s: material removal rate: engaged area projected on the feed direction, times the feed.
        cutting: whether any element is engaged.
    """

    axial_depth_mm: float = 0.0
    radial_width_mm: float = 0.0
    arc_rad: float = 0.0
    chip_thickness_mm: float = 0.0
    removal_rate_mm3_s: float = 0.0
    cutting: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class ForceSamples:
    """Cutting forces at the spindle-angle steps inside one step of the motion; ``n`` may be 0.

    Attributes:
        t_s: shape (n,), machine time of each sample, increasing.
        spindle_angle_rad: shape (n,), spindle angle since program start, continuous through the program; it falls
            under M4. At angle 0 the tip of tooth 0 points to +x.
        force_n: shape (n, 3), force on the tool in machine axes x, y, z.
        torque_nm: shape (n,), torque about the tool axis that the spindle must supply, >= 0.
        power_w: shape (n,), torque times spindle speed.
    """

    t_s: FloatArray
    spindle_angle_rad: FloatArray
    force_n: FloatArray
    torque_nm: FloatArray
    power_w: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class Step:
    """One small tool motion of the replay, with its engagement and force samples.

    Attributes:
        index: number of the step, from 0.
        t_s, duration_s: machine time at its start, and its duration.
        start_mm, end_mm: tool tip in the workpiece frame.
        nc_line: line of the NC program.
        tool: tool number.
        rapid: whether it is a rapid (positioning) motion.
        feed_mm_min: speed along the path (the rapid traverse rate for rapids), 0 in a dwell.
        spindle_rpm: spindle speed, positive for M3, negative for M4, 0 with the spindle stopped.
        engagement: of the tool with the stock.
        samples: forces.
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
    """An event of the NC program that is not a motion.

    Attributes:
        t_s: machine time.
        nc_line: line of the NC program.
        kind: ``block`` (a block begins), ``tool`` (tool change), ``spindle``, ``coolant``, ``stop``, ``dwell``,
            ``notice`` (a word without effect in a replay).
        text: the block's text, or a description of the event, e.g. ``T2 ball D8``, ``M3 S3600``.
    """

    t_s: float
    nc_line: int
    kind: Literal["block", "tool", "spindle", "coolant", "stop", "dwell", "notice"]
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Collision:
    """A collision with the stock, or a cut by a motion that must not cut.

    Attributes:
        t_s: machine time at which it began.
        nc_line: line of the NC program.
        tool: tool number.
        kind: ``rapid`` (rapid motion through the stock), ``shank`` or ``holder`` (touches the stock), or
            ``spindle-stopped`` (feed motion through the stock with the spindle stopped).
        point_mm: tool tip at its beginning.
        volume_mm3: material swept by the colliding body in this motion.
        message: one human-readable line with NC line and position.
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
    """The surface of one block of the workpiece from ``t_s`` on; it replaces the patch of the same name.

    Attributes:
        t_s: machine time.
        patch: name of the block, the same throughout a run, e.g. ``x0_y2``.
        vertices_mm: shape (n, 3) float32; n is 0 where no material is left.
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
    """Times, removed volume and forces of one tool.

    Attributes:
        number: tool number.
        description: e.g. ``ball D8 z2``.
        cutting_time_s, air_time_s, rapid_time_s: time in cut, at feed in air, and in rapid motion.
        removed_volume_mm3: volume of material removed.
        peak_force_n: largest absolute x, y, z and largest resultant.
        mean_force_n: mean of x, y, z and resultant over its cutting time.
        peak_torque_nm, mean_torque_nm: torque that the spindle must supply.
        peak_power_w: largest power.
        peak_line: NC line of the largest resultant.
    """

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
    """Last record of a run: its totals.

    Attributes:
        complete: whether the program was replayed to its end; False after Ctrl-C or a collision in a strict replay.
        machine_time_s: machine time of what was replayed, motions, dwells and tool changes.
        cutting_time_s: part of it in cut.
        removed_volume_mm3: volume of material removed.
        steps, samples: number of steps and of force samples.
        peak_force_n: largest absolute x, y, z and largest resultant.
        mean_force_n: mean of x, y, z and resultant over the cutting time.
        collisions: number of collisions.
        tools: totals by tool.
        top_lines: NC line, its text, and its highest resultant force, highest first, at most 10.
        digest: hash of all force samples and of the final slices' areas: equal runs have equal digests.
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
