"""The control that a program is for, and the machine at its start; this module needs no command-line library."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gcode.dialects import Dialect
    from gcode.settings import MachineSettings


@dataclass(frozen=True, slots=True, kw_only=True)
class Setup:
    """Dialect and machine settings, from the options.

    Attributes:
        dialect: the control; ``auto`` for the one that the program fits best.
        settings: the machine.
    """

    dialect: Dialect | str
    settings: MachineSettings

    @property
    def control(self) -> Dialect:
        """The dialect, once it is known."""
        from gcode.dialects import dialect_named

        return dialect_named(self.dialect) if isinstance(self.dialect, str) else self.dialect

    def for_program(self, file: Path | None) -> Setup:
        """The setup for one program: with its dialect, where that is to be found; which, and why, is printed."""
        if file is None or not isinstance(self.dialect, str):
            return self
        from gcode.cli.console import say
        from gcode.flow.interpreter import taken_dialect
        from gcode.language.program import read_program

        dialect, notice = taken_dialect(read_program(file), self.dialect)
        if notice is not None:
            say(f"{file}: {notice.text}", error=True)
        return replace(self, dialect=dialect)
