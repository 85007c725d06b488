"""A reader that ends, hangs or takes all memory is one error of this process."""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from twin.errors import MeasuredError
from twin.measured.formats import isolated as door
from twin.measured.formats.isolated import isolated
from twin.measured.table import Table, table

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="readers have their own process on Linux only")


@pytest.fixture
def path(tmp_path: Path) -> Path:
    (tmp_path / "a.h5").write_bytes(b"abc")
    return tmp_path / "a.h5"


def made(path: Path) -> Table:
    return table(path, "HDF5", [("Fx", "N", np.arange(5.0))], notes=["a note"])


def test_the_table_comes_back_whole(path: Path) -> None:
    found = isolated(path, lambda: made(path), "h5py")
    assert found.values[:, 0].tolist() == [0.0, 1.0, 2.0, 3.0, 4.0]
    assert (found.names, found.units, found.notes) == (("Fx",), ("N",), ("a note",))


def killed() -> Table:
    os.kill(os.getpid(), signal.SIGSEGV)
    raise AssertionError


def hanging() -> Table:
    time.sleep(60.0)
    raise AssertionError


def greedy() -> Table:
    np.ones(1 << 40)
    raise AssertionError


def refusing() -> Table:
    raise MeasuredError("a.h5: no columns")


def failing() -> Table:
    raise KeyError("field")


@pytest.mark.parametrize(
    ("read", "message"),
    [
        (killed, "a.h5: cannot be read: the reader ended by SIGSEGV; the file is damaged"),
        (hanging, "a.h5: cannot be read: no end after 0 s; the file is damaged"),
        (greedy, "a.h5: cannot be read: it needs more memory than such a file may; the file is damaged"),
        (refusing, "a.h5: no columns"),
        (failing, "a.h5: cannot be read: 'field'"),
    ],
)
def test_whatever_a_reader_does(
    read: Callable[[], Table], message: str, path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(door, "_LEAST_S", 0.3 if read is hanging else 15.0)
    with pytest.raises(MeasuredError) as caught:
        isolated(path, read, "h5py")
    assert str(caught.value).endswith(message)
