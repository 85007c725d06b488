"""Variables of the macro languages as the interpreter reads and sets them: found by asking it for every number."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from gcode.dialects import Dialect
from gcode.events import Notice
from gcode.flow.session import Session
from gcode.flow.system_variables import SystemVariables
from gcode.language.expressions import EvaluationError
from gcode.language.program import program_of
from gcode.settings import MachineSettings

#: One more than the largest number that is tried.
NUMBERS_END = 30_000


@dataclass(frozen=True, slots=True)
class Access:
    """The effects of reading and of setting a variable, in words."""

    read: str
    write: str


NO_ACCESS = Access("refused", "refused")


@dataclass(frozen=True, slots=True)
class Row:
    """Variables of equal meaning.

    Attributes:
        text: their numbers as the page shows them.
        numbers: all of them.
        meaning: their contents.
    """

    text: str
    numbers: frozenset[int]
    meaning: str


def _row(meaning: str, *spans: tuple[int, int], step: int = 0, count: int = 1) -> Row:
    """A row of spans, both ends included; with a step they repeat `count` times."""
    numbers = {n + k * step for first, last in spans for n in range(first, last + 1) for k in range(count)}
    shown = [f"#{first}" if first == last else f"#{first}–#{last}" for first, last in spans]
    if step:
        (first, last), end = spans[0], (count - 1) * step
        shown += [f"#{first + step}–#{last + step}", "…", f"#{first + end}–#{last + end}"]
    return Row(", ".join(shown), frozenset(numbers), meaning)


FANUC_ROWS = (
    _row("always vacant", (0, 0)),
    _row("local variables of a macro call", (1, 33)),
    _row("common variables", (100, 199), (500, 999)),
    _row("length wear of tool offsets 1 to 200, older numbering; on Haas their length geometry", (2001, 2200)),
    _row("length geometry of tool offsets 1 to 200, older numbering; on Haas their length wear", (2201, 2400)),
    _row("raises an alarm: its number, with the comment as the message", (3000, 3000)),
    _row("clock and date", (3001, 3002), (3011, 3012)),
    _row("single-block control, feed control, settings, mirror image status", (3003, 3005), (3007, 3007)),
    _row("program stop, with the comment as the message", (3006, 3006)),
    _row("active code of modal groups 1 to 3, 5 to 11, 13 and 14", (4001, 4003), (4005, 4011), (4013, 4014)),
    _row("active code of modal groups 16, 17 and 22", (4016, 4017), (4022, 4022)),
    _row("active D, F and H", (4107, 4107), (4109, 4109), (4111, 4111)),
    _row("last block number (N), and program number (O)", (4114, 4115)),
    _row("active S and T, and number of the active additional work offset", (4119, 4120), (4130, 4130)),
    _row("end point of the previous block, program coordinates", (5001, 5003)),
    _row("current position, machine coordinates", (5021, 5023)),
    _row("current position with the active tool offset, program coordinates", (5041, 5043)),
    _row("active tool offset", (5081, 5083)),
    _row("external work offset; on Haas the shift of G52", (5201, 5203)),
    _row("work offsets G54 to G59", (5221, 5223), step=20, count=6),
    _row("additional work offsets G54.1 P1 to P48", (7001, 7003), step=20, count=48),
    _row("tool offsets 1 to 400, length wear; not on Haas", (10001, 10400)),
    _row("tool offsets 1 to 400, length geometry; not on Haas", (11001, 11400)),
    _row("tool offsets 1 to 400, radius wear; not on Haas", (12001, 12400)),
    _row(
        "tool offsets 1 to 400, radius geometry; not on Haas, where #2401–#2600 are radii and #2601–#2800 their wear",
        (13001, 13400),
    ),
    _row("additional work offsets G54.1 P1 to P300", (14001, 14003), step=20, count=300),
)
#: Variables that Haas has and FANUC has not.
HAAS_ROWS = (
    *(
        _row(f"the same as {same}", (first, last))
        for first, last, same in (
            (10100, 10199, "#100–#199"),
            (10500, 10599, "#500–#599"),
            (10600, 10699, "#600–#699"),
            (10800, 10999, "#800–#999"),
        )
    ),
    _row("further common variables", (10000, 10099), (10200, 10499), (10700, 10799)),
    _row("number of flutes, and largest vibration, of tools 1 to 200; counts as 0", (1601, 2000)),
    _row("radius of tool offsets 1 to 200, and its wear", (2401, 2800)),
    _row("timers of the machine; count as 0", (3020, 3025)),
    _row("measured diameters, and positions of the coolant spigot, of tools 1 to 200; count as 0", (3201, 3600)),
    _row("counts of M30; count as 0", (3901, 3902)),
    _row("feed timers of tools 1 to 100; count as 0", (5401, 5500)),
    _row("total timers of tools 1 to 100; count as 0", (5501, 5600)),
    _row("limits and counters of the tool life monitor; count as 0", (5601, 5800)),
    _row("largest loads of tools, and limits of the tool load monitor; count as 0", (5801, 6000)),
)
#: Variables that FANUC has and Haas has not.
_NOT_HAAS = (range(11001, 11401), range(12001, 12401), range(13001, 13401), range(10001, 10401))
_LINUXCNC_KNOWN = (
    _row("arguments and local variables of a subroutine", (1, 30)),
    _row("free for the program", (31, 5000)),
    _row("reference point of G28, X Y Z", (5161, 5163)),
    _row("the same, A B C U V W", (5164, 5169)),
    _row("reference point of G30, X Y Z", (5181, 5183)),
    _row("the same, A B C U V W", (5184, 5189)),
    _row("#5210 is 1 while a G92 offset is active; then its nine axes", (5210, 5219)),
    _row("active work offset, 1 for G54 to 9 for G59.3", (5220, 5220)),
    _row("work offsets G54 to G59.3: nine axes and the rotation about z, degrees", (5221, 5230), step=20, count=9),
    _row("number of the tool in the spindle", (5400, 5400)),
    _row("active tool offset, nine axes", (5401, 5409)),
    _row("diameter of the tool in the spindle", (5410, 5410)),
    _row("position in program coordinates, nine axes", (5420, 5428)),
    _row("always 0", (5411, 5419), (5429, 5429)),
)
LINUXCNC_ROWS = (
    *_LINUXCNC_KNOWN,
    Row(
        "all others of #5001–#5601",
        frozenset(range(5001, 5602)).difference(*(row.numbers for row in _LINUXCNC_KNOWN)),
        "no meaning: the value that the program stored, else 0 (#5599: 1)",
    ),
)


def access_of(dialect: Dialect, numbers: Iterable[int]) -> dict[int, Access]:
    """The effects of reading and setting each variable."""
    session = Session(program_of("", "variables"), dialect, MachineSettings(), SystemVariables)
    start = session.state
    found: dict[int, Access] = {}
    for number in numbers:
        read = _read(session, number)
        found[number] = Access(read, _write(session, number))
        session.state = start
        session.pending.clear()
    return found


def _read(session: Session, number: int) -> str:
    try:
        session.variables.number(number)
    except EvaluationError:
        return "refused"
    return "yes"


def _write(session: Session, number: int) -> str:
    before = session.state
    try:
        session.variables.set_number(number, 1.0)
    except EvaluationError as error:
        return "raises it" if error.code == "alarm" else "refused"
    if session.pending:
        return "no motion" if isinstance(session.pending[0], Notice) else "stops"
    if session.state is not before:
        return "takes effect"
    return "stored only" if number in session.stored else "yes"


def rows_of(dialect: Dialect) -> tuple[Row, ...]:
    """The rows of a dialect's macro language, none where it has no variables."""
    if not dialect.macro.operators:
        return ()
    if not dialect.macro.vacant:
        return LINUXCNC_ROWS
    if not dialect.counters:
        return FANUC_ROWS
    return (*(row for row in FANUC_ROWS if not any(min(row.numbers) in numbers for numbers in _NOT_HAAS)), *HAAS_ROWS)


def described(dialect: Dialect) -> Iterator[tuple[Row, Access]]:
    """The rows, each with what becomes of its variables.

    Raises:
        ValueError: where the variables of a row differ in that.
    """
    access = access_of(dialect, sorted({n for row in rows_of(dialect) for n in row.numbers}))
    for row in rows_of(dialect):
        kinds = {access[number] for number in row.numbers}
        if len(kinds) != 1:
            raise ValueError(f"{row.text} are read and set in different ways: {sorted(map(str, kinds))}")
        yield row, kinds.pop()
