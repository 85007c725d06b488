"""Where each rule of a dialect comes from: the control's source code, its manual, its own interpreter, or nowhere yet.

Keys are fields of `Dialect`. A field that is missing for a dialect has no source at hand: it is what programs and users
of that control suggest, and the reference page says so.
"""

from __future__ import annotations

from collections.abc import Mapping

#: What the reference page shows for a rule without a source.
NO_SOURCE = "no source at hand"
_RS274 = "measured with LinuxCNC's `rs274` 2.9"
_TYPE = "not on this control"


def _grbl(place: str) -> str:
    return f"GRBL 1.1, gcode.c, {place}"


def _linuxcnc(place: str) -> str:
    return f"LinuxCNC, src/emc/rs274ngc, {place}; {_RS274}"


def _fanuc(chapter: str) -> str:
    return f"operator's manual, chapter {chapter!r}, from memory: manual not at hand, page not checked"


def _haas(chapter: str) -> str:
    return f"mill operator's manual, {chapter}, from memory: manual not at hand, page not checked"


_HAAS_VARIABLES = "table of Haas system variables at zappettiniconsulting.com/wiki, a third party's"
_VALUES = _grbl("step 2, value words")
_MOTION = _grbl("step 3, [20. Motion modes]")

#: Source of each field of each dialect.
SOURCES: Mapping[str, Mapping[str, str]] = {
    "fanuc": {
        "whole_letters": _fanuc("Custom macro"),
        "increment_letters": _fanuc("Decimal point programming"),
        "corner_letters": _fanuc("Optional chamfering and corner R"),
        "compensation": _fanuc("Cutter compensation"),
        "compensation_defaults_to_tool": _fanuc("Cutter compensation"),
        "packed_calls": _fanuc("Subprogram"),
        "subprograms": _fanuc("Subprogram"),
        "dwell": _fanuc("Dwell (G04)"),
        "length_word_is_modal": _fanuc("Tool length offset"),
        "machine_moves_rapid": _fanuc("Machine coordinate system (G53)"),
        "machine_move_incremental": _fanuc("Machine coordinate system (G53)"),
        "additional_by_l20": _fanuc("Addition of workpiece coordinate system pair"),
        "additional_offsets": _fanuc("Addition of workpiece coordinate system pair"),
        "tool_variables": _fanuc("Custom macro, system variables"),
        "common_shift_variables": _fanuc("Custom macro, system variables"),
        "first_alarm": _fanuc("Custom macro, system variables"),
        "helix_feed_along_arc": _fanuc("Helical interpolation"),
        "semicolon_ends_block": _fanuc("Program configuration"),
        "leader": _fanuc("Program configuration"),
        "same_group": _fanuc("Preparatory function (G function)"),
    },
    "haas": {
        "tool_variables": _HAAS_VARIABLES,
        "second_variable_names": _HAAS_VARIABLES,
        "further_variables": _HAAS_VARIABLES,
        "counters": _HAAS_VARIABLES,
        "common_shift_variables": _HAAS_VARIABLES,
        "dwell": _haas("G04"),
        "additional_offsets": _haas("G154"),
        "additional_by_l20": _haas("G10"),
        "machine_moves_rapid": _haas("G53"),
        "reference_all_axes": _haas("G28"),
        "reference_cancels_length": _haas("G28"),
        "first_alarm": _haas("macros, #3000"),
        "same_group": "alarm 339 (multiple codes), from memory: list of alarms not at hand",
        "semicolon_ends_block": "VF series operator's manual 96-8000, June 1999, page 115",
        "leader": "VF series operator's manual 96-8000, June 1999, page 115 (DC codes around a program)",
    },
    "linuxcnc": {
        **dict.fromkeys(
            (
                *("extra_axes", "whole_block_numbers", "power_on_motion", "compensation", "not_compensated"),
                *("compensation_defaults_to_tool", "additional_by_l20", "tool_defaults_to_present", "subprograms"),
                *("explicit_code_moves", "power_on_return_to_r", "tools_must_be_known", "dwell", "file_end_returns"),
                *("length_word_is_modal", "length_defaults_to_tool", "length_moves_all_axes"),
                *("incremental_adds_length", "machine_moves_rapid", "reference_all_axes", "reference_cancels_length"),
                *("helix_feed_along_arc", "shift_is_rotated", "semicolon_ends_block", "leader"),
                *("common_shift_variables", "needs_axis_words", "packed_calls", "centre_words_of_plane"),
                *("whole_letters", "additional_offsets"),
            ),
            _RS274,
        ),
        "arc_tolerance": _linuxcnc(
            "interp_internal.hh: CENTER_ARC_RADIUS_TOLERANCE_MM and _INCH, SPIRAL_RELATIVE_TOLERANCE"
        ),
        "radius_tolerance_mm": _linuxcnc("interp_internal.hh: RADIUS_TOLERANCE_INCH"),
        "machine_move_incremental": _linuxcnc("interp_check.cc: check_g_codes"),
        "same_group": _linuxcnc("interp_internal.hh: ModalGroups"),
        "one_shot_with_motion": _linuxcnc("NCE_CANNOT_USE_TWO_G_CODES_THAT_BOTH_USE_AXIS_VALUES"),
        "corner_letters": _TYPE,
        "still_axes": _TYPE,
        "first_alarm": _TYPE,
        "tool_variables": _TYPE,
        "second_variable_names": _TYPE,
        "further_variables": _TYPE,
        "counters": _TYPE,
        "tool_word_changes": _RS274,
        "senders_text": _RS274,
        "dollar_commands": _RS274,
    },
    "grbl": {
        "extra_axes": _grbl("step 2: A, B, C are not supported"),
        "whole_block_numbers": _grbl("step 2: N is truncated"),
        "power_on_motion": _grbl("gc_init: all modes 0, MOTION_MODE_SEEK"),
        "power_on_return_to_r": _TYPE,
        "corner_letters": _TYPE,
        "increment_letters": _TYPE,
        "whole_letters": _TYPE,
        "compensation": _TYPE,
        "not_compensated": _TYPE,
        "compensation_defaults_to_tool": _TYPE,
        "additional_by_l20": _grbl("step 3, [19. Remaining non-modal actions], G10 L20"),
        "additional_offsets": _TYPE,
        "tool_defaults_to_present": _TYPE,
        "tools_must_be_known": _TYPE,
        "file_end_returns": _TYPE,
        "subprograms": _TYPE,
        "packed_calls": _TYPE,
        "explicit_code_moves": _MOTION,
        "dwell": _grbl("step 3, [10. Dwell]; mc_dwell"),
        "length_word_is_modal": _TYPE,
        "length_defaults_to_tool": _TYPE,
        "length_moves_all_axes": _grbl("step 3, [14. Cutter length compensation]"),
        "incremental_adds_length": _grbl("step 3: incremental targets add to the position alone"),
        "one_shot_with_motion": _grbl("step 2: STATUS_GCODE_AXIS_COMMAND_CONFLICT, error 24"),
        "machine_moves_rapid": _grbl("step 3: STATUS_GCODE_G53_INVALID_MOTION_MODE"),
        "machine_move_incremental": _grbl("step 3: NON_MODAL_ABSOLUTE_OVERRIDE before the distance mode"),
        "reference_all_axes": _grbl("step 3, G28 without axis words"),
        "reference_cancels_length": _grbl("step 4, NON_MODAL_GO_HOME"),
        "helix_feed_along_arc": _grbl("step 4, mc_arc"),
        "shift_is_rotated": _grbl("step 3: G10 L2 R is not supported"),
        "semicolon_ends_block": "GRBL 1.1, protocol.c, protocol_main_loop",
        "leader": "GRBL 1.1, protocol.c, protocol_main_loop",
        "arc_tolerance": f"{_MOTION}: delta_r, error 33",
        "radius_tolerance_mm": f"{_MOTION}: h_x2_div_d below 0, error 34",
        "centre_words_of_plane": f"{_MOTION}: ijk_words; without a word of the plane error 35",
        "needs_axis_words": f"{_MOTION}: STATUS_GCODE_NO_AXIS_WORDS, error 26 and 27",
        "same_group": _grbl("step 2: STATUS_GCODE_MODAL_GROUP_VIOLATION, error 21"),
        "still_axes": _grbl("step 2: A, B, C are not supported"),
        "tool_word_changes": _grbl("step 3, [5. Select tool]: only tracked; [6. Change tool]: none"),
        "senders_text": f"{_VALUES}: O is error 20; protocol.c: % is not installed, error 1",
        "dollar_commands": "GRBL 1.1, protocol.c, protocol_main_loop",
        "most_characters": "GRBL 1.1, protocol.h: LINE_BUFFER_SIZE 80; protocol.c: error 11",
        "largest_tool": _grbl("MAX_TOOL_NUMBER, error 38"),
        "largest_block_number": _grbl("MAX_LINE_NUMBER, error 27"),
        "common_shift_variables": _TYPE,
        "first_alarm": _TYPE,
        "tool_variables": _TYPE,
        "second_variable_names": _TYPE,
        "further_variables": _TYPE,
        "counters": _TYPE,
    },
}
