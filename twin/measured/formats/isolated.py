"""A reader in a process of its own: a damaged file may make a library end the process, hang, or take all memory.

On Linux only, where a process can be copied cheaply and safely; elsewhere the reader runs in this process.
"""

from __future__ import annotations

import importlib
import mmap
import os
import pickle
import select
import signal
import sys
import time
import warnings
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from twin.errors import MeasuredError
from twin.measured.formats.bounds import most_bytes
from twin.measured.table import Table

#: Time for a file, s: this, and one second more for this many bytes.
_LEAST_S, _BYTES_PER_S = 15.0, 5e6
#: Copies of the unpacked data that a reader may hold at once.
_COPIES = 6
_PIECE_BYTES = 1 << 16
_NO_VALUES = np.zeros((0, 0))


def isolated(path: Path, read: Callable[[], Table], module: str) -> Table:
    """The table that a reader makes, or one error whatever becomes of its process.

    Args:
        module: library that the reader needs; it is loaded here, once.

    Raises:
        MeasuredError: the reader's own, or that its process ended, or took too long.
    """
    importlib.import_module(module)
    if sys.platform != "linux":
        return read()
    shared = mmap.mmap(-1, most_bytes(path))
    receive, send = os.pipe()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # threads of this process do nothing in the copy
        child = os.fork()
    if not child:
        os.close(receive)
        _carry_out(path, read, shared, send)
    os.close(send)
    try:
        data = _received(path, receive)
    finally:
        os.close(receive)
        with suppress(ProcessLookupError):
            os.kill(child, signal.SIGKILL)
        status = os.waitpid(child, 0)[1]
    return _result(path, data, shared, status)


def _carry_out(path: Path, read: Callable[[], Table], shared: mmap.mmap, send: int) -> None:
    """The copy's work; it ends here."""
    try:
        quiet = os.open(os.devnull, os.O_WRONLY)
        os.dup2(quiet, 1)
        os.dup2(quiet, 2)
        _bound_memory(path)
        with os.fdopen(send, "wb") as pipe:
            pickle.dump(_outcome(path, read, shared), pipe)
    finally:
        os._exit(0)


def _outcome(path: Path, read: Callable[[], Table], shared: mmap.mmap) -> Any:
    """The table, its values in shared memory if they fit; or the message of the error."""
    try:
        made = read()
    except MeasuredError as error:
        return str(error)
    except MemoryError:
        return MemoryError
    except Exception as error:  # a library's; here it would be lost with the process
        return f"{path}: cannot be read: {error}"
    if not 0 < made.values.nbytes <= len(shared):
        return made, None
    values = np.frombuffer(shared, np.float64, made.values.size).reshape(made.values.shape)
    values[:] = made.values
    return replace(made, values=_NO_VALUES), made.values.shape


def _bound_memory(path: Path) -> None:
    import resource

    pages = int(Path("/proc/self/statm").read_text("ascii").split()[0])
    used = pages * resource.getpagesize()
    hard = resource.getrlimit(resource.RLIMIT_AS)[1]
    wanted = used + _COPIES * most_bytes(path)
    resource.setrlimit(resource.RLIMIT_AS, (wanted if hard < 0 else min(wanted, hard), hard))


def _received(path: Path, receive: int) -> bytes:
    """All that the copy sends until it ends.

    Raises:
        MeasuredError: nothing for too long.
    """
    wait_s = _LEAST_S + path.stat().st_size / _BYTES_PER_S
    end = time.monotonic() + wait_s
    pieces: list[bytes] = []
    while True:
        left = end - time.monotonic()
        if left <= 0.0 or not select.select([receive], [], [], left)[0]:
            raise MeasuredError(f"{path}: cannot be read: no end after {wait_s:.0f} s; the file is damaged")
        piece = os.read(receive, _PIECE_BYTES)
        if not piece:
            return b"".join(pieces)
        pieces.append(piece)


def _result(path: Path, data: bytes, shared: mmap.mmap, status: int) -> Table:
    """The copy's table, as its own."""
    try:
        found = pickle.loads(data)
    except (EOFError, pickle.UnpicklingError):
        ended = signal.Signals(status & 0x7F).name if 0 < status & 0x7F < signal.NSIG else "an error"
        raise MeasuredError(f"{path}: cannot be read: the reader ended by {ended}; the file is damaged") from None
    if isinstance(found, str):
        raise MeasuredError(found)
    if found is MemoryError:
        raise MeasuredError(f"{path}: cannot be read: it needs more memory than such a file may; the file is damaged")
    table, shape = found
    assert isinstance(table, Table)
    if shape is None:
        return table
    return replace(table, values=np.frombuffer(shared, np.float64, int(np.prod(shape))).reshape(shape))
