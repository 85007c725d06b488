"""FANUC series 0i, 16i, 18i, 21i, 30i for machining centres."""

from __future__ import annotations

from gcode.cycles import FANUC_CYCLES
from gcode.dialects.codes import CYCLE_LETTERS, FULL, Table, cycle_meanings, executed, neutral, noticed, owning, refused
from gcode.dialects.dialect import ArcTolerance, Dialect, DwellWord
from gcode.dialects.macro_language import FANUC_MACRO

FIVE_AXIS = "five-axis machining"

CODES: Table = {
    **FULL,
    **owning("one-shot", "dwell", {"G4": "dwell"}, "PX"),
    **owning("one-shot", "data", {"G10": "programmable data input"}, "LPRXYZQIJABCDHTNK"),
    **neutral("data", {"G11": "programmable data input cancel"}),
    **executed("length", "length", {"G44": "tool length offset, negative"}, "H"),
    **executed("spindle", "spindle_off", {"M19": "spindle orientation"}, "RPQ"),
    **executed("cycle", "modes", {"G80": "canned cycle cancel"}),
    **executed("cycle", "modes", cycle_meanings(FANUC_CYCLES), CYCLE_LETTERS),
    **executed("polar", "transform_off", {"G15": "polar coordinate command cancel"}),
    **executed("polar", "transform", {"G16": "polar coordinate command"}),
    **executed("scaling", "transform_off", {"G50": "scaling cancel"}),
    **owning("scaling", "transform", {"G51": "scaling"}, "XYZPIJK"),
    **executed("mirror", "transform_off", {"G50.1": "mirror image cancel"}, "XYZ"),
    **owning("mirror", "transform", {"G51.1": "mirror image"}, "XYZ"),
    **executed("rotation", "transform_off", {"G69": "coordinate rotation cancel"}),
    **owning("rotation", "transform", {"G68": "coordinate rotation"}, "XYZR"),
    **executed("work-offset", "work_offset", {f"G{n}": f"work offset {n - 53}" for n in range(54, 60)}, "P"),
    **executed("work-offset", "work_offset", {"G54.1": "additional work offset"}, "P"),
    **owning("one-shot", "shift", {"G92": "coordinate system setting, or spindle speed limit"}, "XYZ"),
    **owning("one-shot", "shift", {"G92.1": "workpiece coordinate system preset"}, "XYZ"),
    **owning("one-shot", "reference", {"G27": "reference point check"}, "XYZ"),
    **owning("one-shot", "reference", {"G29": "return from the reference point"}, "XYZ"),
    **owning("one-shot", "reference", {"G60": "single-direction positioning"}, "XYZ"),
    **owning("call", "call", {"G65": "macro call", "G66": "modal macro call", "G66.1": "modal macro call"}, "*"),
    **executed("call", "call", {"G67": "modal macro call cancel"}),
    **executed("call", "call", {"M198": "subprogram call from an external device"}, "PL"),
    **neutral("polar-interpolation", {"G13.1": "polar coordinate interpolation cancel"}),
    **noticed("exact-stop", {"G9": "exact stop in this block"}),
    **noticed(
        "path", {"G61": "exact stop", "G62": "automatic corner override", "G63": "tapping mode", "G64": "cutting mode"}
    ),
    **noticed("look-ahead", {"G5": "high-speed cycle cutting", "G8": "look-ahead control"}, "P"),
    **noticed("look-ahead", {"G5.1": "AI contour control"}, "PQR"),
    **noticed("stroke-check", {"G23": "stored stroke check off"}),
    **noticed("speed-check", {"G25": "spindle speed fluctuation detection off"}),
    **executed("rigid-tap", "rigid_tapping", {"M29": "rigid tapping mode"}),
    **noticed("clamp", {"M10": "clamp", "M11": "unclamp"}),
    **refused(
        "rotation", {"G68.2": f"tilted working plane: {FIVE_AXIS}", "G68.3": f"tilted working plane: {FIVE_AXIS}"}
    ),
    **refused("polar-interpolation", {"G12.1": "polar coordinate interpolation"}),
    **refused("length", {"G43.1": f"tool length offset along the tool axis: {FIVE_AXIS}"}),
    **refused("length", {"G43.4": f"tool centre point control: {FIVE_AXIS}"}),
    **refused("length", {"G43.5": f"tool centre point control: {FIVE_AXIS}"}),
    **refused(
        "compensation", {f"G4{n}.{k}": f"3-D cutter compensation: {FIVE_AXIS}" for n in (1, 2) for k in range(2, 7)}
    ),
    **refused("motion", {"G2.2": "involute", "G3.2": "involute", "G6.2": "NURBS", "G33": "threading"}),
    **refused("motion", {"G2.3": "exponential", "G3.3": "exponential", "G2.4": "3-D arc", "G3.4": "3-D arc"}),
    **refused("one-shot", {"G7.1": "cylindrical interpolation", "G107": "cylindrical interpolation"}),
    **refused("one-shot", {"G31": "skip function: its end depends on a measurement"}),
    **refused("one-shot", {"G37": "automatic tool length measurement: its end depends on a measurement"}),
    **refused("one-shot", {"G53.1": f"tool axis direction control: {FIVE_AXIS}"}),
    **refused("one-shot", {"G45": "tool offset increase", "G46": "tool offset decrease"}),
    **refused("one-shot", {"G47": "tool offset double increase", "G48": "tool offset double decrease"}),
    **refused("stroke-check", {"G22": "stored stroke check on"}),
    **refused("speed-check", {"G26": "spindle speed fluctuation detection on"}),
}

