"""All that a check finds in one program."""

from __future__ import annotations

import contextlib
import errno
import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from gcode.cli.machine_options import Setup
from gcode.errors import GcodeError, Place
from gcode.events import Notice
from gcode.flow.interpreter import check, run
from gcode.language.program import Program, read_program
from gcode.report.motion_json import call_objects

#: So many lines of a notice's group are named.
_MOST_LINES = 8


@dataclass(frozen=True, slots=True, kw_only=True)
class Findings:
    """What a check says about one file.

    Attributes:
        file: the program.
        errors: its mistakes in the order of the program.
        notices: its words without effect on motion.
        unreadable: why the file cannot be read, None where it can.
    """

    file: str
    errors: tuple[GcodeError, ...] = ()
    notices: tuple[Notice, ...] = ()
    unreadable: str | None = None

    def objects(self, *, notices: bool) -> Iterator[dict[str, Any]]:
        """The diagnostics as JSON objects, those of mistakes first.

        Args:
            notices: tell notices too.
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
        for notice in self.notices if notices else ():
            yield {
                "severity": "notice",
                **_place(notice.place),
                "code": notice.code,
                "problem": notice.text,
                "expected": "",
                **_text_and_calls(notice.place),
            }

    def grouped(self) -> Iterator[str]:
        """The notices, those that say the same as one, with the lines they stand in."""
        groups: dict[tuple[str, str, str], dict[int, None]] = {}
        for notice in self.notices:
            groups.setdefault((notice.place.file, notice.code, notice.text), {})[notice.place.line] = None
        for (file, code, text), lines in groups.items():
            named = ", ".join(str(line) for line in list(lines)[:_MOST_LINES])
            more = f" and {len(lines) - _MOST_LINES} more" if len(lines) > _MOST_LINES else ""
            yield f"{file}: {text} [{code}], line{'s' if len(lines) > 1 else ''} {named}{more}"


def findings(file: Path, setup: Setup) -> Findings:
    """Checks a program."""
    reason = _unreadable(file)
    if reason is not None:
        return Findings(file=str(file), unreadable=f"{file}: {reason}")
    program = read_program(file)
    errors = check(program, dialect=setup.dialect, settings=setup.settings)
    return Findings(file=str(file), errors=tuple(errors), notices=tuple(_notices(program, setup)))


def _notices(program: Program, setup: Setup) -> Iterator[Notice]:
    """The notices of a program up to its first mistake."""
    with contextlib.suppress(GcodeError):
        for event in run(program, dialect=setup.dialect, settings=setup.settings):
            if isinstance(event, Notice):
                yield event


def _unreadable(file: Path) -> str | None:
    """Why a file cannot be read, None where it can."""
    if file.is_dir():
        return os.strerror(errno.EISDIR)
    if not file.exists():
        return os.strerror(errno.ENOENT)
    return None if os.access(file, os.R_OK) else os.strerror(errno.EACCES)


def _place(place: Place) -> dict[str, Any]:
    return {"file": place.file, "line": place.line, "column": place.column}


def _text_and_calls(place: Place) -> dict[str, Any]:
    return {"text": place.text, "calls": call_objects(place.calls)}
