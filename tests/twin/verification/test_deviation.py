from __future__ import annotations

import math
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely
import trimesh
from matplotlib.figure import Figure
from support.small_parts import box, prism, prism_corners

from twin.verification.deviation import Deviation, Limits, deviation
from twin.verification.plot import plot_deviation
from twin.verification.rays import beyond, cast
from twin.workpiece.solids.from_mesh import Solid, mesh_slices, solid
from twin.workpiece.trislice import CellSlices

NOTHING = np.empty(0)
#: Rounding of vertices to 1e-5 mm.
ROUNDING = 2e-5


def step(height: float) -> Solid:
    """A floor at 0 and a step of a height, 10 x 6 mm."""
    return prism([(0, -2), (10, -2), (10, 0), (5, 0), (5, height), (0, height)], 0.0, 6.0)


def slope(lift: float, deg: float = 30.0) -> Solid:
    """A slope over x from 0 to 10, lifted along its normal."""
    up, rise = lift / math.cos(math.radians(deg)), 10.0 * math.tan(math.radians(deg))
    return prism([(0, -3), (10, -3), (10, rise + up), (0, up)], 0.0, 6.0)


def compare(machined: Solid, design: Solid, pitch: float = 0.2, **options: object) -> Deviation:
    store = CellSlices(mesh_slices(machined, pitch))
    return deviation(store, design, **({"tolerance_mm": 0.02} | options))  # type: ignore[arg-type]


def test_a_part_against_itself_is_right_everywhere() -> None:
    found = compare(step(3.0), step(3.0))
    assert found.worst_gouge_mm <= ROUNDING and found.worst_excess_mm <= ROUNDING
    assert found.within == 1.0 and found.regions == () and found.gouge_ok and found.excess_ok
    assert found.gouged_mm3 == pytest.approx(0.0, abs=1e-4) and found.left_mm3 == pytest.approx(0.0, abs=1e-4)


@pytest.mark.parametrize("lift", [0.03, -0.03, 0.5])
def test_distances_are_normal_to_the_design(lift: float) -> None:
    limits = Limits.of(slope(0.0), (0.5, 0.0, 9.5, 6.0))
    found = compare(slope(lift), slope(0.0), pitch=0.25, limits=limits)
    on_slope = np.abs(found.deviation_mm - lift) < 1e-4
    area = 9.0 * 6.0 / math.cos(math.radians(30.0))
    assert found.area_mm2[on_slope].sum() == pytest.approx(area, rel=0.03)
    worst = found.worst_excess_mm if lift > 0.0 else found.worst_gouge_mm
    assert worst == pytest.approx(abs(lift), abs=1e-4)
    volume = found.left_mm3 if lift > 0.0 else found.gouged_mm3
    assert volume == pytest.approx(abs(lift) * area, rel=0.03)
    assert found.regions[0].kind == ("excess" if lift > 0.0 else "gouge")


def test_the_step_that_is_too_high_or_too_low() -> None:
    low, high = compare(step(2.9), step(3.0)), compare(step(3.04), step(3.0))
    assert low.worst_gouge_mm == pytest.approx(0.1, abs=ROUNDING) and not low.gouge_ok and low.excess_ok
    assert high.worst_excess_mm == pytest.approx(0.04, abs=ROUNDING) and not high.excess_ok and high.gouge_ok
    (region,) = high.regions
    assert region.volume_mm3 == pytest.approx(5.0 * 6.0 * 0.04, rel=0.02)
    assert region.low_mm[2] == pytest.approx(3.04, abs=ROUNDING) and region.high_mm[0] <= 5.0
    assert compare(step(3.04), step(3.0), excess_mm=0.05).excess_ok


def test_a_missing_rib_is_a_gouge_as_high_as_the_rib() -> None:
    rib = prism([(0, -2), (10, -2), (10, 0), (5.1, 0), (5.1, 3), (4.9, 3), (4.9, 0), (0, 0)], 0.0, 6.0)
    found = compare(box((0, 0, -2), (10, 6, 0)), rib)
    # the surface that is there lies within half the rib's width of the design
    assert -found.deviation_mm.min(initial=0.0) <= 0.1 + ROUNDING
    assert found.lost_mm == pytest.approx(3.0, abs=0.1) and found.worst_gouge_mm == found.lost_mm
    assert not found.gouge_ok


def test_only_the_region_is_judged() -> None:
    high = step(3.5)
    assert not compare(high, step(3.0)).excess_ok
    limits = Limits.of(step(3.0), (5.5, 0.0, 10.0, 6.0))
    found = compare(high, step(3.0), limits=limits)
    assert found.excess_ok and found.left_mm3 == pytest.approx(0.0, abs=1e-4)


def test_flush_faces_of_the_stock_are_not_machined_area() -> None:
    found = compare(step(3.0), step(3.0))
    assert found.area_mm2.sum() == pytest.approx(5.0 * 6.0 + 3.0 * 6.0, rel=0.03)


