"""A word when code is compiled: the first run of a version takes longer than all later ones."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator

#: Called once when the first function is compiled that is not kept; set by `on_compiling`.
_listeners: list[Callable[[], None]] = []


@contextlib.contextmanager
def on_compiling(listener: Callable[[], None]) -> Iterator[None]:
    """Call a function when a function of this process begins to be compiled, once inside the block."""
    _listeners.append(listener)
    try:
        yield
    finally:
        with contextlib.suppress(ValueError):
            _listeners.remove(listener)


def compiling() -> None:
    """A function is not kept, and is compiled now."""
    while _listeners:
        _listeners.pop()()
