"""The machined part: removed volume by tool, and the surface as an STL file. The job's settings are made coarser."""

from __future__ import annotations

import tempfile
from pathlib import Path

import twin

JOB = Path(__file__).parent / "pocket" / "job.toml"


def main() -> None:
    job = twin.load_job(JOB).without_forces().with_simulation(slice_pitch_mm=0.4, step_mm=2.0)
    run = twin.replay(job)
    for tool in run.summary.tools:
        print(f"T{tool.number} {tool.description}: {tool.removed_volume_mm3:.1f} mm3 removed")
    mesh = run.mesh()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "pocket.stl"
        twin.write_mesh(path, mesh)
        print(f"{path.name}: {len(mesh.triangles)} triangles, {path.stat().st_size / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
