"""LinuxCNC's parameter file (``.var``): a number and its value per line.

| parameters | hold |
| --- | --- |
| 5161 to 5169 | reference point of G28: X Y Z A B C U V W |
| 5181 to 5189 | second reference point, of G30 |
| 5210 to 5219 | 1 where G92 offsets hold, and those offsets |
| 5220 | active coordinate system, 1 for G54 to 9 for G59.3 |
| 5221 to 5230 | offset and rotation about Z (degrees) of G54; those of the next system are 20 further on, and so on |

Lengths in the file are in the machine's unit.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType

from gcode.errors import Place
from gcode.events import Point
from gcode.settings import NUMBERED_OFFSETS, MachineSettings
from gcode.tables.text_file import MM_PER_UNIT, Unit, error_at, lines_of, number_at, read_text, token_at

#: One more than the largest parameter.
PARAMETERS_END = 5602

_HOME, _SECOND_REFERENCE, _G92_HOLDS, _ACTIVE, _FIRST_SYSTEM, _NEXT_SYSTEM, _ROTATION = (
    5161,
    5181,
    5210,
    5220,
    5221,
    20,
    9,
)
_WHOLE = re.compile(r"\s*([+-]?\d+)(?=\s|$)\s*")
_LINE = "a parameter number and its value, such as 5221 1.5"


@dataclass(frozen=True, slots=True, kw_only=True)
class ParameterFile:
    """The contents of a parameter file. Lengths are mm, except in `variables`.

    Attributes:
        variables: all parameters of the file by number, as written: lengths in the machine's unit.
        offsets: positions of the nine work zeros, 0 where the file has none.
        rotations_deg: rotation of each about z, counter-clockwise.
        home_mm: gauge point of G28.
        reference_points_mm: gauge point of G30, by the number 2.
        wcs: name of the coordinate system that is active.
        g92_mm: offset by G92, as stored.
        g92_holds: True where it is in effect.
    """

    variables: Mapping[int, float]
    offsets: Mapping[str, Point]
    rotations_deg: Mapping[str, float]
    home_mm: Point
    reference_points_mm: Mapping[int, Point]
    wcs: str
    g92_mm: Point
    g92_holds: bool

    def applied_to(self, settings: MachineSettings) -> MachineSettings:
        """The settings with the values of the file in place of theirs; variables that it does not list are kept."""
        return replace(
            settings,
            offsets=self.offsets,
            rotations_deg=self.rotations_deg,
            wcs=self.wcs,
            shift_mm=self.g92_mm if self.g92_holds else (0.0, 0.0, 0.0),
            home_mm=self.home_mm,
            reference_points_mm={**settings.reference_points_mm, **self.reference_points_mm},
            variables={**settings.variables, **self.variables},
        )


def read_parameters(path: Path | str, units: Unit = "mm") -> ParameterFile:
    """Reads a parameter file.

    Args:
        path: a ``.var`` file.
        units: the machine's unit of length, which the file is in.

    Raises:
        GcodeError: for a file that cannot be read, a line without a number and a value (``parameter-line``), a number
            outside the parameters (``parameter-number``), a parameter given twice (``parameter-duplicate``), and an
            active system other than 1 to 9 (``parameter-system``).
    """
    path = Path(path)
    values: dict[int, float] = {}
    places: dict[int, Place] = {}
    for place in lines_of(path, read_text(path, (".var",))):
        if not place.text.strip() or place.text.lstrip()[0] in "#;":
            continue
        number, value = _line(place)
        if number in values:
            problem = f"parameter {number} is given twice, first in line {places[number].line}"
            raise error_at(place, 0, "parameter-duplicate", problem, "each parameter once")
        values[number], places[number] = value, place
    _check_active(values, places)
    return _file(values, MM_PER_UNIT[units])


def _line(place: Place) -> tuple[int, float]:
    """Number and value of one line."""
    found = _WHOLE.match(place.text)
    if found is None:
        problem = f"{token_at(place.text, 0)!r} at the start of a line"
        raise error_at(place, len(place.text) - len(place.text.lstrip()), "parameter-line", problem, _LINE)
    number = int(found[1]) if len(found[1]) < 12 else -1
    if not 0 < number < PARAMETERS_END:
        problem = f"parameter {token_at(place.text, 0)}"
        raise error_at(place, found.start(1), "parameter-number", problem, f"a number of 1 to {PARAMETERS_END - 1}")
    value, end = number_at(place, found.end(), f"parameter {number}", "parameter-line")
    rest = place.text[end:].lstrip()
    if rest and (rest[0] not in "#;"):
        problem = f"{token_at(place.text, end)!r} after the value of parameter {number}"
        raise error_at(place, len(place.text) - len(rest), "parameter-line", problem, _LINE)
    return number, value


def _check_active(values: Mapping[int, float], places: Mapping[int, Place]) -> None:
    active = values.get(_ACTIVE, 1.0)
    if active not in range(1, len(NUMBERED_OFFSETS) + 1):
        problem = f"parameter {_ACTIVE}, the active coordinate system, is {active:g}"
        raise error_at(places[_ACTIVE], 0, "parameter-system", problem, f"1 to {len(NUMBERED_OFFSETS)} (G54 to G59.3)")


def _file(values: Mapping[int, float], unit_mm: float) -> ParameterFile:
    def point(first: int) -> Point:
        x, y, z = (values.get(first + axis, 0.0) * unit_mm for axis in range(3))
        return (x, y, z)

    firsts = {name: _FIRST_SYSTEM + _NEXT_SYSTEM * n for n, name in enumerate(NUMBERED_OFFSETS)}
    return ParameterFile(
        variables=MappingProxyType(dict(values)),
        offsets=MappingProxyType({name: point(first) for name, first in firsts.items()}),
        rotations_deg=MappingProxyType({n: values.get(first + _ROTATION, 0.0) for n, first in firsts.items()}),
        home_mm=point(_HOME),
        reference_points_mm=MappingProxyType({2: point(_SECOND_REFERENCE)}),
        wcs=NUMBERED_OFFSETS[int(values.get(_ACTIVE, 1.0)) - 1],
        g92_mm=point(_G92_HOLDS + 1),
        g92_holds=values.get(_G92_HOLDS, 0.0) != 0.0,
    )
