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
    **executed("mist", "coolant_on", {"M7": "shower coolant"}),
    **noticed("conveyor", {"M31": "chip conveyor on", "M32": "chip conveyor reverse", "M33": "chip conveyor stop"}),
    **noticed("coolant-spout", {"M34": "coolant spigot down", "M35": "coolant spigot up"}),
    **noticed("pallet", {"M17": "pallet unclamp", "M18": "pallet clamp", "M36": "pallet part ready"}),
    **noticed("pallet", {"M49": "status of a pallet", "M50": "pallet change"}, "PQ"),
    **noticed("validity", {"M48": "check of the program's validity"}),
    **noticed("user", {f"M{n}": "user relay with M-Fin" for n in range(21, 29)}),
    **noticed("user", {f"M{n}": "user relay on" for n in range(51, 59)}),
    **noticed("user", {f"M{n}": "user relay off" for n in range(61, 69)}),
    **noticed("user", {"M59": "output relay on", "M69": "output relay off"}, "P"),
    **noticed("vise", {"M70": "electric vise clamp", "M71": "electric vise unclamp"}),
    **noticed("drawbar", {"M82": "tool unclamp", "M86": "tool clamp"}),
    **noticed("probe-arm", {"M104": "probe arm extend", "M105": "probe arm retract"}),
    **noticed("media", {"M130": "media display", "M131": "media display off"}),
    **noticed("spindle-variation", {"M138": "spindle speed variation on", "M139": "spindle speed variation off"}, "PE"),
    **noticed("mist-condenser", {"M158": "mist condenser on", "M159": "mist condenser off"}),
    **noticed("lubrication", {"M160": "minimum-quantity lubrication off"}),
    **noticed("lubrication", {f"M{n}": "minimum-quantity lubrication" for n in (161, 162, 163)}, "P"),
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
        {
            "M46": "jump if a pallet is loaded",
            "M78": "alarm if the skip signal is there",
            "M79": "alarm if the skip signal is missing",
            "M95": "sleep mode",
            "M199": "load of a part or pallet, or program end",
            "M300": "sequence of a part loader",
        },
    ),
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
    second_variable_names=((10100, 100, 100), (10500, 100, 500), (10600, 100, 600), (10800, 200, 800)),
    further_variables=(range(10000, 10100), range(10200, 10500), range(10700, 10800)),
    counters=(
        (1601, 200, "number of flutes of a tool"),
        (1801, 200, "largest vibration of a tool"),
        (3020, 6, "timer of the machine"),
        (3201, 200, "measured diameter of a tool"),
        (3401, 200, "position of the coolant spigot for a tool"),
        (3901, 2, "count of M30"),
        (5401, 100, "feed timer of a tool"),
        (5501, 100, "total timer of a tool"),
        (5601, 100, "limit of the tool life monitor"),
        (5701, 100, "counter of the tool life monitor"),
        (5801, 100, "largest load of a tool"),
        (5901, 100, "limit of the tool load monitor"),
    ),
    common_shift_variables="local",
    machine_move_incremental="absolute",
    same_group="refused",
    first_alarm=1000,
    helix_feed_along_arc=False,
    dwell={"P": DwellWord(seconds=0.001, pointed=1.0), "X": DwellWord(seconds=1.0, pointed=1.0)},
)
