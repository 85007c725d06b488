"""Scenes for the viewer: a tool path over its part, and deviations."""

from __future__ import annotations

import numpy as np

from twin.arrays import FloatArray
from twin.cam.toolpath import MoveKind, ToolPath
from twin.sinks.rerun_still import Colors, Still, StillLines, StillMesh, StillPoints
from twin.verify.deviation import Deviation
from twin.workpiece.from_mesh import Solid

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
#: Places that are named in the scene.
_NAMED = 12
#: Colours from gouge over right to excess.
_MAP = np.array([(178, 24, 43), (239, 138, 98), (235, 235, 235), (103, 169, 207), (33, 102, 172)], dtype=np.float64)


def path_still(path: ToolPath, part: Solid) -> Still:
    """A path over its part, lines coloured by the kind of their moves."""
    lines = [
        StillLines(
            entity=f"path/{kind.value}",
            lines_mm=[m.chords_mm() for m in path.of_kind(kind)],
            color=color,
            width=0.6 if kind is MoveKind.RAPID else 1.2,
        )
        for kind, color in _COLORS.items()
        if any(True for _ in path.of_kind(kind))
    ]
    return Still(
        meshes=[_mesh(part)], lines=lines, text="\n".join((f"# {path.name}", "", *(f"- {n}" for n in path.notes)))
    )


def deviation_still(found: Deviation, part: Solid, title: str) -> Still:
    """Points of the machined surface coloured by deviation, the part, and the places out of tolerance by name."""
    text = "\n".join(
        (
            f"# {title}",
            "",
            f"- deepest gouge {1000.0 * found.worst_gouge_mm:.1f} µm, allowed {1000.0 * found.tolerance_mm:g}",
            f"- largest excess {1000.0 * found.worst_excess_mm:.1f} µm, allowed {1000.0 * found.excess_mm:g}",
            f"- {100.0 * found.within:.2f} % of the machined area within both",
            f"- rays {found.pitch_mm:.3g} mm apart, distances known to {1000.0 * found.resolution_mm:.1f} µm",
            "- red: gone, white: right, blue: left; full at twice the larger bound",
        )
    )
    points = StillPoints(
        entity="deviation",
        points_mm=found.points_mm,
        colors=deviation_colors(found.deviation_mm, max(found.tolerance_mm, found.excess_mm)),
        radius_mm=0.5 * found.pitch_mm,
    )
    worst = found.places[:_NAMED]
    named = StillPoints(
        entity="places",
        points_mm=np.array([p.point_mm for p in worst]).reshape(-1, 3),
        colors=np.tile(np.array((250, 210, 60), dtype=np.uint8), (len(worst), 1)),
        radius_mm=2.0 * found.pitch_mm,
        labels=[f"{p.kind} {p.worst_mm:.3f} mm" for p in worst],
    )
    return Still(meshes=[_mesh(part)], points=[points, named], text=text)


def deviation_colors(deviation_mm: FloatArray, end_mm: float) -> Colors:
    """Red for what is gone, white for what is right, blue for what is left; full at twice the tolerance."""
    at = np.clip(deviation_mm / (2.0 * end_mm), -1.0, 1.0) * 2.0 + 2.0
    low = np.minimum(at.astype(np.int64), 3)
    part = (at - low)[:, None]
    colors: Colors = np.rint(_MAP[low] * (1.0 - part) + _MAP[low + 1] * part).astype(np.uint8)
    return colors


def _mesh(part: Solid) -> StillMesh:
    return StillMesh(entity="part", vertices_mm=part.vertices_mm, triangles=part.triangles, color=_PART)
