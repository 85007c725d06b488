"""Bytes, text and JSON of a library file, with one clear error for each thing that can be wrong with them."""

from __future__ import annotations

import codecs
import io
import json
import zipfile
import zlib
from pathlib import Path
from typing import Any

from twin.errors import ToolLibraryError

#: Largest library, packed or unpacked, bytes.
_LARGEST = 64_000_000
_MEMBER = "tools.json"
_MARKS = (
    (codecs.BOM_UTF8, "utf-8-sig"),
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)


def read_bytes(path: Path) -> bytes:
    """A file's bytes.

    Raises:
        ToolLibraryError: it cannot be read, is empty, or is too large.
    """
    try:
        with path.open("rb") as file:
            data = file.read(_LARGEST + 1)
    except (OSError, ValueError) as error:  # ValueError: a name with a zero byte
        why = (getattr(error, "strerror", None) or str(error)).lower()
        raise ToolLibraryError(f"{path}: cannot be read: {why}; expected a tool library") from error
    if len(data) > _LARGEST:
        raise ToolLibraryError(f"{path}: larger than {_LARGEST // 1_000_000} MB; expected a tool library")
    if not data.strip():
        raise ToolLibraryError(f"{path}: the file is empty; expected a tool library")
    return data


def unpacked(data: bytes, path: Path) -> bytes:
    """The list of tools in a packed library (``.tools``).

    Raises:
        ToolLibraryError: no such member, a damaged or encrypted file, or one that unpacks to too much.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as packed:
            names = [name for name in packed.namelist() if name.rpartition("/")[2].lower() == _MEMBER]
            if not names:
                held = ", ".join(packed.namelist()[:3]) or "nothing"
                raise ToolLibraryError(f"{path}: the zip file holds {held}; expected {_MEMBER}")
            with packed.open(names[0]) as member:
                text = member.read(_LARGEST + 1)
    except (zipfile.BadZipFile, zlib.error, EOFError, OSError, ValueError, RuntimeError) as error:
        # RuntimeError: encrypted; NotImplementedError, one of its kind: an unknown compression
        raise ToolLibraryError(f"{path}: the zip file is damaged or encrypted ({error}); expected {_MEMBER}") from error
    if len(text) > _LARGEST:
        size = f"{_LARGEST // 1_000_000} MB"
        raise ToolLibraryError(f"{path}: {_MEMBER} unpacks to more than {size}; expected a tool library")
    return text


def text_of(data: bytes, path: Path, *, legacy: bool = False) -> str:
    """A text in UTF-8, or in the encoding that its first bytes state.

    Args:
        legacy: take Windows-1252 for a text that is not UTF-8.

    Raises:
        ToolLibraryError: not a text.
    """
    encoding = next((name for mark, name in _MARKS if data.startswith(mark)), "utf-8")
    try:
        return data.decode(encoding)
    except UnicodeDecodeError as error:
        if legacy and b"\0" not in data:
            return data.decode("cp1252", "replace")
        line = data.count(b"\n", 0, error.start) + 1
        found = f"byte 0x{data[error.start]:02x} in line {line} is not {encoding.removesuffix('-sig').upper()}"
        raise ToolLibraryError(f"{path}: {found}; expected a tool library as text") from error


def json_of(data: bytes, path: Path) -> Any:
    """The value of a JSON file.

    Raises:
        ToolLibraryError: not JSON; the message has line and column.
    """
    text = text_of(data, path)
    try:
        return json.loads(text)
    except json.JSONDecodeError as error:
        position = f"{path}:{error.lineno}:{error.colno}"
        why = error.msg[:1].lower() + error.msg[1:]
        raise ToolLibraryError(f"{position}: not valid JSON: {why}; the file is damaged or not a library") from error
    except (ValueError, RecursionError) as error:
        what = "nested too deeply" if isinstance(error, RecursionError) else "a number with too many digits"
        raise ToolLibraryError(f"{path}: {what}; expected a tool library") from error
