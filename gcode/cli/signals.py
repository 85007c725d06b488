"""Signals that end a program, from its first moment; this module imports nothing that takes time."""

from __future__ import annotations

import contextlib
import os
import signal
from collections.abc import Iterator
from types import FrameType
from typing import NoReturn

#: A request to terminate, and the end of the terminal.
_ENDING = [getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name)]
_SIGNALLED = 128
_STDERR = 2


def end_at_once() -> None:
    """Until `end_in_order`, a signal ends the program: there is nothing yet to clean up."""
    for number in (signal.SIGINT, *_ENDING):
        if signal.getsignal(number) in (signal.SIG_DFL, signal.default_int_handler):
            signal.signal(number, _end_at_once)


def end_in_order() -> None:
    """From here on, a signal is an exception: files that are not complete are removed."""
    for number in (signal.SIGINT, *_ENDING):
        if signal.getsignal(number) is _end_at_once:
            signal.signal(number, signal.default_int_handler if number == signal.SIGINT else _end_in_order)


def ignore_signals() -> None:
    """At the end, when the exit code is known: what Python still does is short, and removes temporary files."""
    for number in (signal.SIGINT, *_ENDING):
        if signal.getsignal(number) in (signal.default_int_handler, _end_in_order):
            signal.signal(number, signal.SIG_IGN)


def report_stop() -> None:
    """One word after Ctrl-C, so that its end is not taken for a crash; on its own line, after the terminal's ^C."""
    with contextlib.suppress(OSError):
        os.write(_STDERR, b"\nstopped by Ctrl-C\n")


@contextlib.contextmanager
def stop_reported() -> Iterator[None]:
    """Report a Ctrl-C that ends the work inside; typer turns it into an exit code."""
    try:
        yield
    except KeyboardInterrupt:
        report_stop()
        raise


def _end_at_once(number: int, _frame: FrameType | None) -> NoReturn:
    if number == signal.SIGINT:
        report_stop()
    os._exit(_SIGNALLED + number)


def _end_in_order(number: int, _frame: FrameType | None) -> NoReturn:
    raise SystemExit(_SIGNALLED + number)
