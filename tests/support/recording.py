"""Rerun recordings read back."""

from __future__ import annotations

from pathlib import Path

import pyarrow as pa
from rerun.chunk import RrdReader

from twin.sinks.rerun import layout


class Recording:
    """A recording read back, chunk by chunk, as tables."""

    def __init__(self, path: Path) -> None:
        self.tables: dict[str, list[pa.RecordBatch]] = {}
        for chunk in RrdReader(path).stream().to_chunks():
            self.tables.setdefault(chunk.entity_path.lstrip("/"), []).append(chunk.to_record_batch())

    def column(self, entity: str, name: str) -> list[object]:
        """Values of a column in the order of time; rows without it left out."""
        rows: list[tuple[object, object]] = []
        for table in self.tables[entity]:
            if name in table.schema.names:
                times = (
                    table.column(layout.TIME).cast(pa.int64()).to_pylist()
                    if layout.TIME in table.schema.names
                    else [0] * len(table)
                )
                rows += [(t, v) for t, v in zip(times, table.column(name).to_pylist(), strict=True) if v is not None]
        return [v for _, v in sorted(rows, key=lambda row: row[0])]

    def timelines(self, entity: str) -> set[str]:
        """Timelines of an entity's rows; empty for what holds at all times."""
        return {
            n for t in self.tables[entity] for n in t.schema.names if n in (*layout.TIMELINES, "log_time", "log_tick")
        }
