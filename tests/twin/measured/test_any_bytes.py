"""Whatever a file holds, reading it gives a log or one error of this program."""

from __future__ import annotations

import random
import warnings
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.measured_files import FORMATS

from twin.errors import MeasuredError
from twin.measured.forces import force_log
from twin.measured.log import RawLog
from twin.measured.read import read_log
from twin.measured.settings import LogReading
from twin.measured.text.reader import parse_text
from twin.measured.time_column import raw_log

CHARACTERS = st.sampled_from(list("0123456789.,;:\t -+eE#%\"'[]()/abcFxyztNs\n\n\n"))


def sound(log: RawLog) -> None:
    """What every log that was read keeps."""
    assert len(log.t_s) >= 1 and np.isfinite(log.t_s).all()
    assert (np.diff(log.t_s) > 0.0).all()
    assert 0.0 < log.rate_hz < np.inf
    assert all(len(c.values) == len(log.t_s) for c in log.columns.values())


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
    for turn in range(12):
        data = bytearray(whole)
        if turn % 2:
            del data[rng.randrange(len(data)) :]
        else:
            for _ in range(6):
                data[rng.randrange(len(data))] = rng.randrange(256)
        (tmp_path / file).write_bytes(data)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                sound(read_log(tmp_path / file))
        except MeasuredError as error:
            assert file in str(error)
