"""Report of ``twin verify``: human-readable tables, or one JSON object."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rich import box
from rich.console import Console
from rich.table import Table

from twin.cli.console import results, warn
from twin.number_format import plural, volume
from twin.verification.deviation import SHARES, Deviation
from twin.verification.regions import DeviationRegion
from twin.verification.verification import Verification

#: Largest number of regions in the table, and in the JSON object.
_ROWS, _MOST = 10, 1000


def print_deviation(verification: Verification, console: Console | None = None) -> None:
    """Print tables of deviations and regions out of tolerance, then the verdict."""
    console, found = console or results(), verification.deviation
    console.print(_quantiles(found))
    if found.regions:
        console.print(_regions(found))
    rest = len(found.regions) - _ROWS
    if rest > 0:
        console.print(f"and {plural(rest, 'region')} more", markup=False)
    console.print(
        f"gouged {volume(found.gouged_mm3)}, excess {volume(found.left_mm3)}; "
        f"accurate to {_um(found.resolution_mm)} µm on rays {found.pitch_mm:.3g} mm apart",
        markup=False,
        soft_wrap=True,
    )
    for kind, ok, worst, most in (
        ("gouge", found.gouge_ok, found.worst_gouge_mm, found.tolerance_mm),
        ("excess", found.excess_ok, found.worst_excess_mm, found.excess_mm),
    ):
        verdict = "within" if ok else "out of"
        console.print(f"{kind:<7} {_um(worst)} µm, {verdict} tolerance ({_um(most)} µm)", markup=False)
    for collision in verification.collisions[:_ROWS]:
        warn(f"collision: {collision.message}")


def _quantiles(found: Deviation) -> Table:
    table = Table(title="Deviation of the machined surface, µm", title_justify="left", box=box.SIMPLE_HEAD)
    table.add_column("share of area below", no_wrap=True)
    for share in SHARES:
        table.add_column(f"{100.0 * share:g} %", justify="right")
    table.add_column("within", justify="right")
    values = [_um(float(q)) for q in found.quantiles_mm()]
    table.add_row("", *values, f"{100.0 * found.within:.2f} %")
    return table


def _regions(found: Deviation) -> Table:
    table = Table(title="Out of tolerance", title_justify="left", box=box.SIMPLE_HEAD)
    for name in ("", "worst, µm", "at x", "y", "z", "size x", "y", "z", "area, mm²", "volume, mm³"):
        table.add_column(name, justify="right" if name else "left", no_wrap=True)
    for region in found.regions[:_ROWS]:
        at = [f"{c:.2f}" for c in region.point_mm]
        size = [f"{c:.2f}" for c in region.high_mm - region.low_mm]
        extent = (f"{region.area_mm2:.3g}", f"{region.volume_mm3:.3g}")
        table.add_row(region.kind, _um(region.worst_mm), *at, *size, *extent)
    return table


def _um(length_mm: float) -> str:
    return f"{1000.0 * length_mm:.1f}"


def _number(value: float) -> float | None:
    """A number that JSON has; None where nothing of the part is left at all."""
    return value if math.isfinite(value) else None


def deviation_json(verification: Verification, files: Mapping[str, Path | None]) -> str:
    """The object of ``--json``.

    Args:
        verification: the result.
        files: inputs and outputs by kind, None for those that are not requested.
    """
    found = verification.deviation
    values = {
        "within_tolerance": verification.within_tolerance,
        "tolerance_mm": found.tolerance_mm,
        "excess_allowed_mm": found.excess_mm,
        "worst_gouge_mm": _number(found.worst_gouge_mm),
        "worst_excess_mm": found.worst_excess_mm,
        "share_within": found.within,
        "percentiles_mm": {f"{100.0 * s:g}": float(q) for s, q in zip(SHARES, found.quantiles_mm(), strict=True)},
        "gouged_mm3": found.gouged_mm3,
        "left_mm3": found.left_mm3,
        "lost_mm": _number(found.lost_mm),
        "machined_area_mm2": float(found.area_mm2.sum()),
        "resolution_mm": found.resolution_mm,
        "ray_pitch_mm": found.pitch_mm,
        "places": [_region_values(region) for region in found.regions[:_MOST]],
        "place_count": len(found.regions),
        "collisions": [c.message for c in verification.collisions],
        "warnings": list(verification.warnings),
        **{kind: None if path is None else str(path) for kind, path in files.items()},
    }
    return json.dumps(values, indent=2, ensure_ascii=False)


def _region_values(region: DeviationRegion) -> dict[str, Any]:
    return {
        "kind": region.kind,
        "worst_mm": region.worst_mm,
        "point_mm": region.point_mm.tolist(),
        "low_mm": region.low_mm.tolist(),
        "high_mm": region.high_mm.tolist(),
        "area_mm2": region.area_mm2,
        "volume_mm3": region.volume_mm3,
    }
