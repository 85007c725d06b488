"""A tool of a library, in the terms of the job file."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any, cast

from twin.errors import ToolError, ToolLibraryError
from twin.tool_library.kinds import SIMULATED, obstacle_of_kind
from twin.tools.shape import ToolKind, tool_shape

#: Keys of a tool without which a job cannot use it; the library may lack the last two.
_NEEDED = ("diameter_mm", "teeth", "flute_length_mm")
#: The keys of ``[[tools]]`` that are single values, in their order.
_KEYS = ("diameter_mm", "corner_radius_mm", "taper_deg", "teeth", "helix_deg", "flute_length_mm")


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolCylinder:
    """A cylinder of a tool that does not cut.

    Attributes:
        diameter_mm: diameter, mm.
        length_mm: length along the tool axis, mm.
    """

    diameter_mm: float
    length_mm: float


@dataclass(frozen=True, slots=True, kw_only=True)
class LibraryTool:
    """A tool of a library; two with the same sizes are equal wherever they were read.

    Attributes:
        number: tool number (the T word), None where the library gives none.
        name: its description.
        kind: ``flat``, ``ball``, ``bull`` or ``taper``; for a tool that cannot be simulated, its type in words.
        diameter_mm: diameter of the cutting part; of a taper tool, diameter at the tip. None where the library has
            no usable value; so for the other sizes.
        corner_radius_mm: corner radius; of a ball, half its diameter.
        taper_deg: half angle of a taper tool.
        teeth: number of flutes.
        helix_deg: helix angle, None in libraries that do not store it.
        flute_length_mm: length of the cutting part.
        gauge_length_mm: distance from the tip to the gauge point of the holder; not part of the job's table, because a
            program without tool length compensation must not be shifted by it.
        shank: cylinder above the flutes.
        holder: cylinders above the shank, from the bottom up.
        holder_name: description of the holder.
        source: the library, and the entry in it.
        notes: what was assumed.
        warnings: values that cannot be right; they are left out.
    """

    number: int | None = None
    name: str = ""
    kind: str
    diameter_mm: float | None = None
    corner_radius_mm: float | None = None
    taper_deg: float | None = None
    teeth: int | None = None
    helix_deg: float | None = None
    flute_length_mm: float | None = None
    gauge_length_mm: float | None = None
    shank: ToolCylinder | None = None
    holder: tuple[ToolCylinder, ...] = ()
    holder_name: str = ""
    source: str = field(default="", compare=False)
    notes: tuple[str, ...] = field(default=(), compare=False)
    warnings: tuple[str, ...] = field(default=(), compare=False)

    @property
    def title(self) -> str:
        """Number and name, for messages: ``T3 "6 mm ball"``."""
        parts = [f"T{self.number}"] if self.number is not None else []
        if self.name:
            parts.append(f'"{self.name}"')
        return " ".join(parts) or f"unnamed {self.kind}"

    @property
    def simulated(self) -> bool:
        """Whether a job can use the tool, once keys that the library lacks are given."""
        return not self.obstacle

    @property
    def obstacle(self) -> str:
        """Reason why the tool cannot be simulated; empty if it can."""
        if self.kind not in SIMULATED:
            return obstacle_of_kind(self.kind)
        if self.diameter_mm is None:
            return "the library has no usable diameter"
        if self.kind == "bull" and self.corner_radius_mm is None:
            return "the library has no usable corner radius"
        if self.kind == "taper" and self.taper_deg is None:
            return "the library has no usable taper angle"
        if self.flute_length_mm is None:
            return ""
        try:
            tool_shape(
                cast(ToolKind, self.kind),
                self.diameter_mm,
                self.flute_length_mm,
                self.corner_radius_mm or 0.0,
                self.taper_deg or 0.0,
            )
        except ToolError as error:
            return str(error).removeprefix("tool shape: ")
        return ""

    @property
    def missing(self) -> tuple[str, ...]:
        """Keys that a job needs and the library does not have."""
        return tuple(key for key in _NEEDED if getattr(self, key) is None)

    def as_job_table(self) -> dict[str, Any]:
        """The tool as a table of ``[[tools]]``, without the keys that the library lacks.

        Raises:
            ToolLibraryError: a tool that cannot be simulated.
        """
        if self.obstacle:
            raise ToolLibraryError(f"{self.source}: {self.title} cannot be simulated: {self.obstacle}")
        return self.job_keys()

    def job_keys(self, kind: str | None = None) -> dict[str, Any]:
        """The keys of `as_job_table`, of a tool that cannot be simulated too.

        Args:
            kind: kind to use the tool's sizes for, if not its own; corner radius and angle are then left out.
        """
        if kind is not None and kind != self.kind:
            return replace(self, kind=kind, corner_radius_mm=None, taper_deg=None).job_keys()
        table: dict[str, Any] = {} if self.number is None else {"number": self.number}
        table |= {"name": self.name, "kind": self.kind}
        without = () if self.kind in ("bull", "taper") else ("corner_radius_mm", "taper_deg")
        table |= {key: value for key in _KEYS if key not in without and (value := getattr(self, key)) is not None}
        if self.kind == "bull":
            table.pop("taper_deg", None)
        if self.shank is not None:
            table["shank"] = _table(self.shank)
        if self.holder:
            table["holder"] = [_table(piece) for piece in self.holder]
        return table


def _table(piece: ToolCylinder) -> dict[str, float]:
    return {"diameter_mm": piece.diameter_mm, "length_mm": piece.length_mm}
