"""Scenes for the viewer: tool paths over their part, uncut material, and deviations."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from twin.arrays import FloatArray
from twin.cam.path.toolpath import MoveKind, ToolPath
from twin.cam.reach.tool_reach import Reach
from twin.cam.reach.uncut_mesh import uncut_mesh
from twin.planning.part_reach import PartReach, tool_name
from twin.sinks.rerun.still import Colors, Still, StillLines, StillMesh, StillPoints
from twin.verification.deviation import Deviation
from twin.workpiece.solids.from_mesh import Solid

_COLORS: dict[MoveKind, tuple[int, int, int]] = {
    MoveKind.RAPID: (150, 150, 160),
    MoveKind.LINK: (240, 180, 40),
    MoveKind.LEAD: (60, 190, 110),
    MoveKind.PLUNGE: (220, 70, 60),
    MoveKind.RAMP: (200, 90, 200),
    MoveKind.HELIX: (200, 90, 200),
    MoveKind.CUT: (50, 130, 230),
    MoveKind.RETRACT: (150, 150, 160),
}
_PART = (170, 176, 184)
#: Colours of uncut material, by tool.
_TOOL_COLORS = ((226, 66, 40), (240, 168, 40), (60, 132, 226), (58, 176, 92), (166, 84, 196))
#: Number of regions with a label in the scene.
_NAMED = 12
#: Colours from gouge through zero to excess.
_MAP = np.array([(178, 24, 43), (239, 138, 98), (235, 235, 235), (103, 169, 207), (33, 102, 172)], dtype=np.float64)


def paths_still(paths: Mapping[str, ToolPath], part: Solid) -> Still:
    """Paths over their part, coloured by kind of move.

    Args:
        paths: paths by the names of their entities.
        part: the part.
    """
    lines = [
        StillLines(
            entity=f"{name}/{kind.value}",
            lines_mm=[m.chords_mm() for m in path.of_kind(kind)],
            color=color,
            width=0.6 if kind is MoveKind.RAPID else 1.2,
        )
        for name, path in paths.items()
        for kind, color in _COLORS.items()
        if any(True for _ in path.of_kind(kind))
    ]
    text = "\n\n".join("\n".join((f"# {p.name}", "", *(f"- {n}" for n in p.notes))) for p in paths.values())
    return Still(name=f"{Path(part.name).name}: tool paths", meshes=[_mesh(part)], lines=lines, text=text)


def reach_still(found: PartReach) -> Still:
    """Uncut material on a part, with its thickest points."""
    reaches, part = found.tools, found.part.mesh
    colors = {text: _TOOL_COLORS[k % len(_TOOL_COLORS)] for k, text in enumerate(reaches)}
    left = {text: reach for text, reach in reaches.items() if reach.uncut_regions}
    meshes = [_mesh(part)]
    for text, reach in left.items():
        made = uncut_mesh(reach.uncut_regions)
        entity = f"uncut/{tool_name(text)}"
        meshes.append(
            StillMesh(entity=entity, vertices_mm=made.vertices_mm, triangles=made.triangles, color=colors[text])
        )
    points = [
        StillPoints(
            entity=f"thickest/{tool_name(text)}",
            points_mm=np.array([r.deepest_mm for r in reach.uncut_regions[:_NAMED]]),
            colors=np.array([colors[text]] * min(_NAMED, len(reach.uncut_regions)), dtype=np.uint8),
            radius_mm=reach.pitch_mm,
            labels=[f"{text}: {r.thickness_mm:.3f} mm" for r in reach.uncut_regions[:_NAMED]],
        )
        for text, reach in left.items()
    ]
    title = f"{Path(part.name).name}: uncut material"
    return Still(name=title, meshes=meshes, points=points, text=f"# {title}\n\n{_reach_table(reaches)}")


def _reach_table(reaches: Mapping[str, Reach]) -> str:
    """Table of tools, Markdown."""
    rows = [
        f"| {text} | {reach.volume_mm3:.4g} | {reach.thickness_mm:.3f} | {len(reach.uncut_regions)} |"
        if reach.uncut_regions
        else f"| {text} | none | | |"
        for text, reach in reaches.items()
    ]
    return "\n".join(("| tool | uncut, mm³ | thickest, mm | regions |", "| --- | --- | --- | --- |", *rows))


def deviation_still(found: Deviation, part: Solid, title: str) -> Still:
    """Points of the machined surface coloured by deviation, the part, and labels of the regions out of tolerance."""
    text = "\n".join(
        (
            f"# {title}",
            "",
            f"- deepest gouge {1000.0 * found.worst_gouge_mm:.1f} µm, allowed {1000.0 * found.tolerance_mm:g}",
            f"- largest excess {1000.0 * found.worst_excess_mm:.1f} µm, allowed {1000.0 * found.excess_mm:g}",
            f"- {100.0 * found.within:.2f} % of the machined area within tolerance",
            f"- rays {found.pitch_mm:.3g} mm apart, deviations accurate to {1000.0 * found.resolution_mm:.1f} µm",
            "- red: gouge, white: on size, blue: excess; full colour at twice the larger tolerance",
        )
    )
    points = StillPoints(
        entity="deviation",
        points_mm=found.points_mm,
        colors=deviation_colors(found.deviation_mm, max(found.tolerance_mm, found.excess_mm)),
        radius_mm=0.5 * found.pitch_mm,
    )
    worst = found.regions[:_NAMED]
    named = StillPoints(
        entity="out_of_tolerance",
        points_mm=np.array([p.point_mm for p in worst]).reshape(-1, 3),
        colors=np.tile(np.array((250, 210, 60), dtype=np.uint8), (len(worst), 1)),
        radius_mm=2.0 * found.pitch_mm,
        labels=[f"{p.kind} {p.worst_mm:.3f} mm" for p in worst],
    )
    return Still(name=title, meshes=[_mesh(part)], points=[points, named], text=text)


def deviation_colors(deviation_mm: FloatArray, end_mm: float) -> Colors:
    """Red for gouges, white for zero, blue for excess; full colour at twice the tolerance."""
    at = np.clip(deviation_mm / (2.0 * end_mm), -1.0, 1.0) * 2.0 + 2.0
    low = np.minimum(at.astype(np.int64), 3)
    part = (at - low)[:, None]
    colors: Colors = np.rint(_MAP[low] * (1.0 - part) + _MAP[low + 1] * part).astype(np.uint8)
    return colors


def _mesh(part: Solid) -> StillMesh:
    return StillMesh(entity="part", vertices_mm=part.vertices_mm, triangles=part.triangles, color=_PART)