ROTARY = {letter: f"{letter} is a rotary axis" for letter in "ABC"}
PARALLEL = {letter: f"{letter} is a parallel axis" for letter in "UVW"}

FANUC = Dialect(
    name="fanuc",
    codes=CODES,
    order=(
        *("feed_mode", "modes", "feed", "tool", "tool_change", "speed_mode", "speed", "spindle_on", "rigid_tapping"),
        *("coolant_on", "transform_off", "work_offset", "shift", "length", "radius", "data", "transform"),
        *("notice", "dwell", "reference", "motion", "spindle_off", "coolant_off", "call", "stop"),
    ),
    free_letters="NOFSTHD",
    refused_letters={**ROTARY, **PARALLEL},
    extra_axes="",
    whole_block_numbers=True,
    corner_letters=(",C", ",R"),
    increment_letters=frozenset(["X", "Y", "Z", "I", "J", "K", "R", "Q", ",C", ",R"]),
    whole_letters=frozenset("DHLMOST"),
    power_on_motion="G0",
    macro=FANUC_MACRO,
    cycles=FANUC_CYCLES,
    compensation="fanuc",
    not_compensated=frozenset(),
    compensation_defaults_to_tool=False,
    data_kinds={
        2: "zero",
        20: "zero-here",
        10: "length",
        11: "length-wear",
        12: "radius",
        13: "radius-wear",
        1: "length",
        3: "ignored",
        50: "ignored",
        52: "ignored",
    },
    additional_by_l20=True,
    tool_defaults_to_present=False,
    file_end_returns=False,
    subprograms=True,
    packed_calls=True,
    explicit_code_moves=False,
    power_on_return_to_r=False,
    tools_must_be_known=False,
    dwell={"P": DwellWord(seconds=0.001, pointed=None), "X": DwellWord(seconds=1.0, pointed=1.0)},
    length_word_is_modal=True,
    length_defaults_to_tool=False,
    length_moves_all_axes=False,
    incremental_adds_length=True,
    one_shot_with_motion=True,
    machine_moves_rapid=True,
    reference_all_axes=False,
    reference_cancels_length=False,
    additional_offsets=300,
    tool_variables=(
        (10001, 400, "length_wear_mm"),
        (11001, 400, "length_mm"),
        (12001, 400, "radius_wear_mm"),
        (13001, 400, "radius_mm"),
        (2001, 200, "length_wear_mm"),
        (2201, 200, "length_mm"),
    ),
    common_shift_variables="external",
    first_alarm=3000,
    helix_feed_along_arc=True,
    shift_is_rotated=False,
    semicolon_ends_block=True,
    leader=True,
    arc_tolerance=ArcTolerance(absolute_mm=0.05),
    radius_tolerance_mm=0.05,
)
