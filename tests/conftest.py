"""Settings for the whole suite."""

import atexit
import os
import shutil
import signal
import sys
import tempfile
from pathlib import Path

import pytest
from hypothesis import settings

#: More processes than this spend their time compiling the same kernels.
MOST_PROCESSES = 8

# before numpy is imported: matrices are small here, and threads of linear algebra would wait for each other busily
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# where Python may not keep byte code next to the sources, the many processes of one run still share it
if sys.dont_write_bytecode:
    sys.dont_write_bytecode, sys.pycache_prefix = False, tempfile.mkdtemp(prefix="byte-code-")
    os.environ["PYTHONPYCACHEPREFIX"] = sys.pycache_prefix
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    atexit.register(shutil.rmtree, sys.pycache_prefix, ignore_errors=True)

# kernels compile during the first examples; machines differ in speed
settings.register_profile("steady", deadline=None)
settings.load_profile("steady")

# what the command line prints must not depend on the terminal or the service that runs the tests
for name in ("FORCE_COLOR", "GITHUB_ACTIONS", "NO_COLOR", "PY_COLORS", "TTY_COMPATIBLE", "TTY_INTERACTIVE"):
    os.environ.pop(name, None)
os.environ["TERM"] = "xterm"
# a shell ignores Ctrl-C for what it starts in the background, and the tests of Ctrl-C may run there
signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_collection_finish() -> None:
    """What the command line prints does not depend on how long the machine takes, either."""
    from twin.cli.show import heartbeat  # not before the number of threads is set

    heartbeat.EVERY_S = 3600.0


def pytest_addoption(parser: pytest.Parser) -> None:
    """Options of the mutated inputs of ``tests/test_fuzz.py``."""
    group = parser.getgroup("mutated inputs")
    group.addoption("--fuzz-seconds", type=float, default=0.0, help="mutate input files for this time in all")
    group.addoption("--fuzz-seed", type=int, default=1, help="seed of the mutations")


@pytest.hookimpl(tryfirst=True)
def pytest_xdist_auto_num_workers(config: pytest.Config) -> int | None:
    """One process for each processor, but none for a few test files: starting processes takes longer than those."""
    if os.environ.get("PYTEST_XDIST_AUTO_NUM_WORKERS"):
        return None
    if all(Path(argument.split("::")[0]).is_file() for argument in config.args):
        return 0
    usable = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return min(usable, MOST_PROCESSES)
