"""Damaged logs of every format: each is read, or refused with one error, in bounded time and memory.

Run ``python tests/support/fuzz_logs.py --seconds 60 --seed 1`` for longer than the tests do.
"""

from __future__ import annotations

import argparse
import random
import resource
import sys
import tempfile
import time
import warnings
from collections import Counter
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from support.measured_files import FORMATS
from twin.errors import MeasuredError
from twin.measured.forces import force_log
from twin.measured.log import RawLog
from twin.measured.read import read_log

#: A file that takes longer is a failure, s.
MOST_S = 30.0
_EXTREMES = (b"\xff" * 8, b"\0" * 8, b"\0" * 4 + b"\1\0\0\0", b"\xff\xff\xff\x7f", b"\0\0\0\0\0\0\xf0\x7f")
_WORDS = (b",", b";", b"\t", b" ", b"\n", b'"', b"'", b".", b":", b"nan", b"1e999", b"0x1F", b"1,010", b"1.010,5")
_WORDS += (
    b"\x1b[31m",
    b"\xe2\x80\xae",
    b"\xff",
    b"***End_of_Header***",
    b"X_Columns\tMulti\n",
    b"23:59:59.9",
    b"1/2/2020",
)


def mutated(whole: bytes, rng: random.Random) -> bytes:
    """A file with a few changes: bits, bytes, numbers, words, parts that are lost, repeated or moved."""
    data = bytearray(whole)
    for _ in range(rng.randrange(1, 6)):
        at = rng.choice(
            (rng.randrange(len(data)), rng.randrange(min(len(data), 600)), -1 - rng.randrange(len(data)) // 20)
        )
        match rng.randrange(7):
            case 0:
                data[at] ^= 1 << rng.randrange(8)
            case 1:
                data[at] = rng.randrange(256)
            case 2:
                extreme = rng.choice(_EXTREMES)
                data[at : at + len(extreme)] = extreme
            case 3:
                data[at:at] = rng.choice(_WORDS)
            case 4:
                word = rng.choice(_WORDS)
                data[at : at + len(word)] = word
            case 5:
                data[at:at] = data[at : at + rng.randrange(200)]
            case _:
                del data[at : at + rng.randrange(1, 40)]
        if not data:
            return b"\0"
    return bytes(data[: rng.randrange(len(data))] if rng.random() < 0.1 else data)


def sound(log: RawLog) -> None:
    """Laws of every log that was read."""
    assert len(log.t_s) >= 1 and np.isfinite(log.t_s).all()
    assert (np.diff(log.t_s) > 0.0).all()
    assert 0.0 < log.rate_hz < np.inf
    assert all(len(c.values) == len(log.t_s) for c in log.columns.values())


def read_or_refuse(path: Path) -> str:
    """``read``, ``no forces`` or ``refused``.

    Raises:
        AssertionError: it breaks a law.
    """
    begin = time.monotonic()
    outcome = "refused"
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            log = read_log(path)
            sound(log)
            outcome = "no forces"
            assert np.isfinite(force_log(log).force_n).all()
            outcome = "read"
    except MeasuredError as error:
        assert path.name in str(error)
    assert time.monotonic() - begin < MOST_S, f"{path}: took too long"
    return outcome


def attack(name: str, folder: Path, rng: random.Random, seconds: float) -> Counter[str]:
    """Outcomes of mutated files of one format; a file that breaks a law stays in the folder."""
    file, write, _ = FORMATS[name]
    write(folder / file)
    whole = (folder / file).read_bytes()
    found: Counter[str] = Counter()
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        (folder / file).write_bytes(mutated(whole, rng))
        found[read_or_refuse(folder / file)] += 1
    return found


def main() -> None:
    """Attack each format in turn."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=60.0, help="for all formats together")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--folder", type=Path, default=None, help="of the files; a temporary one if not given")
    options = parser.parse_args()
    folder = options.folder or Path(tempfile.mkdtemp())
    rng = random.Random(options.seed)
    for name in FORMATS:
        found = attack(name, folder, rng, options.seconds / len(FORMATS))
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
        print(f"{name:16} {sum(found.values()):7d} files, {dict(found)}, {peak:.0f} MiB")


if __name__ == "__main__":
    main()
