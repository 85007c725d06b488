"""Haas mills: FANUC's language with further codes and some rules of its own."""

from __future__ import annotations

from dataclasses import replace

from gcode.cycles import HAAS_CYCLES
from gcode.dialects.codes import CYCLE_LETTERS, Table, cycle_meanings, executed, noticed, refused
from gcode.dialects.dialect import DwellWord
from gcode.dialects.fanuc import CODES as FANUC_CODES
from gcode.dialects.fanuc import FANUC, FIVE_AXIS

_NOT_HERE = frozenset(
    ["G5", "G5.1", "G8", "G11", "G13.1", "G23", "G25", "G62", "G63", "G66.1", "G90.1", "G91.1", "G92.1", "M198"]
)

CODES: Table = {
    **{code: rule for code, rule in FANUC_CODES.items() if code not in _NOT_HERE},
    **executed("cycle", "modes", cycle_meanings(HAAS_CYCLES), CYCLE_LETTERS),
    **executed("call", "call", {"M97": "local subprogram call"}, "PL"),
    **executed("work-offset", "work_offset", {"G154": "additional work offset"}, "P"),
    **executed("work-offset", "work_offset", {f"G{n}": f"work offset {n - 103}" for n in range(110, 130)}),
    **executed("tool-change", "tool_change", {"M16": "tool change"}),
    **noticed("look-ahead", {"G103": "block look-ahead limit"}, "P"),
    **noticed("look-ahead", {"G187": "accuracy control"}, "PE"),
    **noticed("clamp", {"M10": "4th axis brake on", "M11": "4th axis brake off"}),
    **noticed("clamp", {"M12": "5th axis brake on", "M13": "5th axis brake off"}),
    **noticed("conveyor", {"M31": "chip conveyor on", "M32": "chip conveyor reverse", "M33": "chip conveyor stop"}),
    **noticed("coolant-spout", {"M34": "coolant spigot down", "M35": "coolant spigot up"}),
    **noticed("coolant-spout", {"M36": "pallet part ready", "M50": "pallet change"}),
    **noticed("gear", {"M41": "low gear", "M42": "high gear"}),
    **noticed("air", {"M73": "tool air blast on", "M74": "tool air blast off"}),
    **noticed("air", {"M83": "auto air gun on", "M84": "auto air gun off"}),
    **noticed("coolant-through", {"M88": "through-spindle coolant on", "M89": "through-spindle coolant off"}),
    **noticed("door", {"M80": "automatic door open", "M81": "automatic door close"}),
    **refused(
        "one-shot", {"G12": "circular pocket milling, clockwise", "G13": "circular pocket milling, counter-clockwise"}
    ),
    **refused("one-shot", {"G35": "automatic tool diameter measurement", "G36": "automatic work offset measurement"}),
    **refused("one-shot", {"G47": "text engraving", "G150": "general-purpose pocket milling"}),
    **refused("one-shot", {"G70": "bolt hole circle", "G71": "bolt hole arc", "G72": "bolt holes along an angle"}),
    **refused("mirror", {"G100": "mirror image cancel", "G101": "mirror image"}),
    **refused(
        "length", {"G143": f"tool length offset: {FIVE_AXIS}", "G234": f"tool centre point control: {FIVE_AXIS}"}
    ),
    **refused(
        "rotation", {"G254": f"dynamic work offset: {FIVE_AXIS}", "G255": f"dynamic work offset cancel: {FIVE_AXIS}"}
    ),
    **refused("one-shot", {"G107": "cylindrical mapping", "G141": "3-D cutter compensation"}),
    **refused(
        "input",
        {"M75": "set the G35 or G136 reference point", "M96": "jump if no input", "M109": "interactive user input"},
    ),
    **refused("one-shot", {"G136": "automatic work offset centre measurement"}),
}

HAAS = replace(
    FANUC,
    name="haas",
    codes=CODES,
    cycles=HAAS_CYCLES,
    data_kinds={kind: what for kind, what in FANUC.data_kinds.items() if what != "ignored"},
    packed_calls=False,
    reference_all_axes=True,
    reference_cancels_length=True,
    additional_offsets=99,
    tool_variables=(
        (2001, 200, "length_mm"),
        (2201, 200, "length_wear_mm"),
        (2401, 200, "radius_mm"),
        (2601, 200, "radius_wear_mm"),
    ),
    common_shift_variables="local",
    first_alarm=1000,
    helix_feed_along_arc=False,
    dwell={"P": DwellWord(seconds=0.001, pointed=1.0), "X": DwellWord(seconds=1.0, pointed=1.0)},
)
