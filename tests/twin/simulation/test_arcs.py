"""Arcs: chords solved together, and without forces cut together."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from twin.job import Job, job_from_dict
from twin.record import Collision, RunSummary, Step
from twin.simulation.material import Material
from twin.simulation.replay import Replay

pytestmark = pytest.mark.compiled

TURN = "G3 X8 Y5 I-2 J0 Z{z:.2f}\n"
HELIX = "G0 X8 Y5\nG43 H1 Z1\nG1 Z0 F300\n" + "".join(TURN.format(z=z) for z in (-0.2, -0.4, -0.6, -0.6))
CUTTING = {"Ktc": 900.0, "Kte": 2.0, "Krc": 400.0, "Kre": 2.0, "Kac": 0.0, "Kae": 0.0, "source": "made up"}


def job(tmp_path: Path, body: str, kind: str = "flat", *, forces: bool = False, **tool: Any) -> Job:
    program = tmp_path / "arcs.nc"
    program.write_text(f"G21 G90 G94\nT1 M6\nS3000 M3\n{body}G0 Z9\nM30\n")
    shape = {"kind": kind, "diameter_mm": 4.0, "teeth": 2, "flute_length_mm": 8.0, "length_mm": 40.0, **tool}
    data: dict[str, Any] = {
        "program": {"file": str(program)},
        "stock": {"box_mm": {"min": [0, 0, -2], "max": [12, 10, 0]}},
        "tools": [{"number": 1, **shape}],
        "simulation": {"slice_pitch_mm": 0.25, "step_mm": 0.2, "angle_step_deg": 6.0, "axial_step_mm": 0.25},
    }
    return job_from_dict(data | ({"cutting": CUTTING} if forces else {}), tmp_path)


def run(job: Job, threads: int = 1, *, preview: bool = False) -> tuple[list[Step], RunSummary]:
    with Replay(job, threads=threads, preview=preview) as replay:
        steps = [record for record in replay if isinstance(record, Step)]
        return steps, replay.summary(complete=True)


@pytest.mark.parametrize("kind", ["flat", "ball"])
def test_chords_solved_together_have_the_forces_of_each_alone(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    helix = job(tmp_path, HELIX, kind, forces=True)
    _, together = run(helix)
    monkeypatch.setattr(Material, "until_subtracted", lambda *_: 1)
    _, alone = run(helix)
    assert together.digest == alone.digest
    assert together.peak_force_n[3] > 1.0


@pytest.mark.parametrize("kind", ["flat", "ball", "bull"])
def test_without_forces_chords_leave_the_same_material_and_have_similar_engagements(kind: str, tmp_path: Path) -> None:
    corner = {"corner_radius_mm": 0.5} if kind == "bull" else {}
    with_forces, alone = (run(job(tmp_path, HELIX, kind, forces=forces, **corner)) for forces in (True, False))
    assert alone[1].removed_volume_mm3 == pytest.approx(with_forces[1].removed_volume_mm3, rel=1e-3)
    assert [s.end_mm for s in alone[0]] == [s.end_mm for s in with_forces[0]]
    rates = [np.array([s.engagement.removal_rate_mm3_s for s in steps]) for steps, _ in (alone, with_forces)]
    assert rates[0].sum() == pytest.approx(rates[1].sum(), rel=0.05)
    assert np.mean(np.abs(rates[0] - rates[1])) < 0.1 * rates[1].mean()


def test_threads_and_previews_change_nothing(tmp_path: Path) -> None:
    helix = job(tmp_path, HELIX, "ball")
    steps, summary = run(helix)
    for threads, preview in ((2, False), (1, True)):
        others, other = run(helix, threads, preview=preview)
        assert other.removed_volume_mm3 == summary.removed_volume_mm3
        assert other.digest == summary.digest
        assert [s.engagement for s in others] == [s.engagement for s in steps]


def test_turns_over_the_same_path_find_no_material(tmp_path: Path) -> None:
    level = "G0 X8 Y5\nG43 H1 Z1\nG1 Z-1 F300\n" + TURN.format(z=-1.0)
    _, once = run(job(tmp_path, level))
    _, thrice = run(job(tmp_path, level + 2 * TURN.format(z=-1.0)))
    assert thrice.removed_volume_mm3 == pytest.approx(once.removed_volume_mm3, rel=1e-9)


def test_the_mesh_in_the_middle_of_a_helix_has_no_material_inside_the_tool(tmp_path: Path) -> None:
    with Replay(job(tmp_path, HELIX), threads=1, preview=False) as replay:
        for record in replay:
            if isinstance(record, Step) and record.end_mm[2] < -0.45:
                break
        mesh = replay.mesh()
    centre = np.array([6.0, 5.0])
    inside = np.linalg.norm(mesh.vertices_mm[:, :2] - centre, axis=1) < 1.5
    assert mesh.vertices_mm[inside, 2].max() < -0.2


def test_a_shank_that_meets_the_hole_is_reported_as_with_forces(tmp_path: Path) -> None:
    shank = {"shank": {"diameter_mm": 6.0, "length_mm": 30.0}, "flute_length_mm": 0.5}
    found = []
    for forces in (True, False):
        with Replay(job(tmp_path, HELIX, forces=forces, **shank), threads=1, preview=False) as replay:
            found.append([r for r in replay if isinstance(r, Collision)])
    with_forces, alone = found
    assert [(c.kind, c.nc_line) for c in alone] == [(c.kind, c.nc_line) for c in with_forces]
    assert with_forces
