"""Runs every program of a folder through ``rs274`` and through this interpreter and prints where they part.

Usage, with ``PYTHONPATH=tests:.``::

    python tests/support/rs274_suite.py FOLDER... [--each] [--quiet] [--only TEXT]
    python tests/support/rs274_suite.py --random COUNT [--first SEED] [--snippets NAMES] [--mutate] [--keep FOLDER]
    python tests/support/rs274_suite.py --record

A sub-folder of FOLDER is one case: its ``t.ngc``, ``test.ngc`` or only ``.ngc`` file is the program, others beside it
are its subroutines, a ``.tbl`` its tool table and a ``.var`` its parameters (inches). Without sub-folders every
``.ngc`` file of FOLDER is a program on its own, and with ``--each`` every one in and below it.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterable, Iterator
from itertools import chain
from pathlib import Path

from gcode.errors import GcodeError
from support.rs274 import RS274, Move, moves_of, rows_of, run
from support.rs274_blocks import record
from support.rs274_compare import first_difference, lasting, our_moves, settings_of, timed
from support.rs274_programs import mutated, write_tables
from support.rs274_snippets import FLAT, program

SAME, REFUSED, STILL, DIFFERS, STRICT, LAX, CRASH = (
    "same",
    "both refuse",
    "same but for motions of no length",
    "DIFFERS",
    "WE REFUSE",
    "THEY REFUSE",
    "CRASH",
)


def cases(folder: Path, each: bool) -> Iterator[tuple[str, Path]]:
    """Names of the cases of a folder, and their programs."""
    if folder.is_file():
        yield folder.name, folder
        return
    if each:
        yield from ((str(program.relative_to(folder)), program) for program in sorted(folder.rglob("*.ngc")))
        return
    inner = [sub for sub in sorted(folder.iterdir()) if sub.is_dir() and any(sub.glob("*.ngc"))]
    for sub in inner:
        programs = sorted(sub.glob("*.ngc"))
        yield sub.name, next((p for p in programs if p.name in ("t.ngc", "test.ngc")), programs[0])
    if not inner:
        yield from ((program.name, program) for program in sorted(folder.glob("*.ngc")))


def verdict(program: Path) -> tuple[str, str]:
    """How the two interpreters stand to one program: one of the words above, and what is to be said of it."""
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made) / "case"
        shutil.copytree(program.parent, folder)
        return _verdict(folder / program.name)


def _verdict(program: Path) -> tuple[str, str]:
    table, parameters = (next(iter(sorted(program.parent.glob(f"*.{end}"))), None) for end in ("tbl", "var"))
    ours: list[Move] | GcodeError
    try:  # ours first: the parameter file is written by the other
        ours = our_moves(program, settings_of(table, parameters))
    except GcodeError as error:
        ours = error
    except Exception as error:
        return CRASH, f"ours: {type(error).__name__}: {error}"
    try:
        listing = run(program, table=table, parameters=parameters)
    except (subprocess.TimeoutExpired, RuntimeError) as error:
        return CRASH, f"theirs: {error}"
    refused = "" if listing.open_end else listing.error
    if isinstance(ours, GcodeError):
        return (REFUSED, f"{refused}; ours: {ours}") if refused else (STRICT, str(ours))
    if refused:
        return LAX, refused
    theirs = moves_of(listing.calls, rows_of(table))
    difference = first_difference(timed(theirs), timed(ours))
    if difference and not first_difference(lasting(theirs), lasting(ours)):
        return STILL, difference
    return (DIFFERS, difference) if difference else (SAME, "")


def random_cases(options: argparse.Namespace, folder: Path) -> Iterator[tuple[str, Path]]:
    """Random programs, written into sub-folders of `folder`."""
    for seed in range(options.first, options.first + options.random):
        made = folder / f"{seed}{'m' if options.mutate else ''}"
        made.mkdir(parents=True, exist_ok=True)
        write_tables(made)
        text = program(seed, only=options.snippets or (FLAT if options.mutate else ""))
        (made / "t.ngc").write_text(mutated(text, seed) if options.mutate else text)
        yield made.name, made / "t.ngc"


def main() -> int:
    """Prints the table and the totals; 1 where anything but agreement was found."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="*", type=Path)
    parser.add_argument("--only", default="", help="cases with this text in their name")
    parser.add_argument("--each", action="store_true", help="every program in and below a folder on its own")
    parser.add_argument("--quiet", action="store_true", help="leave out the cases that agree")
    parser.add_argument("--random", type=int, default=0, metavar="COUNT", help="so many random programs")
    parser.add_argument("--first", type=int, default=0, metavar="SEED", help="seed of the first")
    parser.add_argument("--snippets", default="", metavar="NAMES", help="of these snippets only, separated by commas")
    parser.add_argument("--mutate", action="store_true", help="with one mistake in each")
    parser.add_argument("--keep", type=Path, help="folder to leave the random programs in")
    parser.add_argument("--record", action="store_true", help="ask rs274 the recorded blocks again")
    options = parser.parse_args()
    if RS274 is None:
        print("rs274 is not installed", file=sys.stderr)
        return 2
    if options.record:
        record()
        return 0
    with tempfile.TemporaryDirectory() as made:
        found = [case for folder in options.folders for case in cases(folder, options.each)]
        return report(chain(found, random_cases(options, options.keep or Path(made))), options)


def report(found: Iterable[tuple[str, Path]], options: argparse.Namespace) -> int:
    """Prints a line for each case and the totals."""
    counts: Counter[str] = Counter()
    for name, path in found:
        if options.only in name:
            word, said = verdict(path)
            counts[word] += 1
            if not (options.quiet and word in (SAME, REFUSED)):
                print(f"{word:12} {name}: {said}".rstrip(": "), flush=True)
    print(", ".join(f"{count} {word}" for word, count in sorted(counts.items())))
    return 0 if set(counts) <= {SAME, REFUSED} else 1


if __name__ == "__main__":
    sys.exit(main())
