"""The process that reads mutated files: with a bound on its memory, and a clock that ends it when one takes too long.

    python tests/support/fuzz/worker.py "log, TDMS" STL --seconds 300 --seed 1 --folder /tmp/fuzz

Prints one JSON object for each kind of input. The file that is being read is in the folder, so that it is there after a
crash.
"""

from __future__ import annotations

import argparse
import faulthandler
import json
import resource
import sys
import time
import traceback
import warnings
from collections import Counter
from dataclasses import asdict, dataclass, field
from pathlib import Path

ROOT = Path(__file__).parents[3]
if __name__ == "__main__":
    sys.path[:0] = [str(ROOT), str(ROOT / "tests")]

from gcode.errors import GcodeError  # noqa: E402
from support.fuzz.targets import TARGETS, Target  # noqa: E402
from twin.errors import TwinError  # noqa: E402

#: One input may take so long, s; then the process is ended, by a thread that no library can block.
LONGEST_S = 30.0
#: Memory above that of the process with all libraries loaded, bytes.
MOST_BYTES = 2 << 30


@dataclass(slots=True)
class Figures:
    """Results for one kind of input.

    Attributes:
        failures: number of the input, and the last line of what came out, for each that was neither read nor refused.
        peak_mib: highest memory of the process so far.
    """

    target: str
    inputs: int = 0
    read: int = 0
    refused: int = 0
    messages: int = 0
    slowest_s: float = 0.0
    peak_mib: int = 0
    failures: list[tuple[int, str]] = field(default_factory=list)


def bound_memory(most_bytes: int = MOST_BYTES) -> None:
    """Limit the address space of this process to what it has now and this much more."""
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    limit = pages * resource.getpagesize() + most_bytes
    resource.setrlimit(resource.RLIMIT_AS, (limit, resource.RLIM_INFINITY))


def try_one(target: Target, path: Path) -> str:
    """Read a file.

    Returns:
        An empty text if it was read, the message if it was refused.

    Raises:
        Exception: anything else is a failure.
    """
    try:
        target.use(path)
    except (TwinError, GcodeError) as error:
        assert str(error).strip(), "an empty message"
        return str(error)
    return ""


def fuzz(name: str, folder: Path, seed: int, *, seconds: float = 0.0, count: int = 0) -> Figures:
    """Mutate files of one kind, for a time or a number of times."""
    target, figures, messages = TARGETS[name], Figures(name), Counter[str]()
    path = folder / f"current{target.suffix}"
    for neighbour, content in target.neighbours().items():
        (folder / neighbour).write_bytes(content)
    end = time.monotonic() + seconds
    while figures.inputs < count or time.monotonic() < end:
        path.write_bytes(target.input(name, seed, figures.inputs))
        begin = time.monotonic()
        faulthandler.dump_traceback_later(LONGEST_S, exit=True)
        try:
            message = try_one(target, path)
        except (Exception, RecursionError, MemoryError) as error:
            place = traceback.extract_tb(error.__traceback__)[-1]
            text = f"{type(error).__name__}: {str(error)[:200]} ({Path(place.filename).name}:{place.lineno})"
            figures.failures.append((figures.inputs, text))
        else:
            figures.read, figures.refused = figures.read + (not message), figures.refused + bool(message)
            messages["".join(c for c in message if c.isalpha())[:200]] += 1
        faulthandler.cancel_dump_traceback_later()
        figures.slowest_s = max(figures.slowest_s, time.monotonic() - begin)
        figures.inputs += 1
    figures.messages = len(messages)
    figures.peak_mib = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss >> 10
    return figures


def main() -> None:
    """The command line."""
    parser = argparse.ArgumentParser(description="Random mutations of input files.")
    parser.add_argument("targets", nargs="*", metavar="KIND", help=f"one of {', '.join(TARGETS)}; all if none is given")
    parser.add_argument("--seconds", type=float, default=0.0, help="how long for each kind")
    parser.add_argument("--count", type=int, default=0, help="how many inputs of each kind, in place of a time")
    parser.add_argument("--seed", type=int, default=1, help="of the random choices")
    parser.add_argument("--folder", type=Path, required=True, help="for the file that is read")
    arguments = parser.parse_args()
    faulthandler.enable()
    names = arguments.targets or list(TARGETS)
    for name in names:
        fuzz(name, arguments.folder, 0, count=1)
    bound_memory()
    warnings.simplefilter("error")
    warnings.simplefilter("ignore", DeprecationWarning)
    for name in names:
        figures = fuzz(name, arguments.folder, arguments.seed, seconds=arguments.seconds, count=arguments.count)
        print(json.dumps(asdict(figures)), flush=True)


if __name__ == "__main__":
    main()
