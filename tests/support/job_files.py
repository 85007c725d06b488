"""A small sound job, as data and as files, to be spoilt by tests."""

from __future__ import annotations

import copy
from enum import Enum
from pathlib import Path
from typing import Any

from twin.settings.toml_text import toml_text

SOUND: dict[str, Any] = {
    "program": {"file": "slot.nc", "dialect": "fanuc"},
    "machine": {"rapid_mm_min": 48000, "offsets": {"G54": [0.0, 0.0, 0.0]}},
    "stock": {"box_mm": {"min": [0, 0, -20], "max": [60, 30, 0]}},
    "tools": [
        {"number": 1, "kind": "ball", "diameter_mm": 8.0, "teeth": 2, "helix_deg": 30.0, "flute_length_mm": 20.0},
        {
            "number": 7,
            "name": "rough",
            "kind": "bull",
            "diameter_mm": 16,
            "corner_radius_mm": 3,
            "teeth": 2,
            "flute_length_mm": 30.0,
            "length_mm": 110.0,
            "pitch_deg": [170.0, 190.0],
            "runout_mm": 0.01,
            "shank": {"diameter_mm": 16.0, "length_mm": 40},
            "holder": [{"diameter_mm": 40.0, "length_mm": 30.0}, {"diameter_mm": 63.0, "length_mm": 20.0}],
        },
    ],
    "cutting": {"Ktc": 900.0, "Kte": 2.0, "Krc": 400, "Kre": 1.8, "Kac": 0.0, "Kae": -1e-6, "source": "made up"},
    "simulation": {"slice_pitch_mm": 0.5, "step_mm": 1, "angle_step_deg": 2.5},
    "output": {"mcap": "recordings/slot.mcap"},
}

PROGRAM = "%\nT1 M6\nS3600 M3\nG54 G0 X-6 Y15\nG1 Z-2 F600\nX66\nM30\n%\n"


class Nothing(Enum):
    """For `job_data`: take the key away. An enum, so that test names made from it are equal in all workers."""

    NOTHING = "no value"


NOTHING = Nothing.NOTHING


def job_data(**changes: object) -> dict[str, Any]:
    """The sound job's tables with values at paths like ``tools__0__teeth`` changed, added, or taken away."""
    data = copy.deepcopy(SOUND)
    for path, value in changes.items():
        *above, last = (int(key) if key.isdigit() else key for key in path.split("__"))
        table: Any = data
        for key in above:
            table = table[key]
        if value is NOTHING:
            del table[last]
        else:
            table[last] = value
    return data


def job_folder(folder: Path, **changes: object) -> Path:
    """Write the program and the job file; returns the latter."""
    (folder / "slot.nc").write_text(PROGRAM)
    path = folder / "job.toml"
    path.write_text(toml_text(job_data(**changes)))
    return path
