"""Random programs in LinuxCNC's language: what every snippet is made of, and putting them together.

Values are chosen first and written as expressions afterwards, so that programs are right whatever the seed. What
``rs274`` is known to do differently from a machine, or wrong, is left out:

- a change of units while a length offset holds: it keeps the offset's number;
- G43 without H after M61, or in the block of M6: the stand-alone program does not know the tool then;
- a tool's offset in x and y together with a turned work offset: it is taken off in turned coordinates;
- break out of a while loop, after which the next do loop of the program ends with its first pass, and continue in a do
  loop, after which the next repeat goes on too long;
- G92 and G52 together with a turned work offset: it forgets to turn them when the turning changes;
- a tool change after a change of offsets without a motion between: the stand-alone program's place is the old one;
- G84 in G18 and G19, where it loses its place until the next tool change;
- M98 in a subroutine: the search for the program stumbles over an ``endsub`` on its way;
- more than ten levels of calls, which are refused; feeds of more than one decimal over M72, which rounds them;
- splines, of which it says nothing.
"""

from __future__ import annotations

import math
import random
from pathlib import Path

#: Rows of the tool table by number, in inches: length, x, y, diameter.
TOOLS = {1: (2.0, 0.0, 0.0, 0.25), 2: (3.5, 0.5, -0.25, 0.5), 3: (1.0, 0.0, 0.0, 0.04), 9: (0.25, 0.0, 0.0, 1.0)}
#: Parameters at the start, in inches: reference points, work offsets and a rotation.
PARAMETERS = {
    number: value
    for first, values in (
        (5161, (0.25, 0.5, 6.0)),
        (5181, (1.0, -1.0, 5.0)),
        (5220, (1.0, 1.0, -2.0, 0.5)),
        (5241, (4.0, 3.0, -1.0)),
        (5250, (30.0,)),
    )
    for number, value in enumerate(values, start=first)
}
#: Letters of a plane's first and second axis, of its centre and of its normal.
PLANES = {"G17": ("XY", "IJ", "Z"), "G18": ("ZX", "KI", "Y"), "G19": ("YZ", "JK", "X")}


def write_tables(folder: Path, *, at_zero: bool = False) -> tuple[Path, Path]:
    """Writes the tool table and the parameter file into a folder, and says where they are.

    Args:
        at_zero: leave out the offset that is active at the start.
    """
    table, parameters = folder / "tools.tbl", folder / "parameters.var"
    table.write_text("".join(f"T{n} P{n} X{x} Y{y} Z{z} D{d}\n" for n, (z, x, y, d) in TOOLS.items()))
    values = {number: 0.0 if at_zero and number in (5221, 5222, 5223) else PARAMETERS[number] for number in PARAMETERS}
    parameters.write_text("".join(f"{number}\t{value}\n" for number, value in sorted(values.items())))
    return table, parameters


