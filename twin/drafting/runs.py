"""Runs of a program for a draft: in the likeliest dialect that takes it, with settings that its blocks require."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from gcode.dialects import DIALECTS
from gcode.errors import GcodeError
from gcode.flow.interpreter import taken_dialect
from gcode.language.program import Program
from twin.drafting.cuts import Cuts, cuts_of
from twin.drafting.notes import Notes
from twin.drafting.settings import DraftSettings

_UNIT_CODE = re.compile(r"G\s*0*7[01](?![\d.])", re.IGNORECASE)


@dataclass(frozen=True, slots=True, kw_only=True)
class Remedy:
    """A setting with which a program runs that is refused without it.

    Attributes:
        key, value: key of the job's ``[program]``, and its value; of `MachineSettings` as well.
        assumed: what the setting assumes, in words.
        reason: why, with ``{line}`` for the line that was refused.
        comment: the reason in the job file.
    """

    key: str
    value: Any
    assumed: str
    reason: str
    comment: str


_CENTRES = Remedy(
    key="arc_centres",
    value="absolute",
    assumed="arc centres I, J, K are coordinates",
    reason="with incremental ones, line {line} is not an arc",
    comment="with incremental ones, the arcs have no common radius",
)
_UNITS = Remedy(
    key="g70_units",
    value=True,
    assumed="G70 and G71 set inches and millimetres",
    reason="line {line} has no words of another meaning; Mach3 and some posts of NX have them for G20 and G21",
    comment="as on Mach3 and in some posts of NX",
)


def _remedy(error: GcodeError) -> Remedy | None:
    if error.code == "arc-radius":
        return _CENTRES
    if error.code in ("unknown-code", "unsupported-code") and _UNIT_CODE.match(error.problem):
        return _UNITS
    return None


class ProgramRuns:
    """Runs a program, and keeps the dialect and the settings that it needs.

    Attributes:
        dialect: name of the dialect.
        dialect_reason: why this one; empty where it was given.
        remedies: settings that the program needs, in order.
    """

    def __init__(self, program: Program, given: DraftSettings, notes: Notes) -> None:
        self._program, self._notes = program, notes
        dialect, notice = taken_dialect(program, given.dialect)
        self.dialect = dialect.name
        self.dialect_reason = "" if notice is None else notice.text.partition(": ")[2]
        self._others = [name for name in DIALECTS if name != self.dialect] if given.dialect == "auto" else []
        self._more: dict[str, Any] = {"m_codes": dict.fromkeys(given.m_codes, "none")}
        self.remedies: tuple[Remedy, ...] = ()

    def first(self, tool: int) -> Cuts:
        """Run the program in the likeliest dialect; one that is refused there, in the first dialect that takes it.

        Args:
            tool: number of the tool in the spindle at the start.

        Raises:
            GcodeError: the program is refused in all of them; the error is that of the likeliest one.
        """
        try:
            return self.run(tool)
        except GcodeError as error:
            refused, first = error, self.dialect
        for name in self._others:
            self.dialect = name
            try:
                cuts = self.run(tool)
            except GcodeError:
                continue
            self.dialect_reason = f"{first} refuses line {refused.place.line}: {refused.problem}"
            return cuts
        raise refused

    def run(self, tool: int, radii_mm: Mapping[int, float] | None = None) -> Cuts:
        """Run the program; blocks that are refused are tried with a setting that gives them a meaning.

        Args:
            tool: number of the tool in the spindle at the start.
            radii_mm: radius offsets by number, None where they are not known.

        Raises:
            GcodeError: the program is refused.
        """
        tried: list[tuple[Remedy, int]] = []
        refused: GcodeError | None = None
        while True:
            more = self._more | {remedy.key: remedy.value for remedy, _ in tried}
            try:
                cuts = cuts_of(self._program, self.dialect, tool=tool, radii_mm=radii_mm, **more)
            except GcodeError as error:
                refused = refused or error
                remedy = _remedy(error)
                if remedy is None or remedy.key in more:
                    raise refused from None
                tried.append((remedy, error.place.line))
                continue
            for remedy, line in tried:
                self._more[remedy.key] = remedy.value
                self.remedies += (remedy,)
                self._notes.assume("program", remedy.assumed, remedy.reason.format(line=line))
            return cuts
