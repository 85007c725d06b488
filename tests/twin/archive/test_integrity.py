"""Damage is noticed wherever it is: in frames, counts, checksums, and where a whole chunk is missing."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from mcap.opcode import Opcode

from twin.archive import export_forces, read_run, run_info, run_writer
from twin.archive.container.frames import FOOTER_BYTES
from twin.cli import run
from twin.errors import ArchiveError
from twin.record import Record
from twin.run.run import Run


@pytest.fixture
def records(run_records: list[Record]) -> list[Record]:
    """The beginning of a run, and its summary."""
    return [*run_records[:15], run_records[-1]]


@pytest.fixture
def data(records: list[Record], write: Callable[..., Path], monkeypatch: pytest.MonkeyPatch) -> bytes:
    """A run in several chunks."""
    monkeypatch.setattr(run_writer, "CHUNK_BYTES", 700)
    return write(records).read_bytes()


def frames(data: bytes) -> Iterator[tuple[int, int, int]]:
    """Position, opcode and end of each record."""
    at = 8
    while at + 9 < len(data):
        end = at + 9 + int.from_bytes(data[at + 1 : at + 9], "little")
        yield at, data[at], end
        at = end


def chunks(data: bytes) -> list[tuple[int, int]]:
    return [(at, end) for at, opcode, end in frames(data) if opcode == Opcode.CHUNK]


def without_end(data: bytes) -> bytes:
    """As the file of a killed run: no end of data, no index, no footer."""
    return data[: next(at for at, opcode, _ in frames(data) if opcode == Opcode.METADATA and at > chunks(data)[-1][0])]


def opcode_flipped(data: bytes, at: int, end: int) -> bytes:
    return data[:at] + bytes([data[at] | 0x80]) + data[at + 1 :]


def length_flipped(data: bytes, at: int, end: int) -> bytes:
    return data[: at + 7] + bytes([data[at + 7] ^ 1]) + data[at + 8 :]


def length_too_short(data: bytes, at: int, end: int) -> bytes:
    length = end - at - 9
    return data[: at + 1] + (length & ~(1 << length.bit_length() - 1)).to_bytes(8, "little") + data[at + 9 :]


def removed(data: bytes, at: int, end: int) -> bytes:
    return data[:at] + data[end:]


DAMAGE = (opcode_flipped, length_flipped, length_too_short, removed)


@pytest.mark.parametrize("whole", [True, False], ids=["closed", "killed"])
@pytest.mark.parametrize("damage", DAMAGE, ids=lambda f: f.__name__)
def test_a_damaged_frame_of_a_chunk_is_an_error(
    data: bytes, damage: Callable[..., bytes], whole: bool, tmp_path: Path
) -> None:
    path = tmp_path / "run.mcap"
    original = data if whole else without_end(data)
    path.write_bytes(original)
    assert run_info(path).damage is None
    at, end = chunks(original)[2]
    path.write_bytes(damage(original, at, end))
    info = run_info(path)
    assert info.damage is not None and info.damage.startswith(f"{path}: damaged at byte ")
    assert (info.intact, info.complete) == (False, False)
    for use in (lambda: list(read_run(path)), lambda: export_forces(path, tmp_path / "f.csv"), lambda: Run(path)):
        with pytest.raises(ArchiveError, match=r"run.mcap: damaged at byte \d+"):
            use()
    assert [p.name for p in tmp_path.iterdir()] == ["run.mcap"]


def test_every_flipped_bit_is_an_error_or_changes_nothing(
    data: bytes, same: Callable[..., None], records: list[Record], tmp_path: Path
) -> None:
    """With `verify` every one is found. Bytes outside the chunks' data, which have a checksum of their own."""
    path = tmp_path / "run.mcap"
    inside = {i for at, end in chunks(data) for i in range(at + 60, end - 1)}
    outside = [i for i in range(8, len(data)) if i not in inside]
    for position in random.Random(1).sample(outside, 120):
        bit = 1 << position % 8
        path.write_bytes(data[:position] + bytes([data[position] ^ bit]) + data[position + 1 :])
        try:
            assert run_info(path, verify=True).intact is False, position
            same(list(read_run(path)), records)
        except ArchiveError as error:
            assert str(error).startswith(f"{path}: ")


@pytest.mark.parametrize(
    ("at_end", "problem"),
    [(b"\x89MCAP0\r\x0b", r"damaged at byte \d+: expected the end of the file"), (b"\x89MCAP", None), (b"", None)],
    ids=["flipped", "cut within", "cut before"],
)
def test_the_closing_magic(data: bytes, at_end: bytes, problem: str | None, tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    path.write_bytes(data[:-8] + at_end)
    info = run_info(path)
    assert not info.intact
    if problem is None:
        assert info.damage is None
        assert len(list(read_run(path))) > 10
    else:
        with pytest.raises(ArchiveError, match=problem):
            list(read_run(path))


@pytest.mark.parametrize("bit", range(8))
def test_a_footer_that_is_another_record_is_damage(data: bytes, bit: int, tmp_path: Path) -> None:
    at = len(data) - FOOTER_BYTES
    (tmp_path / "run.mcap").write_bytes(data[:at] + bytes([data[at] ^ 1 << bit]) + data[at + 1 :])
    with pytest.raises(ArchiveError, match=rf"damaged at byte {at}: "):
        list(read_run(tmp_path / "run.mcap"))


def test_zeros_before_further_records_are_damage(data: bytes, tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    at, end = chunks(data)[1]
    path.write_bytes(without_end(data)[:at] + bytes(end - at) + without_end(data)[end:])
    with pytest.raises(ArchiveError, match=rf"damaged at byte {at}: zeros in place of a record$"):
        list(read_run(path))


def test_info_states_damage(data: bytes, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "run.mcap"
    at, end = chunks(data)[2]
    path.write_bytes(opcode_flipped(data, at, end))
    assert run(["info", str(path)]) == 1
    printed = capsys.readouterr()
    assert "damaged: readable up to the damage" in printed.out
    assert printed.err == f"error: {path}: damaged at byte {at}: a record of the unknown kind 0x86\n"
    assert run(["info", str(path), "--json"]) == 1
    assert f'"damage": "{path}: damaged at byte {at}' in capsys.readouterr().out


def test_verify_reads_everything(data: bytes, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "run.mcap"
    path.write_bytes(data)
    assert run(["info", "--verify", str(path)]) == 0
    assert "complete; every record and checksum verified" in capsys.readouterr().out
    (first, *_) = (end for _, opcode, end in frames(data) if opcode == Opcode.MESSAGE_INDEX)
    path.write_bytes(data[: first - 1] + b"\x01" + data[first:])  # no reader of the records needs this byte
    assert run(["info", str(path)]) == 0
    capsys.readouterr()
    assert run(["info", "--verify", str(path)]) == 1
    assert capsys.readouterr().err.endswith(": the checksum of all data is wrong\n")


def test_what_is_read_of_a_run_that_ends_early_is_stated(
    data: bytes, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "run.mcap"
    path.write_bytes(data[: len(data) // 2])
    assert run(["export", str(path), str(tmp_path / "f.csv")]) == 0
    warning = f"warning: {path}: ends early; what it has up to there is used\n"
    assert capsys.readouterr().err == warning
    (log := tmp_path / "log.csv").write_text("Fx,Fy\n")
    assert run(["compare", str(path), str(log)]) == 1
    assert capsys.readouterr().err.startswith(warning)
