"""Files of compiled code: whole or missing, in a folder that can be trusted, removed when they are old."""

from __future__ import annotations

import logging
import os
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from twin.jit.store import DAYS_KEPT, Root, Store, roots

POSIX = pytest.mark.skipif(os.name != "posix", reason="permissions of POSIX")
DAY_S = 86400.0


def store_in(*folders: Path, private: bool = True) -> Store:
    return Store(tuple(Root(path=folder, private=private) for folder in folders))


def only_file(folder: Path) -> Path:
    return next(p for p in folder.rglob("*") if p.is_file())


def blocked(folder: Path) -> Path:
    """A folder that cannot be created, whoever tries: its parent is a file."""
    folder.mkdir()
    (folder / "file").write_text("")
    return folder / "file" / "kernels"


def test_what_was_written_is_read(tmp_path: Path) -> None:
    store_in(tmp_path).write("1.0/module-abc", "f.code", b"contents")
    assert store_in(tmp_path).read("1.0/module-abc", "f.code") == b"contents"
    assert store_in(tmp_path).read("1.0/module-abd", "f.code") is None
    assert store_in(tmp_path).read("1.1/module-abc", "f.code") is None


@pytest.mark.parametrize("cut", [0, 1, 31, 32, 35], ids="{} bytes".format)
def test_a_file_that_was_cut_off_is_missing(tmp_path: Path, cut: int) -> None:
    store_in(tmp_path).write("1.0/m", "f", b"contents")
    file = only_file(tmp_path)
    file.write_bytes(file.read_bytes()[:cut])
    assert store_in(tmp_path).read("1.0/m", "f") is None
    store_in(tmp_path).write("1.0/m", "f", b"again")
    assert store_in(tmp_path).read("1.0/m", "f") == b"again"


def test_a_damaged_file_is_missing(tmp_path: Path) -> None:
    store_in(tmp_path).write("1.0/m", "f", b"contents")
    file = only_file(tmp_path)
    file.write_bytes(file.read_bytes().replace(b"ten", b"tin"))
    assert store_in(tmp_path).read("1.0/m", "f") is None


def test_writers_at_the_same_time_leave_one_whole_file(tmp_path: Path) -> None:
    texts = [bytes([65 + i]) * 100_000 for i in range(8)]
    with ThreadPoolExecutor(8) as pool:
        list(pool.map(lambda text: store_in(tmp_path).write("1.0/m", "f", text), texts * 4))
    assert store_in(tmp_path).read("1.0/m", "f") in texts
    assert [p.name for p in (tmp_path / "1.0" / "m").iterdir()] == ["f"]


