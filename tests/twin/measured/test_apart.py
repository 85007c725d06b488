"""Libraries that crash or never end on a damaged file end a copy of the process only."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
import pytest

from twin.errors import MeasuredError
from twin.measured import apart
from twin.measured.apart import read_apart

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="only there")


@pytest.fixture
def path(tmp_path: Path) -> Path:
    (made := tmp_path / "log.h5").write_bytes(b"x")
    return made


def crashed(_path: Path) -> NoReturn:
    os.kill(os.getpid(), signal.SIGSEGV)
    raise AssertionError


def never_ends(_path: Path) -> NoReturn:
    while True:
        pass


def fails(_path: Path) -> NoReturn:
    raise RuntimeError("of a library")


def test_what_was_read_comes_back(path: Path) -> None:
    found = read_apart(lambda file: {"name": file.name, "values": np.arange(3.0)}, path)
    assert found["name"] == "log.h5" and found["values"].tolist() == [0.0, 1.0, 2.0]


def test_a_refusal_comes_back(path: Path) -> None:
    def refuse(file: Path) -> NoReturn:
        raise MeasuredError(f"{file}: holds no log")

    with pytest.raises(MeasuredError, match=r"log\.h5: holds no log$"):
        read_apart(refuse, path)


@pytest.mark.parametrize(
    ("read", "problem"),
    [
        (crashed, "the library that reads it ended with SIGSEGV"),
        (never_ends, "reading it takes more than 0 s"),
        (fails, "the library that reads it failed"),
    ],
)
def test_a_library_that_fails_is_one_message(
    read: Callable[[Path], Any], problem: str, path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(apart, "_FREE_S", 0)
    with pytest.raises(MeasuredError) as error:
        read_apart(read, path)
    assert str(error.value) == f"{path}: the file is damaged: {problem}"
