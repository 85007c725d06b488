"""Forces in counts of a converter, with the scale as headers state it: one for all, or one for each channel."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from twin.errors import MeasuredError
from twin.measured.forces import read_forces

FORCES = np.array([(1201.5, -300.0, 80.5), (989.0, -281.5, 82.0), (1020.5, -300.5, 79.0), (1030.0, -299.0, 83.0)])


@pytest.mark.parametrize(("header", "counts", "delimiter"), [
    ("Counts per Unit Force,100", (100, 100, 100), ","),
    ("Counts per Unit Force,100,200,50", (100, 200, 50), ","),
    ("Counts per Unit Force;1.000.000", (1e6, 1e6, 1e6), ";"),
    ("Counts per Force: 1,000", (1000, 1000, 1000), ","),
    ("Counts per N Fx,100\nCounts per N Fy,200\nCounts per N Fz,50", (100, 200, 50), ","),
    ("Fx: 0.01 N/count\nFy: 0.005 N/count\nFz: 0.02 N/count", (100, 200, 50), ";"),
    ("Scale [N/LSB],0.01,0.005,0.02", (100, 200, 50), ","),
    ("Calibration: 1 count = 0.01 N", (100, 100, 100), "\t"),
    ("Counts per Force Unit: 100\nForce Unit: N", (100, 100, 100), ","),
    ("Counts per Unit,100", (100, 100, 100), ","),
    ("cpf = 100\ncpt = 2000", (100, 100, 100), ","),
    ("Digits pro N: 100", (100, 100, 100), ";"),
])  # fmt: skip
@pytest.mark.parametrize("unit", ["", " [counts]"])
def test_scales_of_the_header(
    header: str, counts: tuple[float, ...], delimiter: str, unit: str, tmp_path: Path
) -> None:
    rows = [delimiter.join(map(str, (k, *np.rint(f * counts).astype(int)))) for k, f in enumerate(FORCES)]
    names = delimiter.join(["Time [ms]", *(f"F{a}{unit}" for a in "xyz")])
    (tmp_path / "log.csv").write_text("\n".join([header, names, *rows]))
    log = read_forces(tmp_path / "log.csv")
    np.testing.assert_allclose(log.force_n, FORCES)
    assert sum("as in the header" in note for note in log.notes) == 3


@pytest.mark.parametrize("unit", ["counts", "ADC"])
def test_counts_without_a_scale_are_refused(unit: str, tmp_path: Path) -> None:
    rows = "".join(f"{k},{1201 + k},-300,80\n" for k in range(4))
    (tmp_path / "log.csv").write_text(f"Time [ms],Fx [{unit}],Fy [{unit}],Fz [{unit}]\n{rows}")
    with pytest.raises(MeasuredError, match=f"is in '{unit}', expected a unit of force"):
        read_forces(tmp_path / "log.csv")


def test_counts_per_kilopound(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text("Counts per klbf: 1000\nTime [ms],Fx,Fy,Fz\n0,1000,-300,80\n1,1000,-300,80\n")
    np.testing.assert_allclose(read_forces(tmp_path / "log.csv").force_n[0, 0], 4448.2216152605)


@pytest.mark.parametrize(("fx", "noted"), [("1201", True), ("1201.5", False)])
def test_a_scale_in_other_words_is_quoted(fx: str, noted: bool, tmp_path: Path) -> None:
    rows = "".join(f"{k},{fx},-300,80\n" for k in range(4))
    (tmp_path / "log.csv").write_text(f"Scale factor: 0.001\nTime [ms],Fx,Fy,Fz\n{rows}")
    notes = read_forces(tmp_path / "log.csv").notes
    assert ("forces are whole numbers, and not scaled by 'Scale factor: 0.001'" in notes) == noted
