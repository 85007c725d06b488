"""Work on parts of an array in threads, for kernels that release the interpreter's lock."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from typing import TypeVar

T = TypeVar("T")

#: Parts that work is divided into; the same for any number of threads, so that results are the same too.
PARTS = 8
#: Up to this many items, several threads do not pay.
FEW = 4096


def in_parts(
    work: Callable[[int, int], None], count: int, *, threads: int | None = None, parts: int = PARTS, few: int = FEW
) -> None:
    """Call ``work(first, last)`` for parts of range(count).

    Args:
        threads: number of threads, None for all cores.
        few: this many items stay on one thread.
    """
    parts = parts if count > few else 1
    bounds = [count * k // parts for k in range(parts + 1)]
    run_all([_part(work, a, b) for a, b in pairwise(bounds) if b > a], threads)


def run_all(tasks: Sequence[Callable[[], T]], threads: int | None = None) -> list[T]:
    """Results of tasks that do not depend on each other, in their order; the first error is raised."""
    workers = min(len(tasks), (os.cpu_count() or 1) if threads is None else threads)
    if workers <= 1:
        return [task() for task in tasks]
    with ThreadPoolExecutor(max_workers=workers) as pool:
        return [future.result() for future in [pool.submit(task) for task in tasks]]


def _part(work: Callable[[int, int], None], first: int, last: int) -> Callable[[], None]:
    return lambda: work(first, last)
