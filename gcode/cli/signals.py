"""Signals that end a program, from its first moment; this module imports nothing that takes time."""

from __future__ import annotations

import os
import signal
from types import FrameType
from typing import NoReturn

#: A request to terminate, and the end of the terminal.
_ENDING = [getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name)]
_SIGNALLED = 128


def end_at_once() -> None:
    """Until `end_in_order`, a signal ends the program without a message: there is nothing yet to clean up."""
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


def _end_at_once(number: int, _frame: FrameType | None) -> NoReturn:
    os._exit(_SIGNALLED + number)


def _end_in_order(number: int, _frame: FrameType | None) -> NoReturn:
    raise SystemExit(_SIGNALLED + number)
