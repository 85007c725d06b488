"""Files of compiled code: where they are kept, how they are checked, and when old ones are removed.

A file is read only when its checksum is right, and written under a temporary name first: a file that was cut off or
damaged counts as missing. One file holds one signature of one function, and there is no index, so that processes may
write at the same time.
"""

from __future__ import annotations

import contextlib
import hashlib
import logging
import os
import shutil
import stat
import tempfile
import time
import uuid
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import platformdirs

#: Folders that were not used for this long are removed.
DAYS_KEPT = 30
_NAME = "machining-twin"
_REMOVED = "removed-"
_DAY_S = 86400.0
_CHECKSUM = hashlib.sha256
_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True, kw_only=True)
class Root:
    """A folder that may hold compiled code.

    Attributes:
        path: the folder; it need not exist.
        private: use it only if it belongs to this user and no one else may write to it. Its files are unpickled, so
            they can run code.
    """

    path: Path
    private: bool

    def usable(self) -> bool:
        """Whether the folder exists and may be trusted."""
        try:
            found = self.path.lstat()
        except OSError:
            return False
        if not self.private:
            return self.path.is_dir()
        mine = not hasattr(os, "geteuid") or found.st_uid == os.geteuid()
        open_to_others = os.name == "posix" and bool(found.st_mode & (stat.S_IWGRP | stat.S_IWOTH))
        return stat.S_ISDIR(found.st_mode) and mine and not open_to_others

    def make(self) -> None:
        """Create the folder.

        Raises:
            OSError: it cannot be created, or may not be trusted.
        """
        self.path.mkdir(mode=0o700, parents=True, exist_ok=True)
        if not self.usable():
            raise PermissionError(f"{self.path} does not belong to this user alone")


def roots(named: str) -> tuple[Root, Root]:
    """The folder for compiled code and the one to fall back to when it cannot be written.

    Args:
        named: the folder that ``NUMBA_CACHE_DIR`` names, or an empty string.
    """
    usual = Path(platformdirs.user_cache_dir(_NAME, appauthor=False)) / "kernels"
    first = Root(path=Path(named) / _NAME, private=False) if named else Root(path=usual, private=True)
    user = str(os.getuid()) if hasattr(os, "getuid") else "kernels"
    return first, Root(path=Path(tempfile.gettempdir()) / f"{_NAME}-{user}", private=True)


class Store:
    """Files of compiled code, in folders named by version, module, and hash of the sources.

    Args:
        roots: folders to read from, and to write to: the first one that can be written.
    """

    def __init__(self, roots: tuple[Root, ...]) -> None:
        self._roots = roots
        self._used: set[Path] = set()
        self._reported = False
        self._cleaned = False

    def path(self, folder: str) -> Path:
        """Where a folder should be."""
        return self._roots[0].path / folder

    def make(self, folder: str) -> Path | None:
        """Create a folder; None, with a report, where none can be written."""
        return self._write(folder, "used", b"")

    def read(self, folder: str, name: str) -> bytes | None:
        """The contents of a file; None when it is missing or damaged."""
        for root in self._roots:
            path = root.path / folder / name
            if not path.is_file() or not root.usable():
                continue
            with contextlib.suppress(OSError):
                self._mark_used(path.parent)
                data = path.read_bytes()
                size = _CHECKSUM().digest_size
                if _CHECKSUM(data[size:]).digest() == data[:size]:
                    return data[size:]
        return None

    def write(self, folder: str, name: str, contents: bytes) -> None:
        """Write a file as a whole; where no folder can be written, report it and do without."""
        self._write(folder, name, _CHECKSUM(contents).digest() + contents)

    def _write(self, folder: str, name: str, data: bytes) -> Path | None:
        for root in self._roots:
            try:
                root.make()
                _write_whole(root.path / folder, name, data)
            except OSError:
                continue
            self._report(root.path)
            self._clean(root.path)
            return root.path / folder
        self._report(None)
        return None

    def _report(self, written: Path | None) -> None:
        """One line, once, if compiled code is not kept where it should be."""
        wanted = self._roots[0].path
        if written == wanted or self._reported:
            return
        self._reported = True
        kept = f"compiled code is kept in {written}" if written else "compiled code is not kept"
        _log.warning("%s cannot be written: %s; NUMBA_CACHE_DIR sets another folder", wanted, kept)

    def _mark_used(self, folder: Path) -> None:
        """Set the folder's time to now, to the day, once per process."""
        if folder not in self._used:
            self._used.add(folder)
            if time.time() - folder.stat().st_mtime > _DAY_S:
                with contextlib.suppress(OSError):
                    os.utime(folder)

    def _clean(self, root: Path) -> None:
        """Remove what was not used for `DAYS_KEPT` days, once per process.

        A folder is renamed first, so that another process sees all of it or nothing, and compiles again at worst.
        """
        if self._cleaned:
            return
        self._cleaned = True
        for folder in _unused(root, time.time() - DAYS_KEPT * _DAY_S):
            with contextlib.suppress(OSError):
                removed = root / f"{_REMOVED}{uuid.uuid4().hex}"
                folder.rename(removed)
                shutil.rmtree(removed, ignore_errors=True)
        for left_over in root.glob(f"{_REMOVED}*"):
            shutil.rmtree(left_over, ignore_errors=True)
        for version in root.iterdir():
            with contextlib.suppress(OSError):
                version.rmdir()  # only if it is empty


def _unused(root: Path, since_s: float) -> Iterator[Path]:
    for folder in root.glob("*/*"):
        with contextlib.suppress(OSError):
            if folder.is_dir() and folder.stat().st_mtime < since_s:
                yield folder


def _write_whole(folder: Path, name: str, data: bytes) -> None:
    """Write under a temporary name and rename, so that no one reads an incomplete file.


    Raises:
        OSError: the folder cannot be written, or the disk is full.
    """
    for last in (False, True):
        try:
            folder.mkdir(mode=0o700, parents=True, exist_ok=True)
            break
        except FileNotFoundError:  # another process removed the empty folder above it
            if last:
                raise
    partial = folder / f"{uuid.uuid4().hex}.partial"
    try:
        partial.write_bytes(data)
        partial.replace(folder / name)
    except OSError:
        with contextlib.suppress(OSError):
            partial.unlink()
        raise


@lru_cache(maxsize=4)
def store(named: str) -> Store:
    """The process's store for a value of ``NUMBA_CACHE_DIR``."""
    return Store(roots(named))
