"""What is left of the stock: volumes by the three families of slices, a slice's rings, the surface as an STL file."""

from __future__ import annotations

import tempfile
from pathlib import Path

from twin.job import load_job
from twin.simulation.replay import Replay
from twin.workpiece.from_mesh import stl_bytes
from twin.workpiece.to_mesh import surface_mesh

JOB = Path(__file__).parent / "pocket" / "job.toml"


def main() -> None:
    job = load_job(JOB)
    coarse = job.simulation.model_copy(update={"slice_pitch_mm": 0.4, "step_mm": 2.0, "angle_step_deg": 15.0})
    with Replay(job.model_copy(update={"simulation": coarse})) as run:
        for _ in run:
            pass
        part = run.workpiece
        for axis, name in enumerate("xyz"):
            print(f"volume by the slices across {name}: {part.volume_mm3(axis):.1f} mm3")
        middle = part.region(2, part.count(2) - 3)
        print(
            f"rings of a slice in the pocket: {[len(ring) for ring in middle.rings]} points, {middle.area_mm2:.1f} mm2"
        )
        mesh = surface_mesh(part)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "pocket.stl"
        path.write_bytes(stl_bytes(mesh.vertices_mm, mesh.triangles))
        print(f"{path.name}: {len(mesh.triangles)} triangles, {path.stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