def test_two_regions_are_kept_apart_and_sorted() -> None:
    plate = prism_corners([(0, -1), (20, -1), (20, 0), (0, 0)], 0.0, 6.0)
    bumps = [
        prism_corners([(x, -0.5), (x + 2, -0.5), (x + 2, h), (x, h)], 2.0, 4.0) for x, h in ((3.0, 0.1), (14.0, 0.3))
    ]
    found = compare(solid(np.concatenate((plate, *bumps)), "bumps"), solid(plate, "plate"))
    tops = [p for p in found.regions if p.worst_mm > 0.05]
    assert [round(p.worst_mm, 4) for p in tops] == [0.3, 0.1]
    assert tops[0].low_mm[0] >= 14.0 - 1e-6 and tops[1].high_mm[0] <= 5.0 + 1e-6


def test_rays_measure_missing_and_excess_material() -> None:
    store = CellSlices(mesh_slices(step(2.5), 0.5))
    _, _, up = cast(store, step(3.0))
    points, _, out = up.points(up.design)
    over = beyond(up)
    top = (out > 0.0) & (points[:, 2] == 3.0)
    assert top.any() and over[top] == pytest.approx(-0.5)
    assert over[~top] == pytest.approx(0.0)


@pytest.mark.parametrize("values", [{"tolerance_mm": 0.0}, {"excess_mm": -1.0}])
def test_tolerances_that_cannot_be(values: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="must be above 0"):
        compare(step(3.0), step(3.0), **values)


def extruded(*rings: np.ndarray, high: float = 5.0) -> Solid:
    """Rings in the plan, the outer first, as a solid of a height."""
    polygon = shapely.Polygon(rings[0], rings[1:])
    return solid(np.array(trimesh.creation.extrude_polygon(polygon, high).triangles), "extruded")


def circle(radius: float) -> np.ndarray:
    angle = np.linspace(0.0, math.tau, 48, endpoint=False)
    return radius * np.column_stack((np.cos(angle), np.sin(angle)))


@pytest.mark.parametrize(("pitch", "rel"), [(0.4, 0.015), (0.25, 0.01)])
def test_volumes_left_and_gouged_are_those_between_the_bodies(pitch: float, rel: float) -> None:
    """A ring left in its box: stock less removed less part, whatever the distances; and the reverse."""
    ring, stock = extruded(circle(8.0), circle(5.0)), box((-8, -8, 0), (8, 8, 5))
    between = stock.volume_mm3 - ring.volume_mm3
    found = compare(stock, ring, pitch=pitch)
    assert found.left_mm3 == pytest.approx(between, rel=rel) and found.gouged_mm3 == pytest.approx(0.0, abs=1e-6)
    turned = compare(ring, stock, pitch=pitch)
    assert turned.gouged_mm3 == pytest.approx(between, rel=rel) and turned.left_mm3 == pytest.approx(0.0, abs=1e-6)


def test_regions_have_the_area_of_the_machined_surface() -> None:
    """Faces over a bore that was not cut, whose nearest design is beside them: no region without an area."""
    found = compare(box((-8, -8, 0), (8, 8, 5)), extruded(circle(8.0), circle(5.0)), pitch=0.25)
    bore = [r for r in found.regions if np.all(r.high_mm[:2] < 5.1) and np.all(r.low_mm[:2] > -5.1)]
    assert len(bore) == 2
    assert [r.area_mm2 for r in bore] == pytest.approx([math.pi * 25.0] * 2, rel=0.02)
    narrow = extruded(*(np.array([(-4, -4), (4, -4), (4, 4), (-4, 4)]) * s for s in (1.0, 0.02)))
    regions = compare(box((-4, -4, 0), (4, 4, 5)), narrow, pitch=0.1).regions
    assert len(regions) == 2 and [r.area_mm2 for r in regions] == pytest.approx([0.0256] * 2, rel=0.6)


def test_a_picture_without_any_machined_area(tmp_path: Path) -> None:
    """The stock is the part: nothing was machined, and warnings of the library are errors here."""
    empty = replace(compare(step(3.0), step(3.0)), points_mm=np.empty((0, 3)), deviation_mm=NOTHING, area_mm2=NOTHING)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        plot_deviation(empty, tmp_path / "map.png")
    assert (tmp_path / "map.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(("height", "names"), [(2.5, {"gouge"}), (3.04, {"excess"}), (3.0, set())])
def test_the_picture_names_its_lines_and_marks_and_its_scale_holds_the_worst(
    height: float, names: set[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    drawn: list[Figure] = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, *_, **__: drawn.append(figure))
    found = compare(step(height), step(3.0))
    plot_deviation(found, tmp_path / "a.png", "a step")
    plan, spread, bar = drawn[0].axes
    low, high = bar.get_ylim()
    assert low <= -1e3 * found.worst_gouge_mm and high >= 1e3 * found.worst_excess_mm
    assert spread.get_xlim()[0] <= -1e3 * found.worst_gouge_mm
    legend = plan.get_legend()
    marks = {t.get_text() for t in legend.get_texts()} if legend is not None else set()
    assert marks == {f"{name} out of tolerance" for name in names}
    limits = spread.get_legend()
    assert limits is not None
    assert [t.get_text() for t in limits.get_texts()] == ["gouge allowed: 20 µm", "excess allowed: 20 µm"]
