"""Settings for the whole suite."""

import os

from hypothesis import settings

# kernels compile during the first examples; machines differ in speed
settings.register_profile("steady", deadline=None)
settings.load_profile("steady")

# what the command line prints must not depend on the terminal or the service that runs the tests
for name in ("FORCE_COLOR", "GITHUB_ACTIONS", "NO_COLOR", "PY_COLORS", "TTY_COMPATIBLE", "TTY_INTERACTIVE"):
    os.environ.pop(name, None)
os.environ["TERM"] = "xterm"
