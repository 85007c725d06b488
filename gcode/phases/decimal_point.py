"""FANUC's decimal point rule: numbers without a point count least input increments where a machine is set so."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from gcode.control.command import UNIT_CODES, code_name
from gcode.control.state import AXES, State
from gcode.cycles import Cycle
from gcode.events import PLANE_AXES
from gcode.language.blocks import ParsedBlock

#: Least input increment of a length, in inch programs and in mm programs.
_INCH_INCREMENT, _MM_INCREMENT = 0.0001, 0.001
#: Seconds and degrees have one of their own, whatever unit lengths have.
_OTHER_INCREMENT = 0.001
#: Letters that are not lengths in a block with a code, with their unit. A scale factor's is read by G51 itself.
_OWN_INCREMENTS: Mapping[str, Mapping[str, float]] = {
    "G4": {"X": _OTHER_INCREMENT},
    "G51": {"I": 1.0, "J": 1.0, "K": 1.0},
    "G68": {"R": _OTHER_INCREMENT},
}
_ARCS_AND_LINES = frozenset({"G0", "G1", "G2", "G3"})


def in_increments(state: State, block: ParsedBlock) -> ParsedBlock:
    """The block with the numbers that have no decimal point as lengths in the program's unit.

    Args:
        state: the control before the block; its machine determines whether anything changes.
        block: its words are plain numbers.
    """
    letters = state.control.dialect.increment_letters
    if state.control.settings.decimal_point != "increment" or not letters:
        return block
    codes = {code_name("G", word.value) for word in block.words if word.letter == "G"}
    own = _own_increments(state, codes)
    increment = _INCH_INCREMENT if _is_inch(state, codes) else _MM_INCREMENT
    words = tuple(
        word._replace(value=word.value * own.get(word.letter, increment))
        if word.letter in letters and not word.has_point
        else word
        for word in block.words
    )
    return replace(block, words=words)


def _is_inch(state: State, codes: set[str]) -> bool:
    if state.control.settings.g70_units:
        codes = {UNIT_CODES.get(code, code) for code in codes}
    if codes & {"G20", "G21"}:
        return "G20" in codes
    return state.modes.unit_mm != 1.0


def _own_increments(state: State, codes: set[str]) -> dict[str, float]:
    """Units of the letters that are not lengths in a block with these codes."""
    own = {letter: unit for code in codes for letter, unit in _OWN_INCREMENTS.get(code, {}).items()}
    cycles = state.control.dialect.cycles
    if cycles is not None and _motion(state, codes, cycles.cycles) in cycles.cycles:
        own.update(dict.fromkeys(cycles.repeat_letters, 1.0))
    if state.modes.polar or "G16" in codes:
        own[AXES[PLANE_AXES[state.machine.plane][1]]] = _OTHER_INCREMENT
    return own


def _motion(state: State, codes: set[str], cycles: Mapping[str, Cycle]) -> str:
    """The motion code or cycle that holds in the block."""
    named = codes.intersection(cycles) or codes.intersection(_ARCS_AND_LINES)
    return min(named, default=state.modes.motion)
