"""The dialect ``linuxcnc`` against LinuxCNC's own interpreter: recorded single blocks, and random programs.

The recorded blocks need no LinuxCNC; the rest is skipped where ``rs274`` is not installed
(``apt-get install --no-install-recommends linuxcnc-uspace``). ``tests/support/rs274_suite.py`` runs as many random
programs as one likes, and folders of programs.
"""

from __future__ import annotations

from itertools import groupby
from pathlib import Path

import pytest
from support.rs274 import RS274, moves_of, rows_of, run
from support.rs274_blocks import Recorded, answers, recorded
from support.rs274_compare import first_difference, lasting, our_moves, our_moves_of_text, settings_of, timed
from support.rs274_programs import mutated, write_tables
from support.rs274_snippets import FLAT, program

from gcode.errors import GcodeError
from gcode.settings import MachineSettings

needs_rs274 = pytest.mark.skipif(RS274 is None, reason="rs274 is not installed")
CASES = {about: list(cases) for about, cases in groupby(recorded(), key=lambda case: case.about)}
#: Every so many of the recorded blocks is asked again.
ASKED_AGAIN = 23


@pytest.fixture(scope="module")
def at_zero(tmp_path_factory: pytest.TempPathFactory) -> MachineSettings:
    return settings_of(*write_tables(tmp_path_factory.mktemp("tables"), at_zero=True))


def difference(case: Recorded, settings: MachineSettings) -> str:
    """How we do other than recorded; empty where we do the same."""
    try:
        ours = our_moves_of_text(case.program, settings)
    except GcodeError as error:
        return "" if case.moves is None else f"refused: {error}"
    return "runs" if case.moves is None else first_difference(timed(case.moves), timed(ours))


@pytest.mark.parametrize("about", CASES)
def test_blocks_do_what_they_do_there(about: str, at_zero: MachineSettings) -> None:
    said = {case.block: difference(case, at_zero) for case in CASES[about] if not case.ours}
    assert not {block: what for block, what in said.items() if what}


def test_where_we_differ_on_purpose_we_do(at_zero: MachineSettings) -> None:
    meant = [case for cases in CASES.values() for case in cases if case.ours]
    assert not [case.block for case in meant if not difference(case, at_zero)]


@needs_rs274
def test_the_record_is_true() -> None:
    cases = recorded()[::ASKED_AGAIN]
    for case, moves in zip(cases, answers(case.block for case in cases), strict=True):
        assert (moves is None) == (case.moves is None), case.block
        assert not first_difference(moves or (), case.moves or ()), case.block


def assert_same(text: str, folder: Path) -> None:
    table, parameters = write_tables(folder)
    path = folder / "program.ngc"
    path.write_text(text)
    settings = settings_of(table, parameters)
    listing = run(path, table=table, parameters=parameters)
    if listing.error and not listing.open_end:
        with pytest.raises(GcodeError):
            our_moves(path, settings)
        return
    theirs, ours = moves_of(listing.calls, rows_of(table)), our_moves(path, settings)
    assert not first_difference(timed(theirs), timed(ours))


@needs_rs274
@pytest.mark.parametrize("seed", range(40))
def test_random_programs(seed: int, tmp_path: Path) -> None:
    assert_same(program(seed), tmp_path)


@needs_rs274
@pytest.mark.parametrize("seed", range(30))
def test_programs_with_a_mistake(seed: int, tmp_path: Path) -> None:
    assert_same(mutated(program(seed, 12, FLAT), seed), tmp_path)


def test_motions_of_no_length_can_be_left_out() -> None:
    moves = moves_of(
        [("STRAIGHT_FEED", "1.0, 0.0, 0.0, 0.0, 0.0, 0.0")] * 2 + [("DWELL", "0.0000"), ("DWELL", "1.0000")]
    )
    assert [move.kind for move in lasting(moves)] == ["feed", "dwell"]
