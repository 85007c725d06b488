"""Ctrl-C as a request: the run ends after the record at hand, with its outputs in order."""

from __future__ import annotations

import signal
import threading
from types import FrameType
from typing import Any, Self

_SIGNALS = (signal.SIGINT, signal.SIGTERM)


class StopRequest:
    """Notes Ctrl-C (or a request to terminate) inside its block; a second one interrupts at once.

    Outside the main thread nothing is noted.

    Attributes:
        signal_number: the signal that was received, None so far.
    """

    def __init__(self) -> None:
        self.signal_number: int | None = None
        self._usual: dict[signal.Signals, Any] = {}

    def __enter__(self) -> Self:
        if threading.current_thread() is threading.main_thread():
            self._usual = {number: signal.signal(number, self._note) for number in _SIGNALS}
        return self

    def __exit__(self, *_: object) -> None:
        for number, usual in self._usual.items():
            signal.signal(number, usual)

    def came(self) -> bool:
        """Whether the run is to end."""
        return self.signal_number is not None

    def _note(self, number: int, _frame: FrameType | None) -> None:
        if self.signal_number is not None:
            raise KeyboardInterrupt
        self.signal_number = number
