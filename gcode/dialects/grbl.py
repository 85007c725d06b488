"""GRBL 1.1: a controller without macros, cycles, cutter compensation and tool changes."""

from __future__ import annotations

from dataclasses import replace

from gcode.cycles import FANUC_CYCLES
from gcode.dialects.codes import COMMON, Table, cycle_meanings, executed, neutral, noticed, owning, refused
from gcode.dialects.dialect import ArcTolerance
from gcode.dialects.linuxcnc import LINUXCNC
from gcode.dialects.macro_language import NO_MACRO

CODES: Table = {
    **{code: rule for code, rule in COMMON.items() if code not in ("G43", "G40", "G90.1")},
    **executed("motion-cancel", "modes", {"G80": "motion cancel"}),
    **executed("one-shot", "dwell", {"G4": "dwell"}, "P"),
    **executed("one-shot", "reference", {"G28.1": "store the reference point"}),
    **executed("one-shot", "reference", {"G30.1": "store the second reference point"}),
    **owning("one-shot", "reference", {"G30": "return to the second reference point"}, "XYZ"),
    **executed("one-shot", "shift", {"G92.1": "cancel the G92 offset and clear it"}),
    **owning("length", "length", {"G43.1": "dynamic tool length offset"}, "Z"),
    **neutral("compensation", {"G40": "cutter compensation cancel"}),
    **owning("length", "length", {"G49": "tool length offset cancel"}, ""),
    **executed("coolant", "coolant_on", {"M8": "flood coolant"}),
    **executed("coolant", "coolant_on", {"M7": "mist coolant"}, option="ENABLE_M7"),
    **executed("coolant", "coolant_off", {"M9": "coolant off"}),
    **noticed("path", {"G61": "exact path"}),
    **noticed("override", {"M56": "parking motion override"}, "P", option="ENABLE_PARKING_OVERRIDE_CONTROL"),
    **refused("motion", {f"G38.{n}": "probing: its end depends on a measurement" for n in (2, 3, 4, 5)}),
    **refused("motion", cycle_meanings(FANUC_CYCLES)),
    **refused("tool-change", {"M6": "tool change"}),
}

GRBL = replace(
    LINUXCNC,
    name="grbl",
    codes=CODES,
    refused_letters={letter: f"{letter} is an axis that GRBL does not have" for letter in "ABCUVW"},
    extra_axes="",
    power_on_motion="G0",
    power_on_return_to_r=False,
    tools_must_be_known=False,
    macro=NO_MACRO,
    cycles=None,
    order=(
        *("feed_mode", "modes", "feed", "speed", "tool", "spindle_on", "spindle_off", "coolant_on", "coolant_off"),
        *("notice", "dwell", "length", "work_offset", "data", "reference", "shift", "motion", "stop"),
    ),
    data_kinds={2: "zero", 20: "zero-here"},
    subprograms=False,
    length_moves_all_axes=False,
    shift_is_rotated=False,
    machine_move_incremental="absolute",
    arc_tolerance=ArcTolerance(absolute_mm=0.005, relative=0.001, most=100.0, of_start_radius=True),
    radius_tolerance_mm=0.0,
    centre_words_of_plane=False,
    needs_axis_words=True,
    tool_word_changes=True,
    senders_text="O%",
    dollar_commands=True,
    most_characters=79,
    largest_tool=255,
    largest_block_number=10_000_000,
)
