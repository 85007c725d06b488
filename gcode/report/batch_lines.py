"""Motions of runs of plain lines as JSON lines, without an object for each: the text that `motion_json` gives."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from itertools import repeat

import numpy as np
from numpy.typing import NDArray

from gcode.bulk.plain_batch import PlainBatch
from gcode.events import ArcMotion, Dwell, Event, LinearMotion, Point
from gcode.report.motion_json import DECIMALS, further_axes, modal_values, motion_object
from gcode.underline import harmless_json

_encode = json.JSONEncoder(allow_nan=False).encode
_SCALE = 10.0**DECIMALS
#: Numbers above this, in mm, and those nearer than this to the middle of two rounded numbers are rounded one by one.
_LARGE, _NEAR = 1e6, 1e-2
#: Beginning of a line by the motion code.
_HEADS = tuple(f'{{"type": "{name}", "line": ' for name in ("rapid", "feed", "arc", "arc"))


def motion_lines(events: Iterable[Event | PlainBatch], start_mm: Point = (0.0, 0.0, 0.0)) -> Iterator[str]:
    """The motions and dwells among events as JSON lines; other events are skipped.

    Args:
        events: of a program, and runs of plain lines in place of the events that they stand for.
        start_mm: controlled point before the first motion, in machine coordinates; also of a dwell before it.

    Yields:
        Text of one or many lines, each with its line end.
    """
    at = start_mm
    for event in events:
        if isinstance(event, PlainBatch):
            at = event.run.after.position_mm
            if event.run.line.size:
                yield _batch_text(event)
            continue
        if isinstance(event, LinearMotion | ArcMotion):
            at = event.end_mm
        elif not isinstance(event, Dwell):
            continue
        yield f"{harmless_json(_encode(motion_object(event, at)))}\n"


def _batch_text(batch: PlainBatch) -> str:
    run, state = batch.run, batch.state
    x_mm, y_mm, z_mm = (rounded(run.end_mm[:, axis]).tolist() for axis in range(3))
    heads = map(_HEADS.__getitem__, run.code.tolist())
    tool, senses = f', "tool": {state.tool}, "spindle_rpm": ', map(str, run.spindle_direction.tolist())
    further = further_axes(batch.extra) | modal_values(state, batch.file, 1, batch.calls)
    tail = harmless_json(f", {_encode(further)[1:]}")
    feeds, speeds = _texts(run.feed_mm_min), _texts(run.spindle_rpm)
    lines = zip(heads, run.line.tolist(), x_mm, y_mm, z_mm, feeds, speeds, senses, _arcs(batch), strict=False)
    return "".join(
        [
            f'{head}{line}, "end": [{x!r}, {y!r}, {z!r}], "feed_mm_min": {feed}{tool}{rpm}, "spindle_dir": {sense}'
            f"{arc}{tail}\n"
            for head, line, x, y, z, feed, rpm, sense, arc in lines
        ]
    )


def _arcs(batch: PlainBatch) -> Iterable[str]:
    """The part of each line that only arcs have."""
    run, plane = batch.run, batch.start.plane
    arcs = np.flatnonzero(run.code >= 2)
    if not arcs.size:
        return repeat("")
    made = [""] * run.code.size
    centres = rounded(run.centre_mm[arcs]).tolist()
    for index, code, centre in zip(arcs.tolist(), run.code[arcs].tolist(), centres, strict=True):
        made[index] = f', "plane": {plane}, "centre": {centre!r}, "turns": {2 * code - 5}'
    return made


def _texts(values: NDArray[np.float64]) -> Iterable[str]:
    """Numbers as text, each different one made once where there are few."""
    different, index = np.unique(values, return_inverse=True)
    texts = [repr(value) for value in rounded(different).tolist()]
    return repeat(texts[0]) if len(texts) == 1 else map(texts.__getitem__, index.tolist())


def rounded(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Numbers rounded to `DECIMALS` as Python's ``round`` does it, without a negative zero."""
    scaled = values * _SCALE
    whole = np.rint(scaled)
    result: NDArray[np.float64] = whole / _SCALE + 0.0
    doubtful = (np.abs(values) >= _LARGE) | (np.abs(np.abs(scaled - whole) - 0.5) < _NEAR)
    for index in np.argwhere(doubtful):
        result[tuple(index)] = round(float(values[tuple(index)]), DECIMALS) + 0.0
    return result
