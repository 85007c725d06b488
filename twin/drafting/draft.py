"""A job from an NC program: `draft_job`."""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any

from gcode.errors import GcodeError
from gcode.language.program import Program, read_program
from twin.drafting.comments.program_text import ProgramText
from twin.drafting.comments.stock_posts import stock_comment
from twin.drafting.comments.tool_words import ToolStatement
from twin.drafting.cuts import Cuts
from twin.drafting.doubts import doubts, outside_contours
from twin.drafting.estimate import Estimate, estimate
from twin.drafting.fineness import Fineness, fineness_of
from twin.drafting.from_library import library_tools
from twin.drafting.notes import Assumption, Notes
from twin.drafting.runs import ProgramRuns
from twin.drafting.settings import DraftSettings
from twin.drafting.stock import CutShape, StockBox, stock_of
from twin.drafting.tables import DraftTable, file_text
from twin.drafting.tools import DraftTool, completed, drilling_kind, stated_tools, tool_table
from twin.errors import ReplayError
from twin.job import Job, job_from_text
from twin.materials import find_material
from twin.settings.check import changed


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class JobDraft:
    """A job that was drafted from an NC program.

    Attributes:
        path: the job file, which need not exist.
        assumptions: values that the program does not state.
        assumed: the same in words, a line for each subject and reason.
        stated: tools and stock that comments of the program state, in words.
        open: what could not be assumed, and what to do about it.
        warnings: contradictions in the program or with what was given.
        estimate: time, memory and file sizes of a replay.
        tables: the tables of the file.
    """

    path: Path
    assumptions: tuple[Assumption, ...]
    assumed: tuple[str, ...]
    stated: tuple[str, ...]
    open: tuple[str, ...]
    warnings: tuple[str, ...]
    estimate: Estimate
    tables: tuple[DraftTable, ...]

    def toml_text(self) -> str:
        """The job file, with a comment at every value that was assumed."""
        heading = [f"Drafted from {self.tables[0].get('file')}. Comments name what was assumed; change what is wrong."]
        return file_text(heading + [f"open: {text}" for text in self.open], self.tables)

    def job(self) -> Job:
        """The job, checked as its file would be.

        Raises:
            JobError: values that a job must not have.
        """
        return job_from_text(self.toml_text(), self.path)


def draft_job(
    nc_path: str | PathLike[str],
    settings: DraftSettings | None = None,
    *,
    path: str | PathLike[str] | None = None,
    **values: Any,
) -> JobDraft:
    r"""Draft a job from an NC program: dialect, tools, stock, work offsets, resolution.

    What the program states, in its blocks and in the comments of its post, is used; the rest is assumed, each value
    with a comment in the file and an entry in ``assumptions``. Nothing is written.

    Args:
        nc_path: the NC program.
        settings: values to use in place of assumed ones.
        path: the job file that is to be written, to which paths in it are relative; the program's name with .toml in
            the current folder if not given.
        values: settings by name, e.g. ``material="Al7075-T6"``, ``stock="box 100 60 20"``.

    Returns:
        The draft: text of the file, job, assumptions, warnings, estimate.

    Raises:
        SettingsError: wrong settings.
        TwinError: a library, material or stock that cannot be used, or a program that cuts nothing.
        gcode.GcodeError: a program that cannot be interpreted.

    Example:
        >>> draft = twin.draft_job("part.nc", material="Al7075-T6")
        >>> print(*draft.assumptions, sep="\n")
        >>> run = twin.replay(draft.job())
    """
    given = changed(DraftSettings, settings, values, "draft_job")
    file = Path(nc_path)
    target = Path(path) if path is not None else Path(f"{file.stem}.toml")
    if given.material is not None:
        find_material(given.material)
    return _Drafting(file, given, target).draft()


#: Height of the machine's zero above the stock, where a program moves to it, mm.
_ABOVE_MM = 100.0


