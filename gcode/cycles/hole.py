"""The levels of one hole, its pecks, its dwell and its shift: the data of its strokes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from gcode.cycles.errors import CycleError
from gcode.cycles.interface import CycleInput
from gcode.cycles.rules import Cycle, CycleRules
from gcode.cycles.words import BOTTOM, INCREMENTAL

#: Steps of one block, and pecks of one hole, beyond which a cycle is refused as one that runs away.
MOST_STEPS = 1_000_000

#: Letter of the offset along each axis.
_OFFSET_OF_AXIS = {"X": "I", "Y": "J", "Z": "K"}


@dataclass(frozen=True, slots=True, kw_only=True)
class Hole:
    """One hole; levels are coordinates along the plane's normal, mm.

    Attributes:
        r: level of point R.
        bottom: level of point Z; for FANUC's back boring, the top of the bore.
        clear: level that the cycle returns to.
        top: top of LinuxCNC's back bore.
        depths: levels of the pecks above the bottom, the first one first.
        cleared_every: depth after which a chip-breaking peck goes out to R, None where it never does.
        dwell_s: dwell, 0 for none.
        shift: shift along the plane's first and second axis.
    """

    r: float
    bottom: float
    clear: float
    top: float
    depths: tuple[float, ...]
    cleared_every: float | None
    dwell_s: float
    shift: tuple[float, float]


def hole_of(rules: CycleRules, cycle: Cycle, call: CycleInput, data: Mapping[str, float]) -> Hole:
    """The hole that the words describe.

    Raises:
        CycleError: where R lies below the bottom and the control refuses that, or a peck has no depth.
    """
    r = _level(rules, call, data, "R", call.initial_level) if "R" in data else call.initial_level
    bottom = _level(rules, call, data, BOTTOM, r)
    if rules.refuses_r_below_bottom and r < bottom:
        normal = call.axes[2]
        raise CycleError(
            "cycle-level", f"R at {r:g} mm lies below the bottom {normal}{bottom:g} mm", "R above the bottom", "R"
        )
    initial = max(call.initial_level, r) if rules.lift_first else call.initial_level
    return Hole(
        r=r,
        bottom=bottom,
        clear=r if call.return_to_r and not cycle.returns_to_initial else initial,
        top=_top(call, data, bottom),
        depths=_depths(rules, call, data, r, bottom) if cycle.pecks else (),
        cleared_every=data["K"] if "K" in cycle.takes and "K" in data and "I" not in data else None,
        dwell_s=data.get("P", 0.0) if "P" in cycle.takes else 0.0,
        shift=_shift(rules, cycle, call, data) if cycle.shift else (0.0, 0.0),
    )


def _level(rules: CycleRules, call: CycleInput, data: Mapping[str, float], key: str, base: float) -> float:
    incremental = bool(data[key + INCREMENTAL]) if rules.levels_keep_mode else not call.absolute
    return base + data[key] if incremental else data[key]


def _top(call: CycleInput, data: Mapping[str, float], bottom: float) -> float:
    """The offset along the normal: a coordinate with G90, from the bottom with G91."""
    value = data.get(_OFFSET_OF_AXIS[call.axes[2]], 0.0)
    return value if call.absolute else bottom + value


def _shift(rules: CycleRules, cycle: Cycle, call: CycleInput, data: Mapping[str, float]) -> tuple[float, float]:
    if "Q" in cycle.takes and "Q" in data:
        first, second = rules.shift_direction
        return (first * abs(data["Q"]), second * abs(data["Q"]))
    first_axis, second_axis, _ = call.axes
    return (data.get(_OFFSET_OF_AXIS[first_axis], 0.0), data.get(_OFFSET_OF_AXIS[second_axis], 0.0))


def _depths(
    rules: CycleRules, call: CycleInput, data: Mapping[str, float], r: float, bottom: float
) -> tuple[float, ...]:
    """Levels of all pecks but the last; summed in the program's unit, as the control does."""
    size, less, least = _peck(rules, data)
    unit = call.unit_mm
    down = -1.0 if bottom <= r else 1.0
    level, end = _in_unit(r, unit), _in_unit(bottom, unit)
    size, less, least = _in_unit(size, unit), _in_unit(less, unit), _in_unit(least, unit)
    depths: list[float] = []
    level += down * size
    while (end - level) * down > rules.peck_tolerance_mm / unit:
        depths.append(level * unit)
        if len(depths) > MOST_STEPS:
            raise CycleError("cycle-peck", f"more than {MOST_STEPS} pecks to the bottom", "a larger peck", "Q")
        size = max(size - less, least)
        level += down * size
    return tuple(depths)


def _peck(rules: CycleRules, data: Mapping[str, float]) -> tuple[float, float, float]:
    """Size of the first peck, by how much each is smaller than the one before, and the smallest size."""
    if "I" in data:
        peck = (data["I"], data.get("J", 0.0), data.get("K", data["I"] if not data.get("J") else 0.0))
        if min(peck[0], peck[2]) <= 0.0 or peck[1] < 0.0:
            problem = f"pecks from I{peck[0]:g}, less J{peck[1]:g} each, down to K{peck[2]:g} mm never end"
            raise CycleError("cycle-peck", problem, "I and K greater than 0, J not below 0", "I")
        return peck
    size = abs(data["Q"]) if rules.ignores_sign_of_q else data["Q"]
    if size <= 0.0:
        raise CycleError("cycle-peck", f"Q{data['Q']:g} is not a peck depth", "Q greater than 0", "Q")
    return (size, 0.0, size)


def _in_unit(length_mm: float, unit_mm: float) -> float:
    """A length in the program's unit, without the last digits that its conversion to mm cost."""
    return length_mm if unit_mm == 1.0 else round(length_mm / unit_mm, 12)
