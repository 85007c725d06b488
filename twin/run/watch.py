"""Collisions and warnings of a run: by NC line, words without effect, a path that misses the stock."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from twin.number_format import plural
from twin.record import Collision, CollisionKind, NcEvent, Record, RunHeader, RunSummary, Step
from twin.run.plausibility import Plausibility

#: More collisions than this are counted and not kept.
MOST_COLLISIONS = 1000
_MOST_NOTICES = 5
_STOCK_NOTE = re.compile(r"stock\.note\[\d+\]")
_TOOL_CAUTION = re.compile(r"tools\[\d+\]\.caution")
#: What each kind of collision is.
COLLISION_TEXTS: Mapping[CollisionKind, str] = {
    "rapid": "rapid through the stock",
    "shank": "shank touches the stock",
    "holder": "holder touches the stock",
    "spindle-stopped": "feed with the spindle stopped",
}


@dataclass(slots=True, kw_only=True)
class CollisionGroup:
    """Collisions of one kind, of one tool, on one NC line.

    Attributes:
        nc_line: line of the NC program.
        tool: tool number.
        kind: see `twin.record.Collision`.
        point_mm, t_s: tool tip and machine time of the first.
        count: number of them.
        volume_mm3: material swept by the colliding body, in all of them.
    """

    nc_line: int
    tool: int
    kind: CollisionKind
    t_s: float
    point_mm: tuple[float, float, float]
    count: int = 0
    volume_mm3: float = 0.0


@dataclass(slots=True)
class _Extent:
    """Smallest box around points."""

    low: list[float] = field(default_factory=lambda: [float("inf")] * 3)
    high: list[float] = field(default_factory=lambda: [float("-inf")] * 3)

    def add(self, point: tuple[float, float, float]) -> None:
        for i, x in enumerate(point):
            self.low[i] = min(self.low[i], x)
            self.high[i] = max(self.high[i], x)

    def __str__(self) -> str:
        return " ".join(f"{axis} {a:g}..{b:g}" for axis, a, b in zip("XYZ", self.low, self.high, strict=True))


class Watch:
    """Collects collisions and warnings from the records of a run; its memory does not grow with the run.

    Attributes:
        header: the run's header, None before it was taken.
        collisions: the first `MOST_COLLISIONS` collisions.
        groups: all collisions by NC line, tool and kind, in order.
        t_s: machine time so far.
    """

    def __init__(self) -> None:
        self.header: RunHeader | None = None
        self.collisions: list[Collision] = []
        self.t_s = 0.0
        self._plausibility = Plausibility()
        self._groups: dict[tuple[int, int, CollisionKind], CollisionGroup] = {}
        self._notices: dict[str, tuple[int, int]] = {}
        self._feeds = _Extent()
        self._fed = False
        self._reversed: dict[int, int] = {}

    @property
    def groups(self) -> list[CollisionGroup]:
        """See the class."""
        return list(self._groups.values())

    def take(self, record: Record) -> None:
        """Take one record."""
        self._plausibility.take(record)
        if isinstance(record, Step):
            self._step(record)
        elif isinstance(record, NcEvent):
            if record.kind == "notice":
                count, line = self._notices.get(record.text, (0, record.nc_line))
                self._notices[record.text] = (count + 1, line)
        elif isinstance(record, Collision):
            self._collision(record)
        elif isinstance(record, RunHeader):
            self.header = record

    def warnings(self, summary: RunSummary) -> list[str]:
        """Warnings for the user, one line each."""
        remarks = (*self._on_stock(), *self._on_coefficients(), *self._on_tools(), *self._without_effect())
        return [*self._collided(summary), *self.doubts(summary), *remarks]

    def doubts(self, summary: RunSummary) -> list[str]:
        """The warnings that are errors in a strict replay: nothing was cut, or numbers are not plausible."""
        return [*self._missed(summary), *self._plausibility.warnings(summary)]

    def _step(self, step: Step) -> None:
        self.t_s = step.t_s + step.duration_s
        if not step.rapid and step.start_mm != step.end_mm:
            self._fed = True
            self._feeds.add(step.start_mm)
            self._feeds.add(step.end_mm)
            if step.spindle_rpm < 0.0 and step.engagement.cutting:
                self._reversed.setdefault(step.tool, step.nc_line)

    def _collision(self, collision: Collision) -> None:
        if len(self.collisions) < MOST_COLLISIONS:
            self.collisions.append(collision)
        key = (collision.nc_line, collision.tool, collision.kind)
        group = self._groups.get(key)
        if group is None:
            group = self._groups[key] = CollisionGroup(
                nc_line=collision.nc_line,
                tool=collision.tool,
                kind=collision.kind,
                t_s=collision.t_s,
                point_mm=collision.point_mm,
            )
        group.count += 1
        group.volume_mm3 += collision.volume_mm3

    def _collided(self, summary: RunSummary) -> Iterator[str]:
        if summary.collisions and self.collisions:
            yield f"{plural(summary.collisions, 'collision')}, the first: {self.collisions[0].message}"

    def _missed(self, summary: RunSummary) -> Iterator[str]:
        """The most common error of a setup: stock and path at different positions."""
        if summary.complete and summary.removed_volume_mm3 <= 0.0 and self.header is not None:
            stock = _Extent()
            for corner in self.header.stock_bounds_mm.tolist():
                stock.add(tuple(corner))
            path = f"the feed motions are at {self._feeds}" if self._fed else "there is no feed motion"
            yield (
                f"no material was cut: {path}, the stock is at {stock}; "
                "check stock, machine.offsets and the tools' length_mm in the job"
            )

    def _on_stock(self) -> Iterator[str]:
        """Assumptions and repairs of the file of the stock."""
        parameters = self.header.parameters if self.header is not None else {}
        yield from (text for key, text in parameters.items() if _STOCK_NOTE.fullmatch(key))

    def _on_coefficients(self) -> Iterator[str]:
        """Coefficients without a source, and the cautions that come with others."""
        parameters = self.header.parameters if self.header is not None else {}
        tables = (key.removesuffix(".Ktc") for key in parameters if key.endswith("cutting.Ktc"))
        for table in tables:
            if f"{table}.source" not in parameters:
                yield f"{table}.source is not given; state the source of the coefficients"
            if f"{table}.caution" in parameters:
                name = parameters.get(f"{table}.material")
                which = f'{table}.material = "{name}"' if name else table
                yield f"{which}: {parameters[f'{table}.caution']}"

    def _on_tools(self) -> Iterator[str]:
        """Assumptions on the tools, as the job states them."""
        parameters = self.header.parameters if self.header is not None else {}
        for tool, line in self._reversed.items():
            yield (
                f"line {line}: T{tool} cuts under M4: it is taken for a left-hand cutting tool, the mirror image of "
                "the job's; a right-hand one would rub"
            )
        for key, text in parameters.items():
            if _TOOL_CAUTION.fullmatch(key):
                yield f"tool {parameters.get(key.replace('.caution', '.number'))}: {text}"

    def _without_effect(self) -> Iterator[str]:
        for text, (count, line) in list(self._notices.items())[:_MOST_NOTICES]:
            yield f"line {line}: {text}" + (f" (and {count - 1} more like it)" if count > 1 else "")
        if len(self._notices) > _MOST_NOTICES:
            more = plural(len(self._notices) - _MOST_NOTICES, "more kind")
            yield f"{more} of words without effect; see the archive"
