"""Reference data that may not be copied: read from the directory that TWIN_REFERENCE_DIR names, skipped without it.

Layout: ``reference/gcode/NAME/*.ngc`` with ``expected_motions.json`` or ``expected_error.txt``, made by LinuxCNC on an
inch machine; ``nc/*.NC``, real programs; ``measured/``, dynamometer logs.
"""

from __future__ import annotations

import os
from pathlib import Path

REFERENCE = Path(os.environ.get("TWIN_REFERENCE_DIR", "/nonexistent"))
GCODE = REFERENCE / "reference" / "gcode"
NC = REFERENCE / "nc"