def test_where_the_first_folder_cannot_be_written_the_second_is_used(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    first, second = blocked(tmp_path / "home"), tmp_path / "second"
    files = store_in(first, second)
    for name in ("f", "g"):
        files.write("1.0/m", name, b"contents")
    assert caplog.messages == [
        f"{first} cannot be written: compiled code is kept in {second}; NUMBA_CACHE_DIR sets another folder"
    ]
    caplog.clear()
    assert store_in(first, second).read("1.0/m", "f") == b"contents"
    assert caplog.messages == []  # found: nothing to report


def test_where_nothing_can_be_written_nothing_is_kept(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    first, second = blocked(tmp_path / "home"), blocked(tmp_path / "second")
    files = store_in(first, second)
    files.write("1.0/m", "f", b"contents")
    files.write("1.0/m", "g", b"contents")
    assert files.read("1.0/m", "f") is None
    assert caplog.messages == [
        f"{first} cannot be written: compiled code is not kept; NUMBA_CACHE_DIR sets another folder"
    ]


def test_the_report_is_one_line_on_standard_error(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    root = logging.getLogger()
    handlers, root.handlers = root.handlers, []  # as in a program that sets up no logging
    try:
        store_in(blocked(tmp_path / "home"), tmp_path / "second").write("1.0/m", "f", b"")
    finally:
        root.handlers = handlers
    assert capsys.readouterr().err.count("\n") == 1


@POSIX
def test_a_private_folder_is_made_for_this_user_alone(tmp_path: Path) -> None:
    folder = tmp_path / "kernels"
    store_in(folder).write("1.0/m", "f", b"")
    assert folder.stat().st_mode & 0o777 == 0o700


@POSIX
def test_code_that_others_may_have_written_is_not_read(tmp_path: Path) -> None:
    folder = tmp_path / "kernels"
    store_in(folder).write("1.0/m", "f", b"contents")
    folder.chmod(0o777)
    assert store_in(folder).read("1.0/m", "f") is None
    assert store_in(folder, private=False).read("1.0/m", "f") == b"contents"  # named by the user
    folder.chmod(0o755)
    assert store_in(folder).read("1.0/m", "f") == b"contents"


@POSIX
def test_a_link_to_a_folder_is_not_trusted(tmp_path: Path) -> None:
    store_in(tmp_path / "theirs").write("1.0/m", "f", b"contents")
    (tmp_path / "kernels").symlink_to(tmp_path / "theirs")
    assert store_in(tmp_path / "kernels").read("1.0/m", "f") is None


@POSIX
def test_a_folder_of_another_user_is_not_trusted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    store_in(tmp_path).write("1.0/m", "f", b"contents")
    monkeypatch.setattr(os, "geteuid", lambda: tmp_path.stat().st_uid + 1)
    assert store_in(tmp_path).read("1.0/m", "f") is None


def age(folder: Path, days: float) -> None:
    then = time.time() - days * DAY_S
    os.utime(folder, (then, then))


def test_folders_that_were_not_used_are_removed_at_the_next_writing(tmp_path: Path) -> None:
    for folder in ("0.9/m-a", "1.0/m-a", "1.0/m-b"):
        store_in(tmp_path).write(folder, "f", b"contents")
    age(tmp_path / "0.9" / "m-a", DAYS_KEPT + 1)
    age(tmp_path / "1.0" / "m-a", DAYS_KEPT + 1)
    age(tmp_path / "1.0" / "m-b", DAYS_KEPT - 1)
    store_in(tmp_path).write("1.1/m-c", "f", b"contents")
    assert sorted(p.relative_to(tmp_path).as_posix() for p in tmp_path.glob("*/*")) == ["1.0/m-b", "1.1/m-c"]
    assert sorted(p.name for p in tmp_path.iterdir()) == ["1.0", "1.1"]


def test_reading_counts_as_use(tmp_path: Path) -> None:
    store_in(tmp_path).write("1.0/m-a", "f", b"contents")
    age(tmp_path / "1.0" / "m-a", DAYS_KEPT + 1)
    assert store_in(tmp_path).read("1.0/m-a", "f") == b"contents"
    store_in(tmp_path).write("1.0/m-b", "f", b"contents")
    assert store_in(tmp_path).read("1.0/m-a", "f") == b"contents"


def test_a_folder_removed_by_another_process_is_made_again(tmp_path: Path) -> None:
    files = store_in(tmp_path)
    files.write("1.0/m-a", "f", b"contents")
    assert files.read("1.0/m-a", "f") == b"contents"
    store_in(tmp_path).write("1.0/m-b", "f", b"")
    age(tmp_path / "1.0" / "m-a", DAYS_KEPT + 1)
    store_in(tmp_path).write("1.0/m-b", "g", b"")
    assert files.read("1.0/m-a", "f") is None
    files.write("1.0/m-a", "f", b"contents")
    assert files.read("1.0/m-a", "f") == b"contents"


def test_what_a_removal_left_behind_is_removed(tmp_path: Path) -> None:
    (tmp_path / "removed-1" / "half").mkdir(parents=True)
    store_in(tmp_path).write("1.0/m", "f", b"")
    assert [p.name for p in tmp_path.iterdir()] == ["1.0"]


def test_the_users_cache_folder_and_the_one_that_is_named(tmp_path: Path) -> None:
    usual, spare = roots("")
    assert usual.private
    assert spare.private
    assert usual.path.parts[-2:] == ("machining-twin", "kernels") or os.name == "nt"
    named, _ = roots(str(tmp_path))
    assert named == Root(path=tmp_path / "machining-twin", private=False)
