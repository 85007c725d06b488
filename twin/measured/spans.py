"""Text forms of time spans and of the amplifier's zero."""

from __future__ import annotations

import re
from typing import Literal, TypeAlias

from twin.errors import MeasuredError
from twin.measured.log import Gap

#: ``none``; ``air``: mean while the run cuts nothing; a span on the log's clock; or the numbers, N.
Offset: TypeAlias = Literal["none", "air"] | Gap | tuple[float, float, float]

#: Largest time, s, and force, N.
_LARGEST = 1e9
_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_WINDOW = re.compile(rf"^\s*({_NUMBER})\s*(?::|\.\.|–)\s*({_NUMBER})\s*s?\s*$")


def parse_window(text: str) -> Gap:
    """``4.00:4.02`` as beginning and end.

    Raises:
        MeasuredError: not two numbers, or an end that is not after the beginning.
    """
    found = _WINDOW.match(text)
    if found is None:
        raise MeasuredError(f"window {text!r}: expected BEGIN:END in seconds, e.g. 4.00:4.02")
    begin, end = float(found[1]), float(found[2])
    if max(-begin, end) > _LARGEST:
        raise MeasuredError(f"window {text!r}: expected times of at most {_LARGEST:g} s")
    if not begin < end:
        raise MeasuredError(f"window {text!r}: ends at {end:g} s, expected an end after its beginning, {begin:g} s")
    return begin, end


def parse_offset(text: str) -> Offset:
    """``none``, ``air``, ``BEGIN:END`` on the log's clock, or ``X,Y,Z`` in N.

    Raises:
        MeasuredError: none of them.
    """
    bare = text.strip().lower()
    if bare in ("none", "air"):
        return "none" if bare == "none" else "air"
    if _WINDOW.match(bare):
        return parse_window(bare)
    parts = bare.split(",")
    try:
        x, y, z = (float(p) for p in parts)
    except ValueError:
        raise MeasuredError(
            f"offset {text!r}: expected air, none, BEGIN:END in seconds of the log, or X,Y,Z in N"
        ) from None
    if not all(abs(force) <= _LARGEST for force in (x, y, z)):
        raise MeasuredError(f"offset {text!r}: expected forces of at most {_LARGEST:g} N")
    return x, y, z
