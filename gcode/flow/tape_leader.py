"""A leader: text before the first percent sign of a file that is not part of the program."""

from __future__ import annotations

from gcode.dialects import Dialect
from gcode.errors import GcodeError, Place
from gcode.language.block_parser import parse_line
from gcode.language.program import Program, Spot

#: Lines that are searched for the percent sign that ends a leader.
LEADER_LINES = 200


def leader_end(program: Program, dialect: Dialect) -> Spot | None:
    """Finds the beginning of the program after a leader: the line of the percent sign; None where there is no leader.

    A percent sign ends a leader where more text follows it and none of the lines before it, read as a block, holds a
    word; otherwise it is the end of the program.
    """
    if not dialect.leader:
        return None
    before: list[Place] = []
    offset = 0
    for line in range(1, LEADER_LINES + 1):
        if offset >= program.size:
            return None
        text, following = program.line_at(offset)
        if text.lstrip().startswith("%"):
            more = program.text[following : following + 65536].strip()
            found = any(place.text.strip() for place in before) and more and not _is_program(before, dialect)
            return Spot(offset, line) if found else None
        before.append(Place(file=program.file, line=line, text=text))
        offset = following
    return None


def _is_program(places: list[Place], dialect: Dialect) -> bool:
    """True where one of the lines reads as a block with words, or holds nothing but a comment throughout."""
    empty = True
    for place in places:
        try:
            if parse_line(place, dialect).words:
                return True
        except GcodeError:
            empty = False
    return empty
