"""Whatever a file holds, reading it gives a log or one error of this program."""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.fuzz_logs import mutated, read_or_refuse, sound
from support.measured_files import FORMATS

from twin.errors import MeasuredError
from twin.measured.forces import force_log
from twin.measured.settings import LogReading
from twin.measured.text.reader import parse_text
from twin.measured.time_column import raw_log

CHARACTERS = st.sampled_from(list("0123456789.,;:\t -+eE#%\"'[]()/abcFxyztNs\n\n\n"))


@settings(max_examples=300)
@given(st.lists(CHARACTERS, max_size=120).map("".join))
def test_any_text(text: str) -> None:
    path = Path("log.txt")
    try:
        log = raw_log(path, parse_text(path, text), LogReading(rate_hz=1000.0 if "e" in text else None))
        sound(log)
        force_log(log)
    except MeasuredError as error:
        assert str(error).startswith("log.txt")


@pytest.mark.parametrize("name", FORMATS)
def test_damaged_files(name: str, tmp_path: Path) -> None:
    file, write, _ = FORMATS[name]
    write(tmp_path / file)
    whole = (tmp_path / file).read_bytes()
    rng = random.Random(5)
    for _ in range(12):
        (tmp_path / file).write_bytes(mutated(whole, rng))
        assert read_or_refuse(tmp_path / file) in ("read", "no forces", "refused")
