"""What ``rs274`` makes of single blocks, recorded, so that it need not be there to be compared with.

``golden/rs274/blocks.jsonl`` has one object a line: ``about``, ``block`` (one or several lines of a program), and as
recorded either ``refused`` or ``moves``. ``ours`` gives the reason where we mean to do otherwise. The program is the
block between G21 and M2, with the tools and parameters of `rs274_programs`, G54 at zero. To add blocks, write lines
with ``about`` and ``block`` and record: ``python tests/support/rs274_suite.py --record``.
"""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from support.rs274 import Move, moves_of, rows_of, run
from support.rs274_programs import write_tables

FILE = Path(__file__).parents[1] / "golden" / "rs274" / "blocks.jsonl"
#: Decimals of what is recorded, which are those of the listing in G21.
DECIMALS = 4
#: `Move.rounding` of a listing in G21, which is not written down for each move.
ROUNDING = 0.00026


@dataclass(frozen=True, slots=True, kw_only=True)
class Recorded:
    """One case.

    Attributes:
        about: what the block is about.
        block: its text.
        moves: what ``rs274`` makes of it, None where it refuses it.
        ours: why we do otherwise, empty where we do the same.
    """

    about: str
    block: str
    moves: tuple[Move, ...] | None
    ours: str = ""

    @property
    def program(self) -> str:
        """The program around the block."""
        return program_of(self.block)


def program_of(block: str) -> str:
    """The program that a block is run in."""
    return f"G21\n{block}\nM2\n"


def recorded() -> list[Recorded]:
    """All cases."""
    return [
        Recorded(
            about=case["about"],
            block=case["block"],
            moves=None if case.get("refused") else tuple(_move(move) for move in case["moves"]),
            ours=case.get("ours", ""),
        )
        for case in map(json.loads, FILE.read_text().splitlines())
    ]


def _move(values: dict[str, Any]) -> Move:
    points = {name: tuple(value) for name, value in values.items() if isinstance(value, list)}
    return Move(**{"rounding": ROUNDING} | values | points)


def answers(blocks: Iterable[str]) -> list[tuple[Move, ...] | None]:
    """What ``rs274`` makes of these blocks now; None where it refuses one."""
    with ThreadPoolExecutor(2) as pool:
        return list(pool.map(_answer, blocks))


def _answer(block: str) -> tuple[Move, ...] | None:
    with tempfile.TemporaryDirectory() as made:
        table, parameters = write_tables(Path(made), at_zero=True)
        program = Path(made) / "program.ngc"
        program.write_text(program_of(block), newline="")
        listing = run(program, table=table, parameters=parameters)
        if listing.error:
            return None
        return tuple(moves_of(listing.calls, rows_of(table)))


def record() -> None:
    """Asks ``rs274`` all blocks again and writes the answers."""
    cases = [json.loads(line) for line in FILE.read_text().splitlines()]
    made = answers(case["block"] for case in cases)
    with FILE.open("w") as file:
        for case, moves in zip(cases, made, strict=True):
            kept = {name: case[name] for name in ("about", "block", "ours") if name in case}
            answer: dict[str, Any] = {"refused": True} if moves is None else {"moves": [_values(m) for m in moves]}
            file.write(json.dumps(kept | answer) + "\n")


def _values(move: Move) -> dict[str, Any]:
    """The fields of a move that are not at their defaults, with the decimals of the listing."""
    left_out = {field.name: field.default for field in fields(move)} | {"rounding": ROUNDING}
    values = {name: getattr(move, name) for name in left_out}
    short = {name: _short(value) for name, value in values.items()}
    return {name: value for name, value in short.items() if value != _short(left_out[name])}


def _short(value: Any) -> Any:
    if isinstance(value, tuple):
        return [round(number, DECIMALS) + 0.0 for number in value]
    return round(value, DECIMALS + 2) if isinstance(value, float) else value
