"""Corrections of lines that are not TOML: the mistakes of first-time users."""

from __future__ import annotations

import re
from collections.abc import Callable

_KEY = r"([\w.-]+)\s*=\s*"
_END = r"\s*,?\s*(?:#.*)?$"
#: Patterns of a line, the first that fits counts, and what to write.
_HINTS: tuple[tuple[re.Pattern[str], Callable[[re.Match[str]], str]], ...] = (
    (
        re.compile(_KEY + r"(?!\d{1,3}(?:,\d{3})+\s*(?:#|$))([-+]?[\d.]+\s*(?:,\s*[-+]?[\d.]+\s*){2,})" + _END),
        lambda m: f"write {m[1]} = [{m[2].strip()}], a list in brackets",
    ),
    (
        re.compile(_KEY + r"([-+]?\d+),(\d+)(?![\d.]|,\d)"),
        lambda m: _with_point(m[1], m[2], m[3]),
    ),
    (re.compile(_KEY + r"([-+]?\d*)\.(\d*)" + _END), lambda m: _with_digits(m[1], m[2], m[3])),
    (
        re.compile(_KEY + r"([-+]?\d{1,3}(?:['., ]\d{3})+)(?:[.,](\d*))?" + _END),
        lambda m: f"write {m[1]} = {_ungrouped(m[2], m[3])}, without marks between thousands",
    ),
    (re.compile(_KEY + r"0+(\d+)" + _END), lambda m: f"write {m[1]} = {m[2]}, without 0 in front"),
    (re.compile(_KEY + r"([^#\"']*\w|\"[^\"]*\"|'[^']*')\s*[;,]" + r"\s*(?:#.*)?$"), lambda m: _unended(m[1], m[2])),
    (
        re.compile(_KEY + r"([-+]?\d+(?:\.\d+)?)\s*(?:mm|cm|m|um|deg|°|s|min|rpm|inch|in|%|\")" + _END),
        lambda m: f"write {m[1]} = {m[2]}, without a unit",
    ),
    (re.compile(_KEY + r"(true|false|on|off|yes|no)" + _END, re.IGNORECASE), lambda m: f"write {m[1]} = {_flag(m[2])}"),
    (re.compile(_KEY + r"[“”„‘’«»](.*?)[“”„‘’«»]"), lambda m: f'write {m[1]} = "{m[2]}", with straight quotes'),
    (
        re.compile(_KEY + r'"([^"]*\\[^"]*)"'),
        lambda m: f"a backslash begins an escape; write {m[1]} = '{m[2]}' in single quotes, or / for each \\",
    ),
    (re.compile(_KEY + r"([^\W\d][^\"'=\[\]{}#,]*?|[.~/][^\"'=\[\]{}#,]*?)" + _END), lambda m: _quoted(m[1], m[2])),
    (re.compile(r"^\s*([\w.-]+)\s*:\s*\S"), lambda m: f"write = after {m[1]}, not :"),
    (re.compile(r"^\s*(?://|;|%|\()"), lambda _: "a comment begins with #"),
    (re.compile(r"^\s*\[([\w.-]+)\s*$"), lambda m: f"write [{m[1]}]"),
)


def hint(line: str) -> str | None:
    """The correction of a line; None where that is not clear."""
    for pattern, words in _HINTS:
        match = pattern.search(line)
        if match:
            return words(match)
    return None


def _with_point(key: str, whole: str, part: str) -> str:
    """A comma before three digits may also stand between thousands."""
    thousands = len(part) == 3 and 0 < len(whole.lstrip("+-")) <= 3 and int(whole) != 0
    either = f"{key} = {whole}{part} or " if thousands else ""
    return f"write {either}{key} = {whole}.{part}, with a decimal point"


def _with_digits(key: str, whole: str, part: str) -> str:
    sign = "-" if whole.startswith("-") else ""
    return f"write {key} = {sign}{whole.lstrip('+-') or '0'}.{part or '0'}, with a digit on both sides of the point"


def _ungrouped(whole: str, part: str | None) -> str:
    digits = "".join(letter for letter in whole if letter.isdigit() or letter in "+-")
    return f"{digits}.{part}" if part else digits


def _unended(key: str, value: str) -> str:
    return f"write {key} = {value}, with nothing after it"


def _flag(word: str) -> str:
    return "true" if word.lower() in ("true", "on", "yes") else "false"


def _quoted(key: str, text: str) -> str:
    quote = "'" if "\\" in text else '"'
    return f"write {key} = {quote}{text}{quote}, in quotes"
