"""Prints how close the assertions of passing tests come to their limits: the last column of docs/validation.md.

    python tools/measured_values.py tests/twin/cutting                      # all comparisons of numbers
    python tools/measured_values.py tests/twin/cutting -k closed_form       # further arguments are pytest's

One line an assertion: the worst value of all its runs, its limit, how often it ran, and the assertion as written.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Sequence

import numpy as np
import pytest

_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?"
_WITHIN = re.compile(rf"({_NUMBER}) ± ({_NUMBER})")
_FLOAT = re.compile(rf"(?<![\w.])(?:np\.float\d+\()?({_NUMBER})\b")
_ORDER = re.compile(r" (<=|>=|<|>) ")


class Values:
    """A plugin of pytest that keeps the worst value of each passed comparison of numbers.

    Attributes:
        worst: for each test and line, share of the limit that was used, value, limit, count, assertion.
    """

    def __init__(self) -> None:
        self.worst: dict[tuple[str, int], tuple[float, float, float, int, str]] = {}

    def pytest_assertion_pass(self, item: pytest.Item, lineno: int, orig: str, expl: str) -> None:
        """Take one comparison; see pytest's hook of this name."""
        if "..." in expl or orig.splitlines()[0] not in item.path.read_text(encoding="utf-8"):
            return  # shortened arrays; assertions of libraries
        found = _within(expl) or _ordered(expl)
        if found is None:
            return
        value, limit = found
        share = value / limit if limit else float(value != 0.0)
        key = (item.nodeid.partition("[")[0], lineno)
        before = self.worst.get(key, (-1.0, 0.0, 0.0, 0, orig))
        best = max(before[:3], (share, value, limit))
        self.worst[key] = (*best, before[3] + 1, orig)


def _within(expl: str) -> tuple[float, float] | None:
    """Largest error, and its limit, of ``values == approx(...)``."""
    left, equal, right = expl.partition("\n  \n  comparison failed")[0].partition(" == ")
    limits = np.array([(float(a), float(b)) for a, b in _WITHIN.findall(right)])
    values = np.array([float(v) for v in _FLOAT.findall(left)])
    if not equal or not len(limits) or len(values) != len(limits):
        return None
    errors = np.abs(values - limits[:, 0])
    k = int(np.argmax(errors / np.where(limits[:, 1] > 0.0, limits[:, 1], np.inf)))
    return float(errors[k]), float(limits[k, 1])


def _ordered(expl: str) -> tuple[float, float] | None:
    """Value and limit of ``value < limit``, both plain numbers or products of them."""
    sides = _ORDER.split(expl.splitlines()[0])
    if len(sides) != 3:
        return None
    found = [_product(side) for side in (sides[0], sides[2])]
    if found[0] is None or found[1] is None:
        return None
    return (found[0], found[1]) if sides[1] in ("<", "<=") else (found[1], found[0])


def _product(text: str) -> float | None:
    """Value of numbers joined by ``*``, None for anything else."""
    factors = [re.fullmatch(rf"(?:np\.float\d+\()?({_NUMBER})\)?", part.strip("( )")) for part in text.split("*")]
    return None if None in factors else float(np.prod([float(f[1]) for f in factors if f]))


def main(arguments: Sequence[str]) -> int:
    """Run tests and print their values.

    Args:
        arguments: files, folders and options of pytest.

    Returns:
        pytest's exit code.
    """
    values = Values()
    quiet = ["-q", "--no-header", "-o", "enable_assertion_pass_hook=true", "-p", "no:cacheprovider"]
    code = int(pytest.main([*quiet, *arguments], plugins=[values]))
    for (test, line), (_, value, limit, count, orig) in values.worst.items():
        print(f"{test}:{line}: {value:.4g} of {limit:.4g}, {count} times: {orig}")
    return code


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
