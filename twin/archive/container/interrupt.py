"""Ctrl-C between records, not within one."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

#: Signals that end a program: Ctrl-C, a request to terminate, the end of a terminal.
ENDING_SIGNALS = tuple(
    signal.Signals[name] for name in ("SIGINT", "SIGTERM", "SIGHUP") if name in signal.Signals.__members__
)


@contextmanager
def after_this(*numbers: signal.Signals) -> Iterator[None]:
    """Ctrl-C inside the block takes effect at its end, so that what the block writes is complete.

    Outside the main thread, and for signals that something other than Python handles, nothing changes.

    Args:
        numbers: signals; Ctrl-C if none is given.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    usual = {number: signal.getsignal(number) for number in numbers or (signal.SIGINT,)}
    caught: list[tuple[Any, ...]] = []
    for number, handler in usual.items():
        if callable(handler):
            signal.signal(number, lambda *arguments: caught.append(arguments))
    try:
        yield
    finally:
        for number, handler in usual.items():
            if callable(handler):
                signal.signal(number, handler)
        for arguments in caught[:1]:
            handler = usual[arguments[0]]
            if callable(handler):
                handler(*arguments)
