"""Published dynamometer data: full slots of a 25 mm flat end mill at five feeds, and their author's regression.

The files may not be copied; the averages and the coefficients are published numbers. The author takes the dynamometer's
y for the process's x and its x for y; with z turned round that is the force on the tool in this program's axes.
"""

from __future__ import annotations

from typing import Any

import pytest
from support.reference import REFERENCE

from twin.identification.cuts.load import cuts_from_dict
from twin.identification.identify import identify

FEEDS = (300, 600, 900, 1200, 1500)
#: Mean Fx, Fy, Fz of the dynamometer, N.
MEANS = ((63.0, -39.8, 55.7), (107.1, -60.1, 70.9), (137.7, -71.6, 82.6), (171.3, -76.8, 85.2), (210.7, -78.5, 83.5))
PUBLISHED = (958.86, 15.758, 250.86, 19.43, 146.36, 18.21)
MEASURED = REFERENCE / "measured" / "flat_slot_dynoware"
SLOTS: dict[str, Any] = {
    "tool": {"kind": "flat", "diameter_mm": 25.0, "teeth": 2, "helix_deg": 45.0},
    "defaults": {"direction": "slot", "axial_depth_mm": 3.0, "spindle_rpm": 6000, "map": "x=Fy,y=Fx,z=-Fz"},
}


@pytest.mark.parametrize("method", ["mean", "iterative"])
def test_published_means_give_the_published_coefficients(method: Any) -> None:
    cuts = [{"feed_mm_min": f, "mean_force_n": list(m)} for f, m in zip(FEEDS, MEANS, strict=True)]
    found = identify(cuts_from_dict(SLOTS | {"cuts": cuts}, "cuts.toml"), method)
    assert found.estimate.values == pytest.approx(PUBLISHED, rel=0.001)


@pytest.mark.skipif(not MEASURED.is_dir(), reason="TWIN_REFERENCE_DIR does not name the reference data")
@pytest.mark.parametrize("weights", ["errors", "equal"])
def test_the_files_give_the_published_means_and_coefficients(weights: str) -> None:
    cuts = [{"feed_mm_min": f, "log": str(MEASURED / f"6-n6000f{f}ap3ae25.csv")} for f in FEEDS]
    found = identify(cuts_from_dict(SLOTS | {"cuts": cuts, "fit": {"weights": weights}}, "cuts.toml"))
    for cut, (fx, fy, fz) in zip(found.cuts, MEANS, strict=True):
        assert cut.measured.mean_n == pytest.approx([fy, fx, -fz], abs=0.15)
        assert cut.measured.rpm == pytest.approx(6000.0, abs=3.0)
    assert found.estimate.values == pytest.approx(PUBLISHED, rel=0.005)
    assert any("runout" in w for w in found.warnings)
    assert any("no air in the log" in w for w in found.warnings)
