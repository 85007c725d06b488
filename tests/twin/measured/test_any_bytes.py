"""Whatever a text holds, reading it as a log gives a log or one error of this program.

Damaged files of every format are in ``tests/test_fuzz.py``.
"""

from __future__ import annotations

from pathlib import Path

from hypothesis import given, settings
from hypothesis import strategies as st
from support.fuzz.targets import assert_sound

from twin.errors import MeasuredError
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
        assert_sound(log)
    except MeasuredError as error:
        assert str(error).startswith("log.txt")
