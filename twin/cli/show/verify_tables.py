"""What `twin verify` says: tables for people, an object for programs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from rich import box
from rich.console import Console
from rich.table import Table

from twin.cli.console import results, warn
from twin.cli.show.words import plural, volume
from twin.record import Collision
from twin.verification.deviation import SHARES, Deviation

#: Places that the table has rows for, and those that the JSON object has.
_ROWS, _MOST = 10, 1000


def print_deviation(found: Deviation, collisions: Sequence[Collision], console: Console | None = None) -> None:
    """Tables of deviations and places, then the verdict."""
    console = console or results()
    console.print(_quantiles(found))
    if found.places:
        console.print(_places(found))
    rest = len(found.places) - _ROWS
    if rest > 0:
        console.print(f"and {plural(rest, 'place')} more", markup=False)
    console.print(
        f"gouged {volume(found.gouged_mm3)}, left over the design {volume(found.left_mm3)}; "
        f"known to {_um(found.resolution_mm)} µm on rays {found.pitch_mm:.3g} mm apart",
        markup=False,
        soft_wrap=True,
    )
    for what, ok, worst, most in (
        ("gouge", found.gouge_ok, found.worst_gouge_mm, found.tolerance_mm),
        ("excess", found.excess_ok, found.worst_excess_mm, found.excess_mm),
    ):
        verdict = "within" if ok else "out of"
        console.print(f"{what:<7} {_um(worst)} µm, {verdict} tolerance ({_um(most)} µm)", markup=False)
    for collision in collisions[:_ROWS]:
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


def _places(found: Deviation) -> Table:
    table = Table(title="Out of tolerance", title_justify="left", box=box.SIMPLE_HEAD)
    for name in ("", "worst, µm", "at x", "y", "z", "size x", "y", "z", "area, mm²", "volume, mm³"):
        table.add_column(name, justify="right" if name else "left", no_wrap=True)
    for place in found.places[:_ROWS]:
        at = [f"{c:.2f}" for c in place.point_mm]
        size = [f"{c:.2f}" for c in place.high_mm - place.low_mm]
        table.add_row(place.kind, _um(place.worst_mm), *at, *size, f"{place.area_mm2:.3g}", f"{place.volume_mm3:.3g}")
    return table


def _um(length_mm: float) -> str:
    return f"{1000.0 * length_mm:.1f}"


def _number(value: float) -> float | None:
    """A number that JSON has; None where nothing at all is left of the part."""
    return value if math.isfinite(value) else None


def deviation_object(found: Deviation, collisions: Sequence[Collision]) -> dict[str, Any]:
    """The object of ``--json``."""
    return {
        "within_tolerance": found.gouge_ok and found.excess_ok,
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
        "places": [
            {
                "kind": p.kind,
                "worst_mm": p.worst_mm,
                "point_mm": p.point_mm.tolist(),
                "low_mm": p.low_mm.tolist(),
                "high_mm": p.high_mm.tolist(),
                "area_mm2": p.area_mm2,
                "volume_mm3": p.volume_mm3,
            }
            for p in found.places[:_MOST]
        ],
        "place_count": len(found.places),
        "collisions": [c.message for c in collisions],
    }
