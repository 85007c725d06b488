"""Controls as data: what FANUC and LinuxCNC do with the same words.

A `Dialect` is a frozen table. Differences between controls are its fields and rows, each with the rule it stands
for; the code that interprets asks these and never for a dialect's name.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from gcode.codes import COMMON, CYCLES, Table, executed, neutral, noticed, refused, rules
from gcode.codes import Status as _Status


@dataclass(frozen=True, slots=True, kw_only=True)
class ArcTolerance:
    """How far the radii at the two ends of an arc with a programmed centre may differ.

    Attributes:
        absolute_mm: a difference up to this is always accepted.
        relative: a larger one is accepted up to this part of the radius...
        largest_mm: ...and up to this length.
    """

    absolute_mm: float
    relative: float = 0.0
    largest_mm: float = 0.0

    def accepts(self, start_radius_mm: float, end_radius_mm: float) -> bool:
        """True where an arc from one radius to the other is run."""
        difference = abs(start_radius_mm - end_radius_mm)
        relative = self.relative * max(start_radius_mm, end_radius_mm)
        return difference <= self.absolute_mm or difference <= min(relative, self.largest_mm)


@dataclass(frozen=True, slots=True, kw_only=True)
class DwellWord:
    """A word that gives the time of G4: seconds for one unit of its number, and whether it must be whole."""

    seconds: float
    whole: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Dialect:
    """A control, as far as its language goes.

    Attributes:
        name: as users and job files write it.
        codes: its G and M codes.
        order: phases of one block in the order of execution.
        free_letters: letters that may stand in any block.
        refused_letters: letters that are understood and not supported, with what they are.
        power_on_motion: motion code that holds before the program names one; ``G80`` for none.
        dwell: words of G4.
        length_word_is_modal: an H without G43 changes the active length offset, and G43 without H uses the last one.
        length_defaults_to_tool: G43 without H, or with H0, takes the entry of the tool in the spindle.
        incremental_adds_length: with G91 a Z word after a change of the length offset moves by the change too.
        one_shot_with_motion: G0 to G3 beside G28 only sets the mode; else such a block is refused.
        machine_moves_rapid: G53 always moves at rapid; else G0 or G1 must be active and decides.
        reference_all_axes: G28 without axes returns all of them; else it is refused.
        semicolon_ends_block: a semicolon is an end of block, so words behind it are not a comment.
        leader: text before the first percent sign is a leader to be skipped, wherever that percent sign is.
        arc_tolerance: for arcs with a programmed centre.
        radius_tolerance_mm: by how much an R may be shorter than half the chord.
    """

    name: str
    codes: Table
    order: tuple[str, ...]
    free_letters: str
    refused_letters: Mapping[str, str]
    power_on_motion: str
    dwell: Mapping[str, DwellWord]
    length_word_is_modal: bool
    length_defaults_to_tool: bool
    incremental_adds_length: bool
    one_shot_with_motion: bool
    machine_moves_rapid: bool
    reference_all_axes: bool
    semicolon_ends_block: bool
    leader: bool
    arc_tolerance: ArcTolerance
    radius_tolerance_mm: float

    def __post_init__(self) -> None:
        for name in ("codes", "refused_letters", "dwell"):
            object.__setattr__(self, name, MappingProxyType(dict(getattr(self, name))))


_ROTARY = {letter: f"{letter} is a rotary axis" for letter in "ABC"}

FANUC = Dialect(
    name="fanuc",
    codes={
        **COMMON,
        **rules("one-shot", _Status.EXECUTED, {"G4": "dwell"}, phase="dwell", letters="PX", takes_axes=True),
        **executed("length", "length", {"G44": "tool length offset, negative"}, "H"),
        **executed("spindle", "spindle_off", {"M19": "spindle orientation"}),
        **neutral("cycle", {"G80": "canned cycle cancel"}),
        **neutral("polar", {"G15": "polar coordinates cancel"}),
        **neutral("scaling", {"G50": "scaling cancel"}),
        **neutral("mirror", {"G50.1": "mirror image cancel"}),
        **neutral("rotation", {"G69": "coordinate rotation cancel"}),
        **neutral("macro", {"G67": "modal macro call cancel"}),
        **neutral("polar-interpolation", {"G13.1": "polar coordinate interpolation cancel"}),
        **noticed("exact-stop", {"G9": "exact stop in this block"}),
        **noticed(
            "path", {"G61": "exact stop", "G62": "corner override", "G63": "tapping mode", "G64": "cutting mode"}
        ),
        **noticed("look-ahead", {"G5": "high-speed cycle cutting", "G8": "look-ahead control"}, "P"),
        **noticed("look-ahead", {"G5.1": "AI contour control"}, "PQR"),
        **noticed("stroke-check", {"G23": "stored stroke check off"}),
        **noticed("speed-check", {"G25": "spindle speed check off"}),
        **noticed("rigid-tap", {"M29": "rigid tapping mode"}),
        **noticed("clamp", {"M10": "clamp", "M11": "unclamp"}),
        **refused("cycle", CYCLES),
        **refused("polar", {"G16": "polar coordinates"}),
        **refused("scaling", {"G51": "scaling"}),
        **refused("mirror", {"G51.1": "mirror image"}),
        **refused("rotation", {"G68": "coordinate rotation", "G68.2": "tilted working plane"}),
        **refused("macro", {"G65": "macro call", "G66": "modal macro call", "G66.1": "modal macro call"}),
        **refused("polar-interpolation", {"G12.1": "polar coordinate interpolation"}),
        **refused("work-offset", {"G54.1": "additional work offset"}),
        **refused("length", {"G43.1": "tool axis length offset", "G43.4": "tool centre point control"}),
        **refused("motion", {"G2.2": "involute", "G3.2": "involute", "G6.2": "NURBS", "G33": "threading"}),
        **refused("one-shot", {"G7.1": "cylindrical interpolation", "G27": "reference point check"}),
        **refused("one-shot", {"G29": "return from the reference point", "G31": "skip function"}),
        **refused("one-shot", {"G53.1": "tool axis direction control", "G60": "single-direction positioning"}),
        **refused("one-shot", {f"G{n}": "tool radius offset in one block" for n in range(45, 49)}),
        **refused("stroke-check", {"G22": "stored stroke check on"}),
        **refused("speed-check", {"G26": "spindle speed check on"}),
    },
    order=(
        *("modes", "feed", "tool", "tool_change", "speed", "spindle_on", "coolant_on", "work_offset", "length"),
        *("notice", "dwell", "reference", "motion", "spindle_off", "coolant_off", "stop"),
    ),
    free_letters="NOFSTH",
    refused_letters={
        **_ROTARY,
        ",C": ",C is a corner chamfer",
        ",R": ",R is a corner rounding",
        **{letter: f"{letter} is a parallel axis" for letter in "UVW"},
    },
    power_on_motion="G0",
    dwell={"P": DwellWord(seconds=0.001, whole=True), "X": DwellWord(seconds=1.0)},
    length_word_is_modal=True,
    length_defaults_to_tool=False,
    incremental_adds_length=True,
    one_shot_with_motion=True,
    machine_moves_rapid=True,
    reference_all_axes=False,
    semicolon_ends_block=True,
    leader=True,
    arc_tolerance=ArcTolerance(absolute_mm=0.05),
    radius_tolerance_mm=0.05,
)

LINUXCNC = Dialect(
    name="linuxcnc",
    codes={
        **COMMON,
        **executed("one-shot", "dwell", {"G4": "dwell"}, "P"),
        **executed("motion", "modes", {"G80": "motion cancel"}),
        **executed("work-offset", "work_offset", {f"G59.{n}": f"work offset {n + 6}" for n in (1, 2, 3)}),
        **executed("spindle", "spindle_off", {"M19": "spindle orientation"}, "RPQ"),
        **executed("stop", "stop", {"M60": "pallet change stop"}),
        **neutral("diameter", {"G8": "radius mode"}),
        **neutral("one-shot", {"G92.1": "coordinate system cancel", "G92.2": "coordinate system cancel"}),
        **noticed("path", {"G61": "exact path", "G61.1": "exact stop"}),
        **noticed("path", {"G64": "path blending"}, "PQ"),
        **noticed("override", {"M50": "feed override", "M51": "speed override", "M53": "feed stop"}, "P"),
        **noticed("override", {"M52": "adaptive feed"}, "P"),
        **noticed("output", {"M62": "output on", "M63": "output off", "M64": "output on", "M65": "output off"}, "P"),
        **noticed("output", {"M67": "analog output", "M68": "analog output"}, "EQ"),
        **refused("motion", CYCLES),
        **refused("motion", {"G5": "cubic spline", "G5.1": "quadratic spline", "G5.2": "NURBS", "G5.3": "NURBS end"}),
        **refused("motion", {"G33": "synchronised motion", "G33.1": "rigid tapping"}),
        **refused("motion", {f"G38.{n}": "probing" for n in (2, 3, 4, 5)}),
        **refused("compensation", {"G41.1": "dynamic compensation left", "G42.1": "dynamic compensation right"}),
        **refused("length", {"G43.1": "dynamic tool length offset", "G43.2": "additional tool length offset"}),
        **refused("diameter", {"G7": "diameter mode"}),
        **refused("one-shot", {"G28.1": "store the reference point", "G30.1": "store the second reference point"}),
        **refused("one-shot", {"G92.3": "restore the coordinate system"}),
        **refused("input", {"M66": "wait on an input"}),
        **refused("tool-change", {"M61": "set the current tool"}),
        **refused("state", {"M70": "save state", "M71": "drop state", "M72": "restore state", "M73": "save state"}),
    },
    order=(
        *("feed", "speed", "tool", "tool_change", "spindle_on", "spindle_off", "coolant_on", "coolant_off"),
        *("notice", "dwell", "modes", "length", "work_offset", "reference", "motion", "stop"),
    ),
    free_letters="NOFST",
    refused_letters={**_ROTARY, **{letter: f"{letter} is a parallel axis" for letter in "UVW"}},
    power_on_motion="G80",
    dwell={"P": DwellWord(seconds=1.0)},
    length_word_is_modal=False,
    length_defaults_to_tool=True,
    incremental_adds_length=False,
    one_shot_with_motion=False,
    machine_moves_rapid=False,
    reference_all_axes=True,
    semicolon_ends_block=False,
    leader=False,
    arc_tolerance=ArcTolerance(absolute_mm=0.0127, relative=0.001, largest_mm=1.27),
    radius_tolerance_mm=0.00127,
)

DIALECTS: Mapping[str, Dialect] = MappingProxyType({dialect.name: dialect for dialect in (FANUC, LINUXCNC)})


def dialect_named(name: str) -> Dialect:
    """The dialect of that name.

    Raises:
        ValueError: for a name that is none of `DIALECTS`.
    """
    if name not in DIALECTS:
        raise ValueError(f"unknown dialect {name!r}; expected one of {', '.join(DIALECTS)}")
    return DIALECTS[name]
