"""Contents of the report of a run, from one pass through its records."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

import numpy as np

from twin.arrays import FloatArray
from twin.record import NcEvent, Record, RunHeader, RunSummary, Step
from twin.report.bins import TimeBins
from twin.report.track import Track, TrackKeeper
from twin.run.plausibility import tool_sizes
from twin.run.run import Run
from twin.run.watch import CollisionGroup, Watch

#: Positions with the highest force that get a picture.
MOST_WORST = 4
#: Revolutions of the spindle in the picture of a position.
_TURNS = 2.0


@dataclass(slots=True, kw_only=True)
class LineForces:
    """Forces and engagement of one tool on one NC line.

    Attributes:
        nc_line, tool: line of the NC program, tool number.
        t_s, point_mm: machine time of the peak, and the tool tip there.
        spindle_rpm, feed_mm_min: at the peak.
        peak_n: largest resultant.
        peak_power_w: largest power.
        cutting_time_s: time in cut.
        axial_depth_mm, radial_width_mm, chip_thickness_mm: largest of its steps.
    """

    nc_line: int
    tool: int
    t_s: float = 0.0
    point_mm: tuple[float, float, float] = (0.0, 0.0, 0.0)
    spindle_rpm: float = 0.0
    feed_mm_min: float = 0.0
    peak_n: float = -1.0
    peak_power_w: float = 0.0
    cutting_time_s: float = 0.0
    axial_depth_mm: float = 0.0
    radial_width_mm: float = 0.0
    chip_thickness_mm: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class WorstPosition:
    """A position with a high force, and the forces around its peak.

    Attributes:
        forces: of its NC line.
        t_s: shape (n,), machine time.
        force_n: shape (n, 3), on the tool.
    """

    forces: LineForces
    t_s: FloatArray
    force_n: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportContents:
    """Everything that a report shows.

    Attributes:
        run: the run.
        header, summary: its first and last record.
        blocks: text of the NC lines that are named.
        lines: forces by NC line and tool, highest first.
        worst: positions with the highest forces, highest first, at least a tool's diameter apart.
        bins: forces and engagement over machine time.
        track: the path with its forces.
        tool_changes: machine time and text of each.
        collisions: by NC line, tool and kind.
        warnings: one line each.
    """

    run: Run
    header: RunHeader
    summary: RunSummary
    blocks: dict[int, str]
    lines: tuple[LineForces, ...]
    worst: tuple[WorstPosition, ...]
    bins: TimeBins
    track: Track
    tool_changes: tuple[tuple[float, str], ...]
    collisions: tuple[CollisionGroup, ...]
    warnings: tuple[str, ...]


def report_contents(run: Run) -> ReportContents:
    """Read a run; memory grows with the number of NC lines, not with the samples.

    Raises:
        ArchiveError: the archive is damaged.
    """
    gathered = _Gathered(TimeBins(run.summary.machine_time_s))
    for record in run.records():
        gathered.take(record)
    lines = sorted(gathered.lines.values(), key=lambda each: (-each.peak_n, each.nc_line, each.tool))
    worst = tuple(_with_waveforms(run, list(_apart(lines, run.header))))
    return ReportContents(
        run=run,
        header=run.header,
        summary=run.summary,
        blocks=gathered.blocks,
        lines=tuple(lines),
        worst=worst,
        bins=gathered.bins,
        track=gathered.track.track(),
        tool_changes=tuple(gathered.tool_changes),
        collisions=tuple(gathered.watch.groups),
        warnings=tuple(gathered.watch.warnings(run.summary)),
    )


@dataclass(slots=True)
class _Gathered:
    """Sums of one pass."""

    bins: TimeBins
    lines: dict[tuple[int, int], LineForces] = field(default_factory=dict)
    blocks: dict[int, str] = field(default_factory=dict)
    tool_changes: list[tuple[float, str]] = field(default_factory=list)
    track: TrackKeeper = field(default_factory=TrackKeeper)
    watch: Watch = field(default_factory=Watch)

    def take(self, record: Record) -> None:
        self.watch.take(record)
        if isinstance(record, Step):
            self._step(record)
        elif isinstance(record, NcEvent):
            if record.kind == "block":
                self.blocks.setdefault(record.nc_line, record.text)
            elif record.kind == "tool":
                self.tool_changes.append((record.t_s, record.text))

    def _step(self, step: Step) -> None:
        force = step.samples.force_n
        resultant = np.sqrt(np.einsum("ij,ij->i", force, force))
        peak = float(resultant.max()) if len(resultant) else 0.0
        self.track.add(step, peak)
        self.bins.add(step, resultant)
        if step.engagement.cutting:
            line = self.lines.setdefault(
                (step.nc_line, step.tool), LineForces(nc_line=step.nc_line, tool=step.tool, point_mm=step.start_mm)
            )
            _add(line, step, resultant, peak)


def _add(line: LineForces, step: Step, resultant_n: FloatArray, peak_n: float) -> None:
    engagement = step.engagement
    line.cutting_time_s += step.duration_s
    line.axial_depth_mm = max(line.axial_depth_mm, engagement.axial_depth_mm)
    line.radial_width_mm = max(line.radial_width_mm, engagement.radial_width_mm)
    line.chip_thickness_mm = max(line.chip_thickness_mm, engagement.chip_thickness_mm)
    if not len(resultant_n):
        return
    line.peak_power_w = max(line.peak_power_w, float(step.samples.power_w.max()))
    if peak_n > line.peak_n:
        line.peak_n = peak_n
        line.t_s = float(step.samples.t_s[int(np.argmax(resultant_n))])
        share = min(max((line.t_s - step.t_s) / max(step.duration_s, 1e-12), 0.0), 1.0)
        x, y, z = (a + share * (b - a) for a, b in zip(step.start_mm, step.end_mm, strict=True))
        line.point_mm = (x, y, z)
        line.spindle_rpm, line.feed_mm_min = step.spindle_rpm, step.feed_mm_min


def _apart(lines: Iterable[LineForces], header: RunHeader) -> Iterator[LineForces]:
    """The highest forces at positions at least a tool's diameter apart, or of another tool."""
    sizes = tool_sizes(header)
    chosen: list[LineForces] = []
    for line in lines:
        if len(chosen) == MOST_WORST or line.peak_n <= 0.0:
            return
        width = sizes[line.tool][0] if line.tool in sizes else 0.0
        near = (c for c in chosen if c.tool == line.tool and _distance(c.point_mm, line.point_mm) < width)
        if next(near, None) is None:
            chosen.append(line)
            yield line


def _distance(a: tuple[float, float, float], b: tuple[float, float, float]) -> float:
    return float(np.linalg.norm(np.subtract(a, b)))


def _with_waveforms(run: Run, lines: list[LineForces]) -> Iterator[WorstPosition]:
    """The forces of two revolutions around each peak, from a second pass."""
    spans = [(line.t_s - half, line.t_s + half) for line in lines for half in [_half_span_s(line)]]
    found: list[list[Step]] = [[] for _ in lines]
    if lines:
        for record in run.records():
            if isinstance(record, Step) and len(record.samples.t_s):
                for steps, (begin, end) in zip(found, spans, strict=True):
                    if record.t_s <= end and record.t_s + record.duration_s >= begin:
                        steps.append(record)
    for line, steps, (begin, end) in zip(lines, found, spans, strict=True):
        t_s = np.concatenate([s.samples.t_s for s in steps])
        near = (t_s >= begin) & (t_s <= end)
        force = np.concatenate([s.samples.force_n for s in steps])
        yield WorstPosition(forces=line, t_s=t_s[near], force_n=force[near])


def _half_span_s(line: LineForces) -> float:
    return 0.5 * _TURNS * 60.0 / max(abs(line.spindle_rpm), 1e-3)
