"""The findings of a check of one program."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from gcode.cli.setup import Setup
from gcode.errors import GcodeError, Place
from gcode.events import WARNINGS, Notice
from gcode.flow.interpreter import examine
from gcode.language.program import read_program
from gcode.report.motion_json import call_objects

#: Most lines that are listed for notices of equal text.
_MOST_LINES = 8


@dataclass(frozen=True, slots=True, kw_only=True)
class Findings:
    """The errors and notices of one file.

    Attributes:
        file: the program.
        errors: its errors in the order of the program.
        notices: its words that have no effect on motion.
        unreadable: the message for a file that cannot be read, None for one that can.
    """

    file: str
    errors: tuple[GcodeError, ...] = ()
    notices: tuple[Notice, ...] = ()
    unreadable: str | None = None

    def objects(self, *, notices: bool) -> Iterator[dict[str, Any]]:
        """The findings as JSON objects, errors first.

        Args:
            notices: include all notices, else warnings only.
        """
        for error in self.errors:
            yield {
                "severity": "error",
                **_place(error.place),
                "code": error.code,
                "problem": error.problem,
                "expected": error.expected,
                **_text_and_calls(error.place),
            }
        for notice in self.notices if notices else self.warnings:
            yield {
                "severity": "warning" if notice.is_warning else "notice",
                **_place(notice.place),
                "code": notice.code,
                "problem": notice.text,
                "expected": "",
                **_text_and_calls(notice.place),
            }

    @property
    def warnings(self) -> tuple[Notice, ...]:
        """The notices that are warnings."""
        return tuple(notice for notice in self.notices if notice.is_warning)

    def grouped(self, *, notices: bool) -> Iterator[str]:
        """The notices, or the warnings only, those of equal text as one, with their lines."""
        groups: dict[tuple[str, str, str], dict[int, None]] = {}
        for notice in self.notices if notices else self.warnings:
            groups.setdefault((notice.place.file, notice.code, notice.text), {})[notice.place.line] = None
        for (file, code, text), lines in groups.items():
            named = ", ".join(str(line) for line in list(lines)[:_MOST_LINES])
            more = f" and {len(lines) - _MOST_LINES} more" if len(lines) > _MOST_LINES else ""
            kind = "warning: " if code in WARNINGS else ""
            yield f"{file}: {kind}{text} [{code}], line{'s' if len(lines) > 1 else ''} {named}{more}"


def findings(file: Path, setup: Setup) -> Findings:
    """Checks a program."""
    try:
        program = read_program(file)
    except GcodeError as error:
        return Findings(file=str(file), unreadable=str(error))
    errors, notices = examine(program, dialect=setup.dialect, settings=setup.settings)
    return Findings(file=str(file), errors=tuple(errors), notices=tuple(notices))


def _place(place: Place) -> dict[str, Any]:
    return {"file": place.file, "line": place.line, "column": place.column}


def _text_and_calls(place: Place) -> dict[str, Any]:
    return {"text": place.text, "calls": call_objects(place.calls)}
