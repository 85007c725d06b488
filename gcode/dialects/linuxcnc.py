"""LinuxCNC 2.9 (RS274/NGC)."""

from __future__ import annotations

from gcode.cycles import LINUXCNC_CYCLES
from gcode.dialects.codes import FULL, Table, executed, noticed, owning, refused
from gcode.dialects.dialect import ArcTolerance, Dialect, DwellWord
from gcode.dialects.macro_language import LINUXCNC_MACRO

_ALL = "XYZABC"
#: Axis words of a motion, and the polar ones.
_TARGET = _ALL + "@^"
_DRILLING = {code: cycle.meaning for code, cycle in LINUXCNC_CYCLES.cycles.items()}

CODES: Table = {
    **FULL,
    **executed("motion", "modes", {"G0": "rapid positioning", "G1": "straight feed"}, _TARGET),
    **executed("motion", "modes", {"G2": "clockwise arc", "G3": "counter-clockwise arc"}, _TARGET + "IJKRP"),
    **executed("motion", "modes", _DRILLING, "XYZ@^RQPLIJK"),
    **executed("motion", "modes", {"G5": "cubic spline"}, "XYIJPQ"),
    **executed("motion", "modes", {"G5.1": "quadratic spline"}, "XYIJ"),
    **executed("motion", "modes", {"G33": "spindle-synchronised motion"}, "XYZK"),
    **executed("motion", "modes", {"G33.1": "rigid tapping"}, "XYZKI"),
    **executed("motion-cancel", "modes", {"G80": "motion cancel"}),
    **executed("one-shot", "dwell", {"G4": "dwell"}, "P"),
    **executed("diameter", "modes", {"G7": "diameter mode", "G8": "radius mode"}),
    **owning("one-shot", "data", {"G10": "offset data setting"}, "LPRIJQ" + _ALL),
    **owning("one-shot", "reference", {"G28": "return to the reference point"}, _ALL),
    **owning("one-shot", "reference", {"G30": "return to the second reference point"}, _ALL),
    **executed("one-shot", "reference", {"G28.1": "store the reference point"}),
    **executed("one-shot", "reference", {"G30.1": "store the second reference point"}),
    **owning("one-shot", "shift", {"G52": "local coordinate system"}, _ALL),
    **owning("one-shot", "shift", {"G92": "coordinate system setting"}, _ALL),
    **executed("one-shot", "shift", {"G92.1": "shift to 0", "G92.2": "shift off", "G92.3": "shift on again"}),
    **executed("compensation", "radius", {"G41.1": "dynamic compensation left"}, "D"),
    **executed("compensation", "radius", {"G42.1": "dynamic compensation right"}, "D"),
    **owning("length", "length", {"G43.1": "dynamic tool length offset"}, "XYZ"),
    **executed("length", "length", {"G43.2": "additional tool length offset"}, "H"),
    **executed("work-offset", "work_offset", {f"G59.{n}": f"work offset {n + 6}" for n in (1, 2, 3)}),
    **executed("spindle", "spindle_on", {"M3": "spindle clockwise", "M4": "spindle counter-clockwise"}, "$"),
    **executed("spindle", "spindle_off", {"M5": "spindle stop"}, "$"),
    **executed("speed-mode", "speed_mode", {"G96": "constant surface speed"}, "D$"),
    **executed("speed-mode", "speed_mode", {"G97": "constant spindle speed"}, "$"),
    **executed("coolant", "coolant_on", {"M7": "mist coolant", "M8": "flood coolant"}),
    **executed("coolant", "coolant_off", {"M9": "coolant off"}),
    **executed("spindle", "spindle_off", {"M19": "spindle orientation"}, "RPQ$"),
    **executed("stop", "stop", {"M60": "pallet change stop"}),
    **executed("tool-change", "tool_change", {"M61": "set the current tool"}, "Q"),
    **executed(
        "state", "state", {"M70": "save state", "M71": "drop state", "M72": "restore state", "M73": "save state"}
    ),
    **noticed("path", {"G61": "exact path", "G61.1": "exact stop"}),
    **noticed("path", {"G64": "path blending"}, "PQ"),
    **noticed("override", {"M50": "feed override", "M51": "speed override", "M53": "feed stop"}, "P"),
    **noticed("override", {"M52": "adaptive feed"}, "P"),
    **noticed("output", {"M62": "output on", "M63": "output off", "M64": "output on", "M65": "output off"}, "P", "P"),
    **noticed("output", {"M67": "analog output", "M68": "analog output"}, "EQ", "EQ"),
    **refused("motion", LINUXCNC_CYCLES.absent),
    **refused("motion", {"G5.2": "NURBS", "G5.3": "NURBS end", "G6.2": "NURBS", "G6.3": "NURBS end"}),
    **refused("motion", {f"G38.{n}": "probing: where it ends depends on a measurement" for n in (2, 3, 4, 5)}),
    **refused("motion", {"G70": "lathe finishing", "G71": "lathe roughing", "G72": "lathe facing"}),
    **refused("input", {"M66": "wait on an input: it depends on a machine"}),
}

LINUXCNC = Dialect(
    name="linuxcnc",
    codes=CODES,
    order=(
        *("feed_mode", "feed", "speed_mode", "speed", "tool", "tool_change", "spindle_on", "spindle_off", "state"),
        *("coolant_on", "coolant_off", "notice", "dwell", "modes", "radius", "length", "work_offset"),
        *("data", "reference", "shift", "motion", "call", "stop"),
    ),
    free_letters="NOFST",
    refused_letters={letter: f"{letter} is a parallel axis" for letter in "UVW"},
    extra_axes="ABC",
    whole_block_numbers=False,
    corner_letters=(),
    increment_letters=frozenset(),
    whole_letters=frozenset(),
    power_on_motion="G80",
    macro=LINUXCNC_MACRO,
    cycles=LINUXCNC_CYCLES,
    compensation="linuxcnc",
    not_compensated=frozenset({"work_offset", "shift", "data", "length", "tool_change"}),
    compensation_defaults_to_tool=True,
    data_kinds={1: "tool", 2: "zero", 10: "tool-here", 11: "tool-at-fixture", 20: "zero-here"},
    additional_by_l20=False,
    tool_defaults_to_present=True,
    file_end_returns=False,
    subprograms=True,
    packed_calls=False,
    explicit_code_moves=True,
    power_on_return_to_r=True,
    tools_must_be_known=True,
    dwell={"P": DwellWord(seconds=1.0, pointed=1.0)},
    length_word_is_modal=False,
    length_defaults_to_tool=True,
    length_moves_all_axes=True,
    incremental_adds_length=False,
    one_shot_with_motion=False,
    machine_moves_rapid=False,
    reference_all_axes=True,
    reference_cancels_length=False,
    additional_offsets=0,
    tool_variables=(),
    common_shift_variables="external",
    first_alarm=0,
    helix_feed_along_arc=False,
    shift_is_rotated=True,
    semicolon_ends_block=False,
    leader=False,
    arc_tolerance=ArcTolerance(
        absolute_mm=0.0282842712474619, absolute_inch_mm=0.00282842712474619 * 25.4, relative=0.001, most=100.0
    ),
    radius_tolerance_mm=0.00127,
)