class Writer:
    """The state of writing one program.

    Attributes:
        source: of all that is random.
        unit: mm per unit of length at this place of the program.
        turning: True for a program that turns work offsets, False for one with tools that are off the spindle's axis.
        rotated: True where the active work offset may be turned, so that arcs are right in G17 only.
        depth: levels of O-words around this place.
        before: subroutines, which stand before the program.
        after: numbered programs, which stand behind its end.
    """

    def __init__(self, seed: int) -> None:
        self.source = random.Random(seed)
        self.unit = 1.0
        self.turning = self.source.random() < 0.5
        self.rotated = False
        self.depth = 0
        self.before: list[str] = []
        self.after: list[str] = []
        self._label = 100

    def label(self) -> int:
        """A number that no O-word has yet."""
        self._label += 1
        return self._label

    def choice(self, *of: str) -> str:
        """One of these."""
        return self.source.choice(of)

    def odds(self, chance: float) -> bool:
        """True so often."""
        return self.source.random() < chance

    def mm(self, limit: float = 60.0, least: float | None = None) -> str:
        """A length of at most so many mm, in the program's unit: a number or an expression."""
        low = -limit if least is None else least
        value = self.source.uniform(low, limit) / self.unit
        return self.expression(value) if self.odds(0.25) else f"{value:.4f}"

    def axes(self, letters: str = "XYZ", limit: float = 60.0) -> str:
        """Words of some of these axes, at least one."""
        chosen = [a for a in letters if self.odds(0.6)] or [self.choice(*letters)]
        return " ".join(f"{a}{self.mm(limit)}" for a in chosen)

    def expression(self, value: float) -> str:
        """An expression in brackets of this value, but for the decimals of a length."""
        name, part = self.choice("SIN", "COS", "FIX", "FUP", "ABS", "ROUND"), self.source.uniform(-9.0, 9.0)
        part = round(part, 2) + 0.001
        taken = {
            "SIN": math.sin(math.radians(part)),
            "COS": math.cos(math.radians(part)),
            "FIX": math.floor(part),
            "FUP": math.ceil(part),
            "ABS": abs(part),
            "ROUND": round(part),
        }[name]
        rest = f"{value - taken:.5f}"
        return self.choice(
            f"[{rest} + {name}[{part:.3f}]]",
            f"[{name}[{part:.3f}] - [{taken - value:.5f}]]",
            f"[{value / 2.0:.5f} * 2]",
            f"[[{value:.5f}] ** 1]",
            f"[{value:.5f} * [1 GT 0] + [2 EQ 3] + [1 LE 0]]",
            f"[{value:.5f} + [7 MOD 7] * EXP[1] + ATAN[0]/[1]]",
            f"[SQRT[{value * value:.7f}] * {1 if value > 0 else -1}]",
            f"[{value:.5f} / [1 AND 1] + [1 XOR 1] - LN[1] + [0 OR 0]]",
            f"[{value - 7:.5f} + -5 MOD 12]",
            f"[ACOS[1] + ASIN[0] + TAN[0] + {value:.5f}]",
        )

    def arc_words(self, limit: float = 40.0) -> tuple[str, str]:
        """Plane, and an arc's code and words for incremental coordinates."""
        plane = "G17" if self.rotated else self.choice(*PLANES)
        (first, second), (i, j), normal = PLANES[plane]
        radius, at, swept = self.source.uniform(1.0, limit) / self.unit, *self._angles()
        sign, code = self.source.choice(((1.0, "G3"), (-1.0, "G2")))
        u, v = -radius * math.cos(at), -radius * math.sin(at)
        du, dv = u + radius * math.cos(at + sign * swept), v + radius * math.sin(at + sign * swept)
        helix = f" {normal}{self.mm(5.0)}" if self.odds(0.4) else ""
        turns = f" P{self.source.randrange(1, 4)}" if self.odds(0.3) else ""
        centre, end = f" {i}{u:.6f} {j}{v:.6f}", f" {first}{du:.6f} {second}{dv:.6f}"
        whole, by_radius = f"{code}{centre}{helix}{turns}", f"{code}{end}{helix} R{radius:.6f}"
        by_radius = by_radius.replace(" R", " R-") if swept > math.pi else by_radius
        return plane, self.choice(whole, by_radius, f"{code}{end}{helix}{centre}{turns}")

    def _angles(self) -> tuple[float, float]:
        return self.source.uniform(0.0, 6.28), self.source.uniform(0.2, 6.0)

    def dressed(self, line: str) -> str:
        """A line in another spelling: case, blanks, a block number, a comment."""
        how = self.source.random()
        if how < 0.05:
            return line.lower()
        if how < 0.1 and line[0] in "GMXYZ":
            return f"N{self.source.randrange(9999)} {line}"
        if how < 0.15:
            return f"{line} (as written) ; so"
        if how < 0.2 and "<" not in line and line[0] != "O":
            return line.replace(" ", self.choice("  ", "\t"))
        return line


def mutated(text: str, seed: int) -> str:
    """The program with one small mistake, or what may be one."""
    source = random.Random(seed)
    lines = text.splitlines()
    number = source.randrange(len(lines))
    line, other = lines[number], source.choice(lines)
    at = source.randrange(len(line) + 1)
    lines[number : number + 1] = source.choice(
        (
            [line[:at] + line[at + 1 :]],
            [line[:at] + source.choice("GMXYZIJKRPQLFSTHD#[]-.0123456789/*(;<>%") + line[at:]],
            [f"{line} {source.choice(other.split() or ['X1'])}"],
            [],
            [line, other],
            [line[:at]],
        )
    )
    return "\n".join([*lines, ""])
