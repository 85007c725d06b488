"""A file read in a process of its own: libraries in C may crash on a damaged file, or never end."""

from __future__ import annotations

import os
import pickle
import resource
import signal
import sys
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import IO, NoReturn, TypeVar

from twin.errors import MeasuredError

_Read = TypeVar("_Read")
#: CPU time that a file may take, s, and the bytes that may take one second more: readers are several times as fast.
_FREE_S = 10
_BYTES_PER_S = 5_000_000


def read_apart(read: Callable[[Path], _Read], path: Path) -> _Read:
    """Read a file in a copy of this process, so that only the copy ends where a library crashes.

    Elsewhere than on Linux the file is read in this process.

    Args:
        read: returns what can be pickled; raises `MeasuredError` for a file that it refuses.

    Raises:
        MeasuredError: as ``read``; or the copy crashed, or took too long.
    """
    if sys.platform != "linux":
        return read(path)
    limit_s = _FREE_S + path.stat().st_size // _BYTES_PER_S
    with os.fdopen(os.memfd_create("table"), "w+b") as outcome:
        status = _in_copy(read, path, outcome, limit_s)
        outcome.seek(0)
        try:
            found = pickle.load(outcome)
        except (EOFError, pickle.UnpicklingError):
            raise MeasuredError(f"{path}: the file is damaged: {_ending(status, limit_s)}") from None
    if isinstance(found, BaseException):
        raise found
    return found[0]  # type: ignore[no-any-return]


def _in_copy(read: Callable[[Path], object], path: Path, outcome: IO[bytes], limit_s: int) -> int:
    """Read a file in a copy of this process, which writes the table or the error; returns the copy's status."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # the copy starts no thread of this process
        copy = os.fork()
    if not copy:
        _read_and_end(read, path, outcome, limit_s)
    try:
        return os.waitpid(copy, 0)[1]
    except BaseException:
        os.kill(copy, signal.SIGKILL)
        os.waitpid(copy, 0)
        raise


def _read_and_end(read: Callable[[Path], object], path: Path, outcome: IO[bytes], limit_s: int) -> NoReturn:
    """The work of the copy; nothing of this process is cleaned up there."""
    code = 1
    try:
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, 2)  # a crash may print
        used_s = int(sum(resource.getrusage(resource.RUSAGE_SELF)[:2])) + 1
        resource.setrlimit(resource.RLIMIT_CPU, (used_s + limit_s, resource.RLIM_INFINITY))
        signal.signal(signal.SIGXCPU, signal.SIG_DFL)
        try:
            found: object = (read(path),)
        except (MeasuredError, OSError, MemoryError) as error:
            found = error
        pickle.dump(found, outcome, protocol=pickle.HIGHEST_PROTOCOL)
        outcome.flush()
        code = 0
    finally:
        os._exit(code)


def _ending(status: int, limit_s: int) -> str:
    if not os.WIFSIGNALED(status):
        return "the library that reads it failed"
    number = os.WTERMSIG(status)
    if number == signal.SIGXCPU:
        return f"reading it takes more than {limit_s} s"
    return f"the library that reads it ended with {signal.Signals(number).name}"
