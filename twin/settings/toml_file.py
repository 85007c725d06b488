"""TOML files in, with one clear error for each thing that can be wrong with the text."""

from __future__ import annotations

import codecs
import re
import tomllib
from pathlib import Path
from typing import Any

from twin.errors import SettingsError
from twin.settings.file_kinds import kind_by_suffix, kind_by_text, other_kind
from twin.settings.toml_hints import hint

_UTF16 = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
#: Characters of a line for which a correction is proposed, at most; patterns take longest on long runs of digits.
_LONGEST_HINTED = 300
_POSITION = re.compile(r" \(at (?:line (\d+), column (\d+)|end of document)\)$")


def read_toml(
    path: Path, what: str = "settings", refuse: type[SettingsError] = SettingsError, own: str | None = None
) -> tuple[dict[str, Any], str]:
    """A TOML file's tables and its text.

    Args:
        what: what the file should be, for the message.
        refuse: the error for a file that cannot be read.
        own: a table that only this kind of file has; a file of another kind is refused with its own command.

    Raises:
        SettingsError: ``refuse``: not readable, not UTF-8, of another kind, or, with line and column, not TOML.
    """
    kind = kind_by_suffix(path) if path.is_file() else None
    if kind is None:
        text = read_text(path, f"{what} (TOML)", refuse)
        try:
            data = parse_toml(text, str(path), refuse)
        except SettingsError as error:
            kind = kind_by_text(path, text)
            if kind is None:
                raise
            raise _not_this(path, kind, what, refuse) from error
        kind = other_kind(path, data, own) if own is not None else None
        if kind is None:
            return data, text
    raise _not_this(path, kind, what, refuse)


def _not_this(path: Path, kind: str, what: str, refuse: type[SettingsError]) -> SettingsError:
    return refuse(str(path), [f"is not {what} but {kind}"])


def read_text(path: Path, what: str, refuse: type[SettingsError] = SettingsError) -> str:
    """A file's text.

    Raises:
        SettingsError: ``refuse``: not readable or not UTF-8.
    """
    try:
        return path.read_bytes().decode("utf-8-sig")
    except OSError as error:
        why = (error.strerror or str(error)).lower()
        raise refuse(str(path), [f"cannot be read: {why}; expected {what}"]) from error
    except UnicodeDecodeError as error:
        raise refuse(str(path), [f"{_encoding_of(error)}; expected {what} in UTF-8"]) from error


def _encoding_of(error: UnicodeDecodeError) -> str:
    """The encoding that a text has instead of UTF-8, or the byte that shows that it has another one."""
    for marks, name in (((codecs.BOM_UTF32_LE, codecs.BOM_UTF32_BE), "UTF-32"), (_UTF16, "UTF-16")):
        if bytes(error.object).startswith(marks):
            return f"the text is in {name}"
    line = bytes(error.object).count(b"\n", 0, error.start) + 1
    return f"byte 0x{error.object[error.start]:02x} in line {line} is not UTF-8"


def parse_toml(text: str, source: str, refuse: type[SettingsError] = SettingsError) -> dict[str, Any]:
    """The tables of a TOML text.

    Args:
        source: its file, for the message.

    Raises:
        SettingsError: ``refuse``, with line and column of what is not TOML.
    """
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise _syntax_error(source, text, str(error), refuse) from error
    except (ValueError, RecursionError) as error:
        what = "it is nested too deeply" if isinstance(error, RecursionError) else "a number has too many digits"
        raise refuse(source, [f"not valid TOML: {what}"]) from error


def _syntax_error(source: str, text: str, message: str, refuse: type[SettingsError]) -> SettingsError:
    """TOML's complaint with the position in front."""
    lines = text.splitlines() or [""]
    position = _POSITION.search(message)
    end = (len(lines), len(lines[-1]) + 1)
    line, column = end if position is None or position[1] is None else map(int, position.groups())
    what = _POSITION.sub("", message)
    written = hint(lines[line - 1]) if line <= len(lines) and len(lines[line - 1]) <= _LONGEST_HINTED else None
    more = f"; {written}" if written is not None else ""
    return refuse(f"{source}:{line}:{column}", [f"not valid TOML: {what[:1].lower()}{what[1:]}{more}"])
