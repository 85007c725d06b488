"""Report of ``twin reach``: human-readable tables, or one JSON object."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich import box
from rich.table import Table
from rich.text import Text

from twin.cli.console import results
from twin.number_format import plural

if TYPE_CHECKING:
    from twin.arrays import FloatArray
    from twin.cam.reach.tool_reach import Reach
    from twin.cam.reach.uncut_regions import UncutRegion
    from twin.planning.part_reach import PartReach

#: Regions in the table of each tool; the object of --json has all.
_MOST_REGIONS = 12


def print_reach(part: Path, found: PartReach) -> None:
    """Print tables of tools and of uncut regions."""
    console, slices = results(), found.part.slices
    size = " x ".join(f"{s:.5g}" for s in slices.high_mm - slices.low_mm)
    triangles, pitch = len(found.part.mesh.triangles), float(slices.pitch_mm.max())
    console.print(Text(f"{part}: {size} mm, {triangles} triangles, slices {pitch:.4g} mm apart"), soft_wrap=True)
    if found.tools:
        console.print()
        console.print(_tools_table(found.tools))
    for text, reach in found.tools.items():
        if reach.uncut_regions:
            console.print()
            console.print(Text(f"{text}: {plural(len(reach.uncut_regions), 'region')}", style="bold"))
            console.print(_regions_table(reach.uncut_regions[:_MOST_REGIONS]))
    if found.settings.largest:
        console.print()
        console.print(Text(_ball_text(found.largest_ball_mm)))


def _ball_text(diameter_mm: float | None) -> str:
    if diameter_mm is None:
        return "No ball that slices at this pitch can resolve finishes the part: there are sharp inner edges."
    return f"Largest ball that finishes the part: diameter {diameter_mm:.3g} mm."


def _tools_table(reaches: Mapping[str, Reach]) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for head in ("tool", "from", "uncut, mm³", "thickest, mm", "regions", "ignored below, mm"):
        table.add_column(head, justify="left" if head in ("tool", "from") else "right", no_wrap=True)
    for text, reach in reaches.items():
        side = "any side" if reach.element.centred else "above"
        if not reach.uncut_regions:
            table.add_row(text, side, "none", "", "", f"{reach.thin_mm:.3f}")
            continue
        numbers = (f"{reach.volume_mm3:.4g}", f"{reach.thickness_mm:.3f}", str(len(reach.uncut_regions)))
        table.add_row(text, side, *numbers, f"{reach.thin_mm:.3f}")
    return table


def _regions_table(regions: tuple[UncutRegion, ...]) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    for head in ("uncut, mm³", "thickest, mm", "at x, y, z", "X", "Y", "Z"):
        table.add_column(head, justify="right", no_wrap=True)
    for region in regions:
        spans = (f"{a:.2f} to {b:.2f}" for a, b in zip(region.low_mm, region.high_mm, strict=True))
        deepest = ", ".join(f"{c:.2f}" for c in region.deepest_mm)
        table.add_row(f"{region.volume_mm3:.4g}", f"{region.thickness_mm:.3f}", deepest, *spans)
    return table


def reach_json(part: Path, found: PartReach) -> str:
    """The object of ``--json``."""
    made: dict[str, Any] = {
        "part": str(part),
        "pitch_mm": found.part.slices.pitch_mm.tolist(),
        "tools": [_tool(text, reach) for text, reach in found.tools.items()],
    }
    if found.settings.largest:
        made["largest_ball_diameter_mm"] = found.largest_ball_mm
    return json.dumps(made, indent=2, ensure_ascii=False)


def _tool(text: str, reach: Reach) -> dict[str, Any]:
    return {
        "tool": text,
        "from_above": not reach.element.centred,
        "volume_mm3": reach.volume_mm3,
        "thickness_mm": reach.thickness_mm,
        "thin_mm": reach.thin_mm,
        "regions": [
            {
                "volume_mm3": r.volume_mm3,
                "thickness_mm": r.thickness_mm,
                "deepest_mm": _list(r.deepest_mm),
                "low_mm": _list(r.low_mm),
                "high_mm": _list(r.high_mm),
                "centroid_mm": _list(r.centroid_mm),
            }
            for r in reach.uncut_regions
        ],
    }


def _list(values: FloatArray) -> list[float]:
    return [float(v) for v in values]