class _Drafting:
    """The steps of one draft."""

    def __init__(self, file: Path, given: DraftSettings, target: Path) -> None:
        self.file, self.given, self.target = file, given, target
        self.program: Program = read_program(file)
        self.text = ProgramText(self.program)
        self.notes = Notes()
        self.runs = ProgramRuns(self.program, given, self.notes)
        self.wear: dict[int, str] = {}

    def draft(self) -> JobDraft:
        """All steps."""
        tool = self.given.tool or 0
        cuts = self.runs.first(tool)
        if not len(cuts.feed.tool):
            empty = "the file is empty" if not self.program.size else "the program has no feed motion"
            raise ReplayError(f"{self.file}: {empty}; there is nothing to cut")
        if 0 in cuts.tools:
            tool = self._first_tool()
            cuts = self.runs.run(tool)
        if 0 in cuts.tools:
            line = int(cuts.feed.line[cuts.feed.tool == 0][0])
            raise ReplayError(
                f"{self.file}:{line}: feed motion with T0, without a tool; expected a tool change before it"
            )
        tools = self._tools(cuts)
        if cuts.compensated:
            cuts = self._compensated(tool, cuts, tools)
        stock = self._stock(cuts, tools)
        inside = cuts.feed.only(cuts.feed.low_mm[:, 2] < stock.high_mm[2])
        mills = [t.diameter_mm for t in tools if t.cuts] or [t.diameter_mm for t in tools]
        thinnest = min(t.library.get("diameter_mm", t.tip_mm) if t.library else t.tip_mm for t in tools)
        fine = self._fineness(fineness_of(inside, mills, stock.size_mm, thinnest))
        doubts(cuts, tools, float(stock.high_mm[2]), self.notes)
        tables = [
            self._program_table(tool),
            self._machine_table(cuts, float(stock.high_mm[2])),
            stock.table,
            *self._tool_tables(cuts, tools, float(stock.high_mm[2])),
            *self._cutting_tables(tools),
            self._simulation_table(fine),
            self._output_table(),
        ]
        return JobDraft(
            path=self.target,
            assumptions=tuple(self.notes.assumptions),
            assumed=tuple(self.notes.lines()),
            stated=tuple(self.notes.stated),
            open=tuple(self.notes.open),
            warnings=tuple(self.notes.warnings),
            estimate=estimate(cuts, stock, fine, tools, forces=self._forces(tools)),
            tables=tuple(tables),
        )

    def _first_tool(self) -> int:
        """The tool in the spindle at the start of a program that cuts before its first tool change."""
        known = [n for n in stated_tools(self.text, [], Notes()) if n]
        words = [word.number for word in self.text.tool_words if word.number]
        tool = self.text.commented_tool or (words or known or [1])[0]
        self.notes.assume("program", f"T{tool} in the spindle at the start", "it cuts before its first tool change")
        return tool

    def _tools(self, cuts: Cuts) -> list[DraftTool]:
        stated = stated_tools(self.text, cuts.tools, self.notes)
        library = library_tools(self.given.tools, cuts.tools, stated, self.notes) if self.given.tools else {}
        return [library.get(n) or self._completed(n, cuts, stated.get(n)) for n in cuts.tools]

    def _completed(self, number: int, cuts: Cuts, states: ToolStatement | None) -> DraftTool:
        feed = cuts.feed.only(cuts.feed.tool == number)
        return completed(number, states, self.text.unit, self.notes, drilling_kind(feed))

    def _compensated(self, tool: int, cuts: Cuts, tools: list[DraftTool]) -> Cuts:
        """The program again with the radius of each tool in its offsets."""
        radii = {number: 0.0 for t in cuts.length_offsets.values() for number in t}
        for one in tools:
            radius = 0.0 if one.states.wear else 0.5 * one.diameter_mm
            radii |= dict.fromkeys([one.number, *cuts.compensated.get(one.number, ())], radius)
        comment = "the program is posted for the wear only: its comment states WEAR COMP"
        self.wear = {one.number: comment for one in tools if one.states.wear and one.number in cuts.compensated}
        try:
            compensated = self.runs.run(tool, radii)
        except GcodeError as error:
            self.wear = dict.fromkeys(cuts.compensated, "assumed: the program is posted for the wear only")
            self.notes.warnings.append(
                f"cutter compensation with the tools' radii is refused ({error.place}: {error.problem}): they are "
                "taken as 0, as for a program posted with the path of the tool centre; or a comment states a wrong "
                "diameter"
            )
            return cuts
        for number in sorted(cuts.compensated):
            if number in self.wear:
                continue
            offsets = ", ".join(f"D{d}" for d in sorted(cuts.compensated[number]))
            reason = "cutter compensation; a post may expect the wear only"
            self.notes.assume(f"T{number}", f"radius {radii.get(number, 0.0):g} mm in {offsets}", reason)
        return compensated

    def _stock(self, cuts: Cuts, tools: list[DraftTool]) -> StockBox:
        radii = {t.number: 0.5 * t.diameter_mm for t in tools}
        facing = {t.number for t in tools if t.kind == "face mill"}
        stated = stock_comment(self.text.comments, self.text.unit)
        given = self.given
        shape = CutShape.of(cuts.feed, radii, facing)
        stock = stock_of(shape, stated, given.stock, given.margin_mm, self.notes, self.target.parent)
        if given.margin_mm and (stated is not None or given.stock is not None):
            known = "stock is given"
            if stated is not None and given.stock is None:
                known = f"program states its stock in line {stated.line}"
            self.notes.warnings.append(f"a margin of {given.margin_mm:g} mm has no effect: the {known}")
        if stated is None and given.stock is None:
            self.notes.warnings += outside_contours(cuts, tools, stock.low_mm, stock.high_mm)
        if cuts.offsets[0] != "G54":
            stock.table.add("wcs", cuts.offsets[0])
        return stock

    def _fineness(self, fine: Fineness) -> Fineness:
        given = self.given
        return Fineness(
            pitch_mm=given.pitch_mm or fine.pitch_mm,
            angle_deg=given.angle_step_deg or fine.angle_deg,
            pitch_reason="given" if given.pitch_mm else fine.pitch_reason,
            angle_reason="given" if given.angle_step_deg else fine.angle_reason,
        )

    def _program_table(self, tool: int) -> DraftTable:
        table = DraftTable(name="program")
        table.add("file", Path(os.path.relpath(self.file, self.target.parent)).as_posix())
        dialect, reason = self.runs.dialect, self.runs.dialect_reason
        table.add("dialect", dialect, f"assumed: {reason}" if reason else "")
        if self.given.dialect == "auto":
            self.notes.assume("program", f"dialect {dialect}", reason)
        if not self.text.states_unit:
            table.add("units", "mm", "assumed: the program has no G20 or G21")
            self.notes.assume("program", "lengths in mm", "it has no G20 or G21")
        for remedy in self.runs.remedies:
            table.add(remedy.key, remedy.value, f"assumed: {remedy.comment}")
        if tool:
            table.add("tool", tool, "" if self.given.tool else "assumed: it cuts before its first tool change")
        if self.given.m_codes:
            table.add("m_codes", {str(code): "none" for code in self.given.m_codes})
        return table

    def _machine_table(self, cuts: Cuts, top_mm: float) -> DraftTable:
        """Work offsets at 0, or where the program moves to the machine's zero, so that this is above the stock."""
        reason, z = "the program does not state where its work zeros are on the machine", 0.0
        if self.text.moves_in_machine_coordinates:
            z = -float(math.ceil((max(top_mm, 0.0) + _ABOVE_MM) / 10.0) * 10.0)
            reason += ", and moves in machine coordinates (G53), whose zero is taken above the stock"
        table = DraftTable(name="machine")
        table.add("offsets", {wcs: [0.0, 0.0, z] for wcs in cuts.offsets}, f"assumed: {reason}")
        names = ", ".join(cuts.offsets)
        self.notes.assume("machine", f"{names} at {f'Z{z:g}' if z else '0'}", reason)
        if len(cuts.offsets) > 1 and not self.text.sets_offsets:
            self.notes.warnings.append(
                f"the program uses {len(cuts.offsets)} work offsets ({names}), and all of them are taken at the same "
                "position; set machine.offsets in the job file (twin job)"
            )
        return table

    def _tool_tables(self, cuts: Cuts, tools: list[DraftTool], top_mm: float) -> list[DraftTable]:
        lowest = {n: float(cuts.feed.low_mm[cuts.feed.tool == n, 2].min()) for n in cuts.tools}
        own = self._cutting(tools)
        tables = []
        for tool in tools:
            cutting = own if own is not None and tool.cuts else None
            tables.append(tool_table(tool, max(0.0, top_mm - lowest[tool.number]), cutting, self.notes))
            if tool.number in self.wear:
                tables[-1].add("offset_radius_mm", 0.0, self.wear[tool.number])
        return tables + self._offset_rows(cuts, tools)

    def _offset_rows(self, cuts: Cuts, tools: list[DraftTool]) -> list[DraftTable]:
        """Rows of the offset table with other numbers than the tools: the control looks them up there."""
        rows: dict[int, DraftTool] = {}
        for tool in tools:
            numbers = cuts.compensated.get(tool.number, frozenset()) | cuts.length_offsets.get(tool.number, frozenset())
            rows |= {n: tool for n in sorted(numbers) if n}
        tables = []
        for number in sorted(set(rows) - {tool.number for tool in tools}):
            table = DraftTable(name="tools", listed=True)
            table.comments.append(
                f"row {number} of the offset table, which T{rows[number].number} uses (H{number}, D{number})"
            )
            table.add("number", number)
            table.add("kind", "flat")
            table.add("diameter_mm", rows[number].diameter_mm)
            table.add("teeth", 2)
            table.add("flute_length_mm", max(1.0, rows[number].diameter_mm))
            if rows[number].number in self.wear:
                table.add("offset_radius_mm", 0.0)
            tables.append(table)
        return tables

    def _forces(self, tools: list[DraftTool]) -> bool:
        return self.given.material is not None and any(tool.cuts for tool in tools)

    def _cutting(self, tools: list[DraftTool]) -> dict[str, Any] | None:
        """Coefficients in the tools' own tables, where not all of them have any."""
        if self.given.material is None or all(tool.cuts for tool in tools):
            return None
        return {"material": find_material(self.given.material).name}

    def _cutting_tables(self, tools: list[DraftTool]) -> list[DraftTable]:
        table = DraftTable(name="cutting")
        if self.given.material is None:
            named = next((c for c in self.text.comments if _names_material(c.text)), None)
            hint = f"; the program names one in line {named.line}: {named.text}" if named is not None else ""
            self.notes.open.append(
                f"the program does not state cutting coefficients, so no forces are computed; give --material NAME "
                f"(twin materials lists the names){hint}"
            )
            table.comments.append("open: without a material, no forces are computed; twin materials lists the names")
            table.add("material", None)
        elif self._cutting(tools) is None:
            table.add("material", find_material(self.given.material).name)
        else:
            return []
        return [table]

    def _simulation_table(self, fine: Fineness) -> DraftTable:
        table = DraftTable(name="simulation")
        note = "" if fine.pitch_reason == "given" else f"assumed: {fine.pitch_reason}"
        table.add("slice_pitch_mm", fine.pitch_mm, note)
        table.add("step_mm", fine.pitch_mm)
        table.add(
            "angle_step_deg", fine.angle_deg, "" if fine.angle_reason == "given" else f"assumed: {fine.angle_reason}"
        )
        table.add("axial_step_mm", fine.axial_mm)
        if note:
            self.notes.assume("simulation", f"slice pitch and step {fine.pitch_mm:g} mm", fine.pitch_reason)
        if fine.angle_reason != "given":
            self.notes.assume("simulation", f"{fine.angle_deg:g} deg between force samples", fine.angle_reason)
        return table

    def _output_table(self) -> DraftTable:
        table = DraftTable(name="output")
        table.add("mcap", f"{self.file.stem}.mcap")
        return table


def _names_material(text: str) -> bool:
    name, _, value = text.upper().partition("=" if "=" in text else "-")
    return name.strip() == "MATERIAL" and bool(value.strip())
