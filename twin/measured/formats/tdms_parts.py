"""Waveforms of TDMS files that were written in parts, each with a start time of its own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from twin.arrays import FloatArray
from twin.errors import MeasuredError

#: A part that begins this many intervals from the end of the one before follows it without a gap.
_FOLLOWS = 2.0


@dataclass(frozen=True, slots=True)
class Part:
    """Samples of a channel that were written together: index of the first one, and its time, s since 1970."""

    first: int
    start_s: float


def parts_of(path: Path) -> dict[str, list[Part]]:
    """The parts of each channel, by its path in the file, that state a start; npTDMS itself keeps the last one only.

    Raises:
        Exception: npTDMS raises many kinds on damaged files.
    """
    from nptdms.reader import TdmsReader

    found: dict[str, list[Part]] = {}
    counts: dict[str, int] = {}
    states: dict[str, dict[str, Any]] = {}

    class _Recorder(TdmsReader):  # type: ignore[misc]
        _before: dict[str, int]

        def _update_object_metadata(self, segment: Any) -> None:
            self._before = dict(counts)
            for each in segment.ordered_objects:
                if each.has_data:
                    counts[each.path] = counts.get(each.path, 0) + each.number_values * segment.num_chunks
            super()._update_object_metadata(segment)

        def _update_object_properties(self, segment_object_properties: Any) -> None:
            for name, properties in (segment_object_properties or {}).items():
                stated = dict(properties)
                states.setdefault(name, {}).update(stated)
                moment = _moment(states[name])
                if moment is not None and {"wf_start_time", "wf_start_offset"} & set(stated):
                    found.setdefault(name, []).append(Part(self._before.get(name, 0), moment))
            super()._update_object_properties(segment_object_properties)

    reader = _Recorder(str(path))
    try:
        reader.read_metadata()
    finally:
        reader.close()
    return found


def _moment(properties: Mapping[str, Any]) -> float | None:
    """Time of a waveform's first sample, s since 1970."""
    start = properties.get("wf_start_time")
    if start is None:
        return None
    seconds = (np.datetime64(getattr(start, "as_datetime64", lambda _: start)("us")) - np.datetime64(0, "us")) / (
        np.timedelta64(1, "s")
    )
    return float(seconds) + float(properties.get("wf_start_offset", 0.0))


def times_of(path: Path, name: str, parts: Sequence[Part], count: int, step_s: float) -> FloatArray | None:
    """Times of a channel's samples from its first one, s; None where all parts follow one another.

    Raises:
        MeasuredError: a part begins before the end of the one before.
    """
    t_s: FloatArray = np.arange(count, dtype=np.float64) * step_s
    apart = False
    for before, part in pairwise(parts):
        if not 0 < part.first < count or part.start_s == before.start_s:  # stated again with every write
            continue
        ahead = part.start_s - parts[0].start_s - float(t_s[part.first])
        if abs(ahead) <= _FOLLOWS * step_s:
            continue
        if ahead < 0.0:
            raise MeasuredError(
                f"{path}: {name} begins again at sample {part.first + 1}, {-ahead:g} s before the end of the samples "
                "before it, by its wf_start_time; expected increasing time: split the file there"
            )
        t_s[part.first :] += ahead
        apart = True
    return t_s if apart else None
