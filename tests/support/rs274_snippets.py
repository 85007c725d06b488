"""Snippets of random programs: each a few blocks that leave G90, G17, G94, radius mode and no cycle behind."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

from support.rs274_programs import PLANES, TOOLS, Writer

Snippet: TypeAlias = Callable[[Writer], list[str]]

SYSTEMS = ("G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3")
CYCLES = ("G81", "G82 P.2", "G83 Q{q}", "G73 Q{q}", "G85", "G86 P.1", "G89 P.3", "G84")
NUMBERED = ("#31", "#150", "#[30 + 2]", "# 33", "#4")
NAMED = ("#<width>", "#<_shared>", "#<Of Blanks>")
FLAGS = ("_metric", "_imperial", "_absolute", "_incremental", "_spindle_on", "_feed", "_rpm", "_coord_system", "_task")
#: A path around which a cutter of less than 3 mm has room, in mm, and one where it may not have.
WIDE = ((20, 0), (0, 25), (-12, 8), (-20, 0), (0, -30), (15, -9))


def program(seed: int, snippets: int = 25, only: str = "") -> str:
    """The text of a random program.

    Args:
        only: names of snippets, separated by commas, to write nothing else.
    """
    writer = Writer(seed)
    body = many(writer, snippets, [SNIPPETS[name] for name in only.split(",")] if only else None)
    head = ["G21 G90 G17 G94 G54 F200", "S800 M3", "G0 X1 Y2 Z30"]
    return "\n".join([*writer.before, *head, *body, "M2", *writer.after, ""])


def many(writer: Writer, count: int, among: list[Snippet] | None = None) -> list[str]:
    """The lines of so many snippets."""
    if among is None:
        left_out = (NESTING if writer.depth > 1 else set()) | (ONCE if writer.depth else set())
        names = [name for name in SNIPPETS if name not in left_out for _ in range(WEIGHTS.get(name, 1))]
        among = [SNIPPETS[name] for name in names]
    return [writer.dressed(line) for _ in range(count) for line in writer.source.choice(among)(writer)]


def straight(w: Writer) -> list[str]:
    code = w.choice("G0", "G1", "G1")
    rotary = f" {w.choice(*'ABC')}{w.source.uniform(-90, 90):.2f}" if w.odds(0.15) else ""
    if w.odds(0.25):
        return [f"G91 {code} {w.axes(limit=20.0)}{rotary}", "G90"]
    return [f"{code} {w.axes()}{rotary}", *([w.axes()] if w.odds(0.3) else [])]


def arc(w: Writer) -> list[str]:
    plane, words = w.arc_words()
    return [f"G91 {plane} {words}", "G90 G17"]


def parameter(w: Writer) -> list[str]:
    name = w.choice(*NUMBERED, *NAMED)
    value = w.expression(w.source.uniform(-30, 30) / w.unit)
    return [f"{name} = {value}", f"G1 {w.choice(*'XYZ')}{w.choice(name, f'[{name} * 0.5]', f'-{name}', f'[-{name}]')}"]


def same_block(w: Writer) -> list[str]:
    """A parameter set and used in one block keeps its old value in it."""
    return ["#40 = 1", f"#40 = 2 G1 X#40 #41 = {w.source.randrange(9)}", "G1 Y#40 Z#41"]


def system_parameter(w: Writer) -> list[str]:
    number, flag = w.choice("5420", "5421", "5422"), w.choice(*FLAGS)
    return [
        f"G1 X[#{number} + 1] Y{w.choice('#<_x>', '#<_y>', '#<_z>', '#<_a>')}",
        f"G1 Z[#<{flag}> / 10 + EXISTS[#<not_there>] + EXISTS[#<{flag}>]]",
    ]


def offset(w: Writer) -> list[str]:
    turned = w.turning and w.odds(0.3)
    w.rotated = w.rotated or turned
    turn = f" R{w.source.uniform(-180, 180):.3f}" if turned else ""
    return [
        w.choice(f"G10 L2 P{w.source.randrange(10)} {w.axes()}{turn}", f"G10 L20 P{w.source.randrange(10)} {w.axes()}")
    ]


def select(w: Writer) -> list[str]:
    w.rotated = w.turning
    return [w.choice(*(system for system in SYSTEMS if w.turning or system != "G55"))]


def shift(w: Writer) -> list[str]:
    if w.turning:
        return ["G92.1"]
    words = w.axes(limit=15.0)
    return w.source.choice(
        (
            [f"G92 {words}"],
            ["G92.1"],
            [f"G92 {words}", "G92.2", f"G1 {w.axes()}", "G92.3"],
            [f"G52 {words}"],
            ["G52 X0 Y0 Z0"],
        )
    )


def reference(w: Writer) -> list[str]:
    code = w.choice("G28", "G30")
    if w.odds(0.3):
        return [f"{code}.1"]
    words = f" {w.axes(limit=10.0)}" if w.odds(0.7) else ""
    return [w.choice("G90", "G91"), f"{code}{words}", "G90"]


def machine(w: Writer) -> list[str]:
    return [f"{w.choice('G0', 'G1')} G53 {w.axes()}"]


def on_axis(w: Writer) -> list[int]:
    """Tools that this program may measure."""
    return [number for number, (_, x, y, _) in TOOLS.items() if not (w.turning and (x or y))]


def length(w: Writer) -> list[str]:
    number = w.source.choice(on_axis(w))
    dynamic = f"G43.1 Z{w.mm(30.0)}" + (f" X{w.mm(5.0)}" if w.odds(0.3) and not w.turning else "")
    return [w.choice(f"G43 H{number}", "G49", dynamic, f"G43.2 H{number}"), f"G1 {w.axes()}"]


def tool(w: Writer) -> list[str]:
    number = w.source.choice(on_axis(w))
    measured = ["G43", f"G1 {w.axes()}"] if w.odds(0.5) else []
    changed = w.source.choice(([f"T{number} M6"], [f"T{number}", "G0 X0", "M6"]))
    done = w.source.choice(([*changed, *measured], [f"M61 Q{number}"], ["T0 M6"]))
    return [f"G0 X{w.mm()} Y{w.mm()} Z{w.mm()}", *done, "M3 S800"]


def tool_data(w: Writer) -> list[str]:
    number = w.source.choice(on_axis(w))
    sideways = f"X{w.mm(4.0)} " if not w.turning else ""
    words = w.choice(f"Z{w.mm(40.0)}", f"R{w.mm(2.0, 0.1)}", f"{sideways}Z{w.mm(20.0)}")
    return [f"G10 L{w.choice('1', '10', '11')} P{number} {words}", f"G43 H{number}", f"G1 {w.axes()}"]


def units(w: Writer) -> list[str]:
    code, w.unit = w.source.choice((("G20", 25.4), ("G21", 1.0)))
    return ["G49", code, f"F{200 / w.unit:.1f}"]


def cycle(w: Writer) -> list[str]:
    plane = "G17" if w.rotated else w.choice(*PLANES)
    (first, second), _, normal = PLANES[plane]
    relative = w.odds(0.4)
    depth = w.source.uniform(2.0, 12.0) / w.unit
    level = w.source.uniform(-5.0, 8.0) / w.unit
    bottom = -depth if relative else level - depth
    words = w.choice(*(name for name in CYCLES if name != "G84" or plane == "G17")).format(q=f"{depth / 2.7:.3f}")
    repeats = f" L{w.source.randrange(1, 4)}" if w.odds(0.4) and "G84" not in words else ""
    lines = [f"{w.choice('G98', 'G99')} {words} {first}{w.mm(20)} {second}{w.mm(20)} {normal}{bottom:.4f} R{level:.4f}"]
    lines += [f"{w.axes(first + second, 20.0)}{repeats}" for _ in range(w.source.randrange(3))]
    return [
        f"{plane} {'G91' if relative else 'G90'}",
        *lines,
        *([w.choice("G98", "G99")] if w.odds(0.2) else []),
        "G80 G90 G17",
    ]


def tapping(w: Writer) -> list[str]:
    pitch = w.source.uniform(0.3, 2.0) / w.unit
    return w.source.choice(
        (
            [f"G33 Z{w.mm()} K{pitch:.4f}"],
            [f"G33.1 Z{w.mm()} K{pitch:.4f}", f"G1 {w.axes()}"],
            ["M4", f"G74 {w.axes('XY')} Z-5 R1", "G80", "M3"],
        )
    )


def feed_mode(w: Writer) -> list[str]:
    back = f"G94 F{200 / w.unit:.1f}"
    turn = f"F{w.source.uniform(0.05, 0.4) / w.unit:.4f}"
    inverse = [f"G93 G1 {w.axes()} F{w.source.uniform(1, 9):.2f}", f"{w.axes()} F2.5"]
    return w.source.choice(
        (
            [*inverse, back],
            ["G93 G91", " ".join(w.arc_words()) + " F3", "G90 G17", back],
            ["S700 M3", f"G95 {turn}", f"G1 {w.axes()}", back],
            [f"F{w.source.uniform(10, 900) / w.unit:.1f}"],
        )
    )


def spindle(w: Writer) -> list[str]:
    turning = [w.choice("M3", "M4", "M5"), f"S{w.source.randrange(100, 5000)}", f"G1 {w.axes()}", "M3"]
    return w.source.choice((turning, ["G96 D3000 S200", f"G1 {w.axes()}", "G97 S800"], ["M19 R45", "M3 S900"]))


def quiet(w: Writer) -> list[str]:
    """What changes no motion."""
    return [
        w.choice("G61", "G61.1", "G64", "G64 P.02", "G64 P.01 Q.01", "M8", "M7", "M9", "M48", "M49", "M53 P0", "M1")
    ]


def dwell(w: Writer) -> list[str]:
    return [f"G4 P{w.choice('0.5', '[1/8]', '2', '0')}"]


def saved(w: Writer) -> list[str]:
    changes = [w.choice("G91", "G61", "F55", "G18", "G98", "S432"), f"G1 {w.axes(limit=9.0)}"]
    return ["M70", *changes, w.choice("M72", "M71", "M72"), "G90 G17"]


def diameter(w: Writer) -> list[str]:
    return ["G7", f"G1 {w.axes()}", f"G91 G1 {w.axes('XZ', 9.0)}", "G90 G8"]


def absolute_centres(w: Writer) -> list[str]:
    at, radius = w.source.uniform(5, 20) / w.unit, w.source.uniform(1, 9) / w.unit
    return [f"G1 X{at + radius:.5f} Y3", f"G90.1 G3 X{at - radius:.5f} Y3 I{at:.5f} J3", "G91.1"]


def compensated(w: Writer) -> list[str]:
    side, radius = w.choice("G41.1", "G42.1"), w.source.uniform(0.2, 2.5) / w.unit
    start = w.choice(f"{side} D{2 * radius:.4f}", f"{side[:3]} D{w.choice('1', '3')}")
    legs = []
    for x, y in WIDE:
        x, y = x + w.source.uniform(-3, 3), y + w.source.uniform(-3, 3)
        legs.append(
            f"{w.choice('G1', 'G1', 'G0')} X{x / w.unit:.4f} Y{y / w.unit:.4f}" + (" Z1" if w.odds(0.1) else "")
        )
        if w.odds(0.25):
            legs.append(_round(w))
    return ["G1 X0 Y0", "G91", start, *legs, "G40", f"G1 X{30 / w.unit:.4f} Y{w.mm(30)}", "G90"]


def _round(w: Writer) -> str:
    """Half a turn of a large radius."""
    x, y = w.source.uniform(-15, 15) / w.unit, w.source.uniform(12, 20) / w.unit
    return f"{w.choice('G2', 'G3')} X{2 * x:.5f} Y{2 * y:.5f} I{x:.5f} J{y:.5f}"


def inner(w: Writer, count: int = 2) -> list[str]:
    """Snippets that run never, once or several times: an offset may be turned by then."""
    w.depth, w.rotated = w.depth + 1, w.turning
    lines = many(w, count)
    w.depth -= 1
    return lines


def condition(w: Writer) -> list[str]:
    label, value = w.label(), w.source.randrange(3)
    return [
        f"#50 = {value}",
        f"O{label} if [#50 EQ 0]",
        *inner(w),
        *(f"O{label} elseif [#50 {w.choice('EQ', 'GE')} 1]", *inner(w)),
        *((f"O{label} else", *inner(w)) if w.odds(0.5) else ()),
        f"O{label} endif",
    ]


def loop(w: Writer) -> list[str]:
    label, count = w.label(), f"#{60 + w.depth}"
    body = [f"{count} = [{count} + 1]", *inner(w), f"G91 G1 X[{count}]", "G90"]
    repeated = [f"O{label} repeat [{w.source.randrange(4)}]", *body, f"O{label} endrepeat"]
    first = [f"O{label} while [{count} LT 3]", *leaving(w, label, count, "continue"), *body, f"O{label} endwhile"]
    last = [f"O{label} do", *body, *leaving(w, label, count, "break"), f"O{label} while [{count} LT 3]"]
    return [f"{count} = 0", *w.source.choice((repeated, first, last))]


def leaving(w: Writer, label: int, count: str, how: str) -> list[str]:
    """Sometimes: blocks that leave a loop, or go on with its next pass."""
    if w.odds(0.6):
        return []
    raised = [f"{count} = [{count} + 1]"] if how == "continue" else []
    return [f"O{label + 500} if [{count} EQ 2]", *raised, f"O{label} {how}", f"O{label + 500} endif"]


def call(w: Writer) -> list[str]:
    """A subroutine by number or name, with arguments, its own parameters and a value."""
    name = w.choice(f"O{w.label()}", f"O<sub {w.label()}>", f"O<Sub{w.label()}>")
    lines = inner(w, 3)
    value = f" [#1 + {w.source.uniform(0, 9):.2f}]" if w.odds(0.6) else ""
    early = [f"O{w.label()} if [#2 GT 5]", f"{name} return{value}", f"O{w._label} endif"] if w.odds(0.4) else []
    w.before += [
        f"{name} sub",
        "G1 X#1 Y#2 Z[#3 + #30]",
        "#4 = 77 #1 = [#1 * 2]",
        *early,
        *lines,
        f"{name} endsub{value}",
    ]
    taken = w.choice("G1 X[#<_value> + #<_value_returned>]", "G1 Y#4") if value else "G1 Y#1 Z#2"
    return [f"{name} call [{w.mm(9)}] [{w.mm(9)}]" + (f" [{w.mm(5)}]" if w.odds(0.5) else ""), taken]


def recursion(w: Writer) -> list[str]:
    label, inside = w.label(), w.label()
    w.before += [
        *(f"O{label} sub", f"O{inside} if [#1 GT 0]", "G91 G1 X#1 Y[#1 * #2]", "G90"),
        *(f"O{label} call [#1 - 1] [#2 / 2]", "G1 Z#1", f"O{inside} endif", f"O{label} endsub"),
    ]
    return [f"O{label} call [{w.source.randrange(1, 4)}] [{w.mm(3)}]"]


def numbered_call(w: Writer) -> list[str]:
    label = w.label()
    lines = inner(w, 2)
    w.after += [f"O{label}", "#31 = [#31 + 1] G1 X#31", *lines, "M99"]
    return ["#31 = 0", f"M98 P{label}" + (f" L{w.source.randrange(4)}" if w.odds(0.6) else ""), "G1 Y#31"]


def kept(w: Writer) -> list[str]:
    """M73: the caller's modes come back."""
    label = w.label()
    w.before += [f"O{label} sub", "M73", w.choice("G91", "G18", "F33", "G99"), "G1 X1 Y2 Z3", f"O{label} endsub"]
    return [f"O{label} call", f"G1 {w.axes()}"]


SNIPPETS = {
    **{
        f.__name__: f
        for f in (straight, arc, parameter, same_block, system_parameter, offset, select, shift, reference)
    },
    **{f.__name__: f for f in (machine, length, tool, tool_data, cycle, tapping, feed_mode, spindle, quiet, dwell)},
    **{f.__name__: f for f in (saved, diameter, absolute_centres, compensated, units)},
    **{f.__name__: f for f in (condition, loop, call, recursion, numbered_call, kept)},
}
WEIGHTS = {"straight": 5, "arc": 4, "cycle": 2, "call": 2}
#: Those with others in them, and what may not happen an unknown number of times.
NESTING, ONCE = {"condition", "loop", "call", "recursion", "numbered_call", "kept"}, {"units", "numbered_call"}
#: Names of those without others in them, of which a mistake cannot make a program without end.
FLAT = ",".join(name for name in SNIPPETS if name not in NESTING)
