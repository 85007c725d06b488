"""The search for subprograms: in the calling file, then in the files of a search path."""

from __future__ import annotations

from pathlib import Path

from gcode.language.program import Program, Spot, read_program

_ENDINGS = ("", ".nc", ".NC", ".ngc", ".NGC", ".txt", ".TXT", ".cnc", ".CNC", ".tap", ".TAP", ".prg", ".PRG")


class Library:
    """Finds subprograms in the calling file, then in the files of a search path. Files are read once."""

    def __init__(self, search_path: tuple[Path, ...]) -> None:
        self._search_path = search_path
        self._read: dict[Path, Program] = {}

    def numbered(self, caller: Program, number: int) -> tuple[Program, Spot] | None:
        """Program O`number`: the file that holds it, and its first line."""
        if number in caller.programs:
            return caller, caller.programs[number]
        names = [f"O{number:04d}", f"O{number}", f"o{number:04d}", f"o{number}", f"{number:04d}", f"{number}"]
        program = self._file(caller, [name + ending for ending in _ENDINGS for name in names])
        return None if program is None else (program, program.programs.get(number, Spot(0, 1)))

    def routine(self, caller: Program, label: str) -> tuple[Program, Spot] | None:
        """Subroutine o<label>: the file that holds it, and its ``sub`` line."""
        if label in caller.subroutines:
            return caller, caller.subroutines[label]
        program = self._file(caller, [f"{label}.ngc", f"{label}.NGC"])
        if program is None or label not in program.subroutines:
            return None
        return program, program.subroutines[label]

    def _file(self, caller: Program, names: list[str]) -> Program | None:
        folders = ([caller.folder] if caller.folder else []) + list(self._search_path)
        for folder in folders:
            for name in names:
                path = folder / name
                if path in self._read:
                    return self._read[path]
                if "/" not in name and _is_file(path):
                    self._read[path] = read_program(path)
                    return self._read[path]
        return None


def _is_file(path: Path) -> bool:
    """True for a file; a name that no file can have, or a folder that may not be looked into, holds none."""
    try:
        return path.is_file()
    except OSError:
        return False
